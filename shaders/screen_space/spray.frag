// Droplets of one particle: spheres of the liquid, drawn out along their paths, and the mist around them.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/fog.glsl"
#include "shaders/render/fresnel.glsl"
#include "shaders/render/lights.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;  // window depth
uniform sampler2D waterDepth;  // m
uniform float refractiveIndex;
uniform float spacing;         // m
#if defined(INK)
flat in vec4 ink;              // 1/m; w: scattering
#else
uniform vec4 ownAbsorption;    // 1/m; w: scattering
#endif
const int kDroplets = 7;
flat in vec4 droplet[kDroplets];
flat in float share[kDroplets];
flat in vec3 centreView;
flat in vec3 alongView;
flat in float haze;
flat in vec2 reach;
flat in float lit;
layout(location = 0) out vec4 colour;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float depth = -centreView.z, pixel = pixelSize(depth).x;
    vec3 toEye = towardsEye(centreView), across = cross(toEye, alongView), ray = sightWay(gl_FragCoord.xy);
    vec3 off_ = sightFrom(gl_FragCoord.xy) - centreView;
    off_ -= ray * (dot(off_, toEye) / dot(ray, toEye));
    vec2 place = vec2(dot(off_, alongView), dot(off_, across));  // m, along the path and across
    // Within half a spacing of what hides it, it fades.
    float hider = min(depthOfWindow(texelFetch(sceneDepth, here, 0).r), texelFetch(waterDepth, here, 0).r);
    float there = smoothstep(-0.25 * spacing, 0.25 * spacing, hider - depth);
    if (there <= 0.0) discard;
    float open = 1.0, deepest = 1.0e9, away = 1.0, radius = 1.0, bright = 0.0, perEdge = 1.0 / (1.4 * pixel);
    vec2 outwards = vec2(0.0);  // m
    for (int k = 0; k < kDroplets; ++k) {
        vec4 drop = droplet[k];
        vec2 off = place - drop.xy;
        off.x -= clamp(off.x, -drop.z, drop.z);
        float d = length(off), outside = d - drop.w, edge = clamp(0.5 + outside * perEdge, 0.0, 1.0);
        if (outside < deepest) {
            deepest = outside;
            outwards = off;
            away = d;
            bright = share[k];
            radius = drop.w;
        }
        open *= 1.0 - share[k] * (1.0 - edge * edge * (3.0 - 2.0 * edge));
    }
    float near = max(1.0 - dot(place / reach, place / reach), 0.0), mist = haze * near * near;
    float cover = 1.0 - open, all = 1.0 - open * (1.0 - mist);
    if (all < 0.002) discard;

    float d = min(away / radius, 0.98), nv = sqrt(1.0 - d * d);  // sine and cosine of the angle between the normal and the ray
    vec3 side = (alongView * outwards.x + across * outwards.y) / max(away, 1.0e-9);
    vec3 n = side * d + toEye * nv;
    // A sphere refracts a ray twice by the same angle, towards its centre: what is behind appears upside down.
    float inner = d / refractiveIndex, innerCos = sqrt(1.0 - inner * inner);
    float once = d * innerCos - nv * inner;  // the sine of that angle
    vec3 bent = -toEye * (1.0 - 2.0 * once * once) - side * (2.0 * once * sqrt(1.0 - once * once));
    vec2 uv = clamp(pixelOf(centreView + bent * (4.0 * spacing)) * frame.viewport.zw, frame.viewport.zw, 1.0 - frame.viewport.zw);
    vec2 inside = (1.0 - smoothstep(vec2(0.45), vec2(0.5), abs(uv - 0.5)));
    // A drop shows all that is around it, too small for details, and little of what is close behind; what is in front of it, it does not
    // show.
    float seen = depthOfWindow(textureLod(sceneDepth, uv, 0.0).r) < depth ? 0.0 : 0.6 * inside.x * inside.y;
    float passes = fogPasses(gl_FragCoord.xy, depth);
    vec3 through = mix(ambient(directionToWorld(bent)), unfogged(textureLod(sceneColour, uv, 0.0).rgb, passes), seen);
    vec3 white = ambient(directionToWorld(n)), suns = vec3(0.0), glints = vec3(0.0);
    for (int k = 0; k < lightCount(); ++k) {
        vec3 sun = lightColour(k) * (k == 0 ? lit : 1.0), half_ = halfway(toEye, transpose(mat3(frame.inverseView)) * lightTowards(k));
        white += sun * (0.3183099 * (0.5 + 0.5 * dot(directionToWorld(n), lightTowards(k))));
        // A highlight is drawn out along the path, and only of a drop of several pixels is it a spot of its own.
        glints += sun * (0.5 * smoothstep(0.92, 0.995, dot(n, half_)) * smoothstep(0.8, 4.0, radius / pixel) * bright);
        suns += sun;
    }
#if defined(INK)
    vec4 own = ink;
#else
    vec4 own = ownAbsorption;
#endif
    float length_ = 1.33 * radius;
    vec3 left = exp(-own.rgb * length_), passed = left * exp(-own.w * length_), thrown = left - passed;
    float base = (refractiveIndex - 1.0) / (refractiveIndex + 1.0), flat_ = 1.0 - nv, flat2 = flat_ * flat_;
    float mirror = mix(base * base, 1.0, flat2 * flat2 * flat_);  // Schlick 1994
    vec3 mirrored = environment(directionToWorld(reflect(-toEye, n)), 0.2);
    vec3 drop = mix(through * passed + thrown * white, mirrored, mirror) + glints;
    vec3 cloud = 0.9 * (ambient(vec3(0.0, 1.0, 0.0)) + suns * 0.25);
    colour = vec4(fogged(mix(cloud, drop, cover / max(cover + (1.0 - cover) * mist, 1.0e-4)), passes), all * there);
}
