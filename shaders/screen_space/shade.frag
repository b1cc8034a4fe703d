// Shades the water's surface: the refracted and attenuated background, and the reflection.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/fog.glsl"
#include "shaders/render/fresnel.glsl"
#include "shaders/render/lights.glsl"
#include "shaders/render/shadow.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;   // window depth
uniform sampler2D fluidDepth;   // m
uniform sampler2D thickness;    // m; with INK y: of liquids other than the world's own
#if defined(NORMALS)
// Of the surface, view space, unit; w: m of water, instead of thickness. Without it normals come from the depth.
uniform sampler2D normals;
#else
uniform sampler2D sharp;        // thickness before its blur, m
uniform float spacing;          // m
#endif
uniform float radius;           // m
uniform vec3 absorption;        // 1/m
#if defined(INK)
uniform sampler2D depths;       // optical depth for red, green and blue instead of absorption: e^-depth is transmitted; w: by scattering
#endif
uniform vec3 scattering;        // 1/m, reduced
uniform float refractiveIndex;
uniform sampler2D caustics;     // the light below the water, in the light's projection: see water_light.glsl
uniform int shaftSteps;         // along a ray in the water; 0: there are no caustics
uniform int mirrorSteps;        // steps of screen-space reflection; 0: none
layout(location = 0) out vec4 colour;

float waterAt(vec2 uv) {
#if defined(NORMALS)
    return textureLod(normals, uv, 0.0).w;
#else
    return textureLod(thickness, uv, 0.0).r;
#endif
}
// The share of the pixel that is covered: 0 outside of the outline, which is where the water is as thick as a ball of its volume near its
// rim.
float coverage(float water) {
#if defined(NORMALS)
    return smoothstep(0.0, 0.5 * radius, water);
#else
    const float kOutline = 0.3;  // spacings
    float thick = textureLod(sharp, gl_FragCoord.xy * frame.viewport.zw, 0.0).r - kOutline * spacing;
    return clamp(0.5 + thick / max(length(vec2(dFdx(thick), dFdy(thick))), 1.0e-6), 0.0, 1.0);
#endif
}
float surfaceDepth(ivec2 p) { return texelFetch(fluidDepth, clamp(p, ivec2(0), ivec2(frame.viewport.xy) - 1), 0).r; }
vec3 surfaceAt(ivec2 p, float depth) { return placeAt(vec2(p) + 0.5, depth); }

const vec2 kCrease = vec2(0.15, 0.25);  // of a normal that turns so much from pixel to pixel, each side is looked at

// Along one axis: the central difference where the surface runs on to both sides, else the side whose depth changes less. At a crease, as
// at a wall's edge, the pixel belongs to the side that is straighter (Harten et al. 1987): the mean is of neither. `turn`: about how much
// the normal turns from pixel to pixel. All decisions are gradual, so that rounding decides none.
vec3 slopeHere(ivec2 here, ivec2 step_, vec3 p, float pixel, out float turn) {
    float a = surfaceDepth(here + step_), b = surfaceDepth(here - step_);
    float da = abs(a + p.z), db = abs(b + p.z);  // p.z = -depth
    vec3 ahead = surfaceAt(here + step_, a) - p, back = p - surfaceAt(here - step_, b);
    float near = 0.5 * radius;
    turn = 0.5;
    if (min(da, db) > 8.0 * radius) return surfaceAt(here + step_, -p.z) - p;  // a pixel by itself: towards the eye
    if (da >= near || db >= near) return da < db ? ahead : back;
    float steep = 0.5 * (a - b) / pixel, length_ = pixel * (1.0 + steep * steep);
    turn = abs(a + b + 2.0 * p.z) / length_;
    float crease = smoothstep(kCrease.x, kCrease.y, turn);
    if (crease == 0.0) return 0.5 * (ahead + back);
    float onA = abs(surfaceDepth(here + 2 * step_) - 2.0 * a - p.z) / length_, onB = abs(surfaceDepth(here - 2 * step_) - 2.0 * b - p.z) / length_;
    float ofA = crease * (1.0 - smoothstep(0.4 * turn, 0.6 * turn, onA)), ofB = crease * (1.0 - smoothstep(0.4 * turn, 0.6 * turn, onB));
    float rest = max(1.0 - ofA - ofB, 0.0);
    float sum = ofA + ofB + rest;
    turn = (ofA * onA + ofB * onB + rest * turn) / sum;
    return ((ofA + 0.5 * rest) * ahead + (ofB + 0.5 * rest) * back) / sum;
}
// `fringe`, 0..1: it may be near an outline. There the filter sees one side only and leaves single particles: where the surface further in
// is even, it runs on.
vec3 slope(ivec2 here, ivec2 step_, vec3 p, float pixel, float fringe, out float turn) {
    vec3 found = slopeHere(here, step_, p, pixel, turn);
    fringe *= 1.0 - smoothstep(6.0 * radius, 9.0 * radius, 9.0 * pixel);  // further in, but not another part of the water
    for (int k = fringe > 0.0 ? -1 : 2; k <= 1; k += 2) {
        ivec2 inwards = k * step_;
        if (abs(surfaceDepth(here - 4 * inwards) + p.z) < 2.0 * radius) continue;
        float c3 = surfaceDepth(here + 3 * inwards), c6 = surfaceDepth(here + 6 * inwards), c9 = surfaceDepth(here + 9 * inwards);
        // The line through them meets this pixel; nowhere is there no water.
        float apart = abs(1.5 * c3 - 0.5 * c9 + p.z);
        if (max(max(c3, c6), c9) >= kFar || apart > 4.0 * radius) continue;
        float bend = abs(c9 - 2.0 * c6 + c3), rise = c9 - c3, steep = rise / (6.0 * pixel);
        float even = fringe * (1.0 - smoothstep(0.15, 0.25, bend / (abs(rise) + 6.0 * pixel))) * (1.0 - smoothstep(8.0 * radius, 12.0 * radius, abs(rise)));
        even *= 1.0 - smoothstep(2.0 * radius, 4.0 * radius, apart);
        if (even == 0.0) continue;
        turn = mix(turn, bend / (9.0 * pixel * (1.0 + steep * steep)), even);
        found = mix(found, float(k) / 6.0 * (surfaceAt(here + 9 * inwards, c9) - surfaceAt(here + 3 * inwards, c3)), even);
    }
    return found;
}

// Light that went to all sides, and the same comes from: what a layer throws back, and in `through` what it lets through (Kubelka and Munk
// 1931; the coefficients of a reduced scattering after Thennadil 2008). `absorbed`, `thrown`: what fades by each, e^-x of a ray being left.
vec3 layer(vec3 absorbed, vec3 thrown, out vec3 through) {
    vec3 k = 2.0 * absorbed, s = 0.75 * thrown, q = max(sqrt(k * (k + 2.0 * s)), 1.0e-4), e = exp(-q), t = (1.0 - e * e) / (1.0 + e * e);
    vec3 rest = (k + s) * t + q;
    through = 2.0 * q * e / ((1.0 + e * e) * rest);
    return s * t / rest;
}

// Screen-space reflection: the colour in the mirror direction, rgb, and its confidence a. View space; step lengths grow with distance. 0
// steps: none.
vec4 mirroredScene(vec3 from, vec3 dir, int steps) {
    float t = 3.0 * radius, low = 0.0, high = 0.0;
    for (int k = 0; k < steps; ++k) {
        vec3 p = from + dir * t;
        vec2 uv = pixelOf(p) * frame.viewport.zw;
        if (p.z > -frame.planes.x || any(greaterThan(abs(uv - 0.5), vec2(0.5)))) break;
        float behind = -p.z - depthOfWindow(textureLod(sceneDepth, uv, 0.0).r);
        if (behind > 0.0 && behind < 1.5 * (t - low)) {
            high = t;
            break;
        }
        low = t;
        t *= 1.5;
    }
    for (int k = high > 0.0 ? 5 : 0; k > 0; --k) {
        float middle = 0.5 * (low + high);
        vec3 p = from + dir * middle;
        if (-p.z > depthOfWindow(textureLod(sceneDepth, pixelOf(p) * frame.viewport.zw, 0.0).r)) high = middle; else low = middle;
    }
    if (high == 0.0) return vec4(0.0);
    vec3 p = from + dir * high;
    vec2 uv = pixelOf(p) * frame.viewport.zw;
    vec2 edge = smoothstep(vec2(0.5), vec2(0.42), abs(uv - 0.5));
    float ownDepth = depthOfWindow(textureLod(sceneDepth, uv, 0.0).r);
    // Far behind what is seen there, the ray has not met it but passed behind it.
    float met = 1.0 - smoothstep(0.5 * radius, 0.5 * radius + 0.1 * high, -p.z - ownDepth);
    // Its fog is that of the way from the surface. No rounding of the picture grows: the surface's own fog lets no more pass than this
    // takes out.
    float passes = max(fogPasses(uv * frame.viewport.xy, ownDepth) / max(fogPasses(high), 1.0e-6), fogPasses(pixelOf(from), -from.z));
    return vec4(unfogged(textureLod(sceneColour, uv, 0.0).rgb, passes), edge.x * edge.y * met);
}

#if defined(INK)
// A body of another liquid in it is a thin lens: it turns a ray by the difference of the indices times the slope of its thickness. Oils'
// and honey's index is about this; that of others is nearer to water's, and they are cloudy.
const float kOtherIndex = 1.47;
vec2 otherLiquid(float depth) {
    vec2 texel = 1.0 / vec2(textureSize(thickness, 0)), uv = gl_FragCoord.xy * frame.viewport.zw, pixel = pixelSize(depth) * frame.viewport.xy * texel;
    vec2 ahead = vec2(textureLod(thickness, uv + vec2(texel.x, 0.0), 0.0).y, textureLod(thickness, uv + vec2(0.0, texel.y), 0.0).y);
    vec2 back = vec2(textureLod(thickness, uv - vec2(texel.x, 0.0), 0.0).y, textureLod(thickness, uv - vec2(0.0, texel.y), 0.0).y);
    vec2 slope = (ahead - back) / (2.0 * pixel);
    return slope / sqrt(1.0 + 0.25 * dot(slope, slope));  // nowhere steeper than 63 degrees
}
#endif

// A light's glint: GGX (Walter et al. 2007) of water whose normal turns by `turn` from pixel to pixel. The sun is a disc and the water has
// ripples finer than particles, so that it is nowhere sharper than `kFinest`; and none is brighter than the picture can take without
// sparkling.
const float kFinest = 0.035, kMostGlint = 8.0;
vec3 glint(vec3 n, vec3 toEye, vec2 turn, float mirror, vec3 towards, vec3 light) {
    float nl = dot(n, towards), nv = max(dot(n, toEye), 0.02);
    if (nl <= 0.0) return vec3(0.0);
    vec3 h = halfway(toEye, towards);
    float nh = max(dot(n, h), 0.0), a = min(kFinest + 0.5 * length(turn), 0.5), a2 = a * a;
    float k = nh * nh * (a2 - 1.0) + 1.0;
    float lobe = a2 / (3.1415927 * k * k) * 0.5 / (mix(2.0 * nl * nv, nl + nv, a) + 1.0e-4) * nl;
    return light * min(lobe * mirror, kMostGlint);
}

// Shafts of light, for an eye in the water: what it scatters once of the light that its waves gather and scatter apart.
// `reduced`, 1/m, is isotropic; water scatters forwards (Henyey and Greenstein 1941), so that more of it is met than that says.
vec3 shafts(vec3 dir, float through, vec3 absorbed, vec3 reduced) {
    const float kForwards = 0.7;  // 0.9 in the sea, of which the sharp peak is left out: it would be glare about the sun
    float g2 = kForwards * kForwards, facing = dot(directionToWorld(dir), frame.lightDir.xyz);
    float phase = 0.0795775 * (1.0 - g2) / pow(1.0 + g2 - 2.0 * kForwards * facing, 1.5);
    float step_ = through / float(shaftSteps);
    // Interleaved gradient noise (Jimenez 2014), so that steps do not show as layers.
    float t = step_ * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec3 sum = vec3(0.0);
    for (int k = 0; k < shaftSteps; ++k, t += step_) {
        vec3 at = toWorld(dir * t);
        vec2 uv = (frame.waterProjection * vec4(at, 1.0)).xy * 0.5 + 0.5;
        sum += textureLod(caustics, uv, 0.0).rgb * exp(-(absorbed + reduced) * t) * meshShadow(at, frame.lightDir.xyz);
    }
    return sum * step_ * phase * reduced / (1.0 - kForwards) * frame.lightColour.rgb;
}

// For an eye inside the water: the point where the ray through a pixel leaves it, m, view space.
vec3 wayOut(vec2 pixel) { return normalize(sightWay(pixel)) * textureLod(thickness, pixel * frame.viewport.zw, 0.0).r; }
// The picture for an eye in the water: the scene in the water directly, the scene above through Snell's window, and around the window what
// the surface mirrors. `scene`: m along the ray; `passed`: the share of light that comes as far as the surface; `deep`: the colour of very
// deep water.
vec3 fromWithin(vec3 dir, float through, float scene, vec3 straight, vec3 passed, vec3 deep) {
    // The surface is taken as level except for its slope by thickness, which is blurred and gets a small weight. A view from above, or
    // through a wall of the box, is not refracted.
    const float apart = 12.0;  // pixels
    vec2 at = gl_FragCoord.xy;
    vec3 right = wayOut(at + vec2(apart, 0.0)) - wayOut(at - vec2(apart, 0.0)), above_ = wayOut(at + vec2(0.0, apart)) - wayOut(at - vec2(0.0, apart));
    vec3 level = transpose(mat3(frame.inverseView)) * vec3(0.0, 1.0, 0.0);
    vec3 waved = cross(right, above_);
    waved *= sign(dot(waved, level)) / max(length(waved), 1.0e-9);
    vec3 outwards = normalize(level + 0.12 * (waved - dot(waved, level) * level));
    float leaves = smoothstep(1.0, 0.85, through / max(scene, 1.0e-4)) * smoothstep(0.03, 0.12, dot(dir, level));
    vec3 beyond = refract(dir, -outwards, refractiveIndex), back = reflect(dir, outwards);
    // What is mirrored is taken to be as far below the surface as the eye, and lit through as much water.
    vec4 below = leaves > 0.0 ? mirroredScene(dir * through, back, 12) : vec4(0.0);
    vec3 mirrored = mix(deep, mix(environment(directionToWorld(back), 0.2) * passed, below.rgb, below.a), passed);
    vec3 above = mirrored;
    if (dot(beyond, beyond) > 0.0) {
        vec3 met = dir * through + beyond * clamp(scene - through, 0.0, 60.0 * radius);
        vec2 uv = clamp(pixelOf(met) * frame.viewport.zw, frame.viewport.zw, 1.0 - frame.viewport.zw);
        bool seen = met.z < -frame.planes.x && depthOfWindow(textureLod(sceneDepth, uv, 0.0).r) < 0.5 * frame.planes.y;
        vec3 window = seen ? textureLod(sceneColour, uv, 0.0).rgb : environment(directionToWorld(beyond), 0.1);
        above = mix(window, mirrored, fresnel(clamp(dot(beyond, outwards), 0.02, 1.0), refractiveIndex));
    }
    return mix(straight, above, leaves);
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    colour = texelFetch(sceneColour, here, 0);
    float water = waterAt(gl_FragCoord.xy * frame.viewport.zw), covered = coverage(water);
    float depth = texelFetch(fluidDepth, here, 0).r;
    if (depth >= kFar) return;
    float behind = depthOfWindow(texelFetch(sceneDepth, here, 0).r);
    if (depth >= behind) return;

    vec3 p = surfaceAt(here, depth);
    vec3 toEye = towardsEye(p);
    vec2 turn;
#if defined(NORMALS)
    float fringe = 0.0;
#else
    float fringe = 1.0 - smoothstep(3.0 * spacing, 5.0 * spacing, water);
#endif
    vec3 right = slope(here, ivec2(1, 0), p, pixelSize(depth).x, fringe, turn.x);
    vec3 up = slope(here, ivec2(0, 1), p, pixelSize(depth).y, fringe, turn.y);
#if defined(NORMALS)
    vec3 n = texelFetch(normals, here, 0).xyz;
#else
    vec3 n = normalize(cross(right, up));
#endif
    float nv = dot(n, toEye);
    if (nv < 0.02) { n = normalize(n + (0.02 - nv) * toEye); nv = 0.02; }

    // Behind: along the refracted ray as far as the water is thick, then on through the air, turned halfway back: a slab would turn it back
    // wholly, a prism not at all.
    float through = water;
    vec3 bent = refract(-toEye, n, 1.0 / refractiveIndex);
#if defined(INK)
    vec4 fades = textureLod(depths, gl_FragCoord.xy * frame.viewport.zw, 0.0);
    vec2 lens = otherLiquid(depth);
    bent = normalize(bent + vec3((kOtherIndex / refractiveIndex - 1.0) * lens, 0.0));
#endif
    vec3 back = colour.rgb;
    float slant = length(sightWay(gl_FragCoord.xy));  // m along the line of sight, of a metre of depth
    float air = clamp((behind - depth) * slant - through, 0.0, 60.0 * radius);
    vec3 way = bent * through + 0.5 * (bent - toEye) * air;
    float stretch = 1.0;
    for (int k = 0; k < 3; ++k) {
        vec2 uv = pixelOf(p + way * stretch) * frame.viewport.zw;
        vec2 inside = clamp(uv, frame.viewport.zw, 1.0 - frame.viewport.zw);
        if (depthOfWindow(textureLod(sceneDepth, inside, 0.0).r) > depth) {  // else an object in front of the water would be visible in it
            back = textureLod(sceneColour, inside, 0.0).rgb;
            through = mix(through, waterAt(inside), 0.5);
#if defined(INK)
            fades = mix(fades, textureLod(depths, inside, 0.0), 0.5);
#endif
            break;
        }
        stretch *= 0.4;
    }
    float passes = fogPasses(gl_FragCoord.xy, depth);
    back = unfogged(back, passes);
    vec3 posWorld = toWorld(p);
    vec3 nWorld = directionToWorld(n), eyeWorld = directionToWorld(toEye);
    float lit = meshShadow(posWorld, nWorld);
#if defined(INK)
    vec3 absorbed = fades.rgb, thrown = vec3(fades.w);
#else
    vec3 absorbed = absorption * through, thrown = scattering * through;
#endif
    vec3 passed = exp(-absorbed - thrown), diffuse;
    vec3 returned = layer(absorbed, thrown, diffuse);
    // In a clear liquid, light from above illuminates all of it; in a cloudy one it leaves near the point of entry.
    vec3 cloudy = 1.0 - exp(-0.3 * thrown);
    vec3 above = ambient(vec3(0.0, 1.0, 0.0)), front = ambient(nWorld), rear = ambient(-nWorld), sun = vec3(0.0);
    for (int k = 0; k < lightCount(); ++k) {
        vec3 towards = lightTowards(k), light = lightColour(k);
        float share = (k == 0 ? lit : 1.0) * lightShare(k, posWorld), facing = dot(nWorld, towards);
        above += light * (share * 0.25 * max(towards.y, 0.0));
        front += light * (share * 0.3183099 * max(0.85 * facing + 0.15, 0.0));
        rear += light * (share * 0.3183099 * max(-facing, 0.0));
        float mirror = fresnel(max(dot(eyeWorld, halfway(eyeWorld, towards)), 0.02), refractiveIndex);
        sun += glint(nWorld, eyeWorld, turn, mirror, towards, light * share);
    }
    sun *= smoothstep(0.0, 0.8 * radius, through);
    vec3 glow = mix(above, front, cloudy);
    vec3 scattered = returned * glow + max(diffuse - passed, 0.0) * mix(above, rear, cloudy);
    vec3 transmitted = back * passed + scattered;
    float under = 1.0 - smoothstep(frame.planes.x + 0.5 * radius, frame.planes.x + 2.5 * radius, depth);  // the eye is in the water
    under *= 1.0 - parallel();  // there is no eye
    vec3 within = vec3(0.0);
    if (under > 0.0) {
        vec3 deep = layer(40.0 * absorbed, 40.0 * thrown, diffuse) * glow;  // backscatter of very deep liquid
        vec3 straight = texelFetch(sceneColour, here, 0).rgb;
        within = fromWithin(-toEye, water, behind * slant, straight, passed, deep) * passed + scattered;
        if (shaftSteps > 0) within += shafts(-toEye, min(water, behind * slant), absorbed / max(through, 1.0e-3), thrown / max(through, 1.0e-3));
    }

    // Where the normal varies within a pixel, the reflection is blurred, to avoid aliasing.
    float rough = sqrt(min(0.02 + 0.35 * dot(turn, turn), 0.2));
    vec3 mirrored = reflect(-eyeWorld, nWorld);
    vec3 reflected = environment(mirrored, rough) * mix(0.6, 1.0, lit);
    // The fringe of the water, thinner than a particle, depends on random particle positions: it has no reflection.
    float mirror = fresnel(nv, refractiveIndex) * smoothstep(0.0, 0.8 * radius, through);
    vec4 met = mirroredScene(p, reflect(-toEye, n), mirror > 0.03 ? mirrorSteps : 0);
    reflected = mix(reflected, met.rgb, met.a);
    // At contact with a solid it fades, to avoid a hard line.
    float there = smoothstep(0.0, 0.4 * radius, behind - depth) * covered;
    vec3 seen = fogged(mix(transmitted, reflected, mirror) + sun, passes);
    colour.rgb = mix(mix(colour.rgb, seen, there), within, under);
}
