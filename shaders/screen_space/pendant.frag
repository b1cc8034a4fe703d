// A drop that hangs: the line of sight is followed into it and out again.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/screen_space/drop.glsl"
#include "shaders/screen_space/pendant.glsl"
flat in Pendant drop;
in vec3 through;
layout(location = 0) out vec4 colour;

// m^2: negative inside; yzw its gradient, m.
vec4 outside(vec3 p) {
    vec3 q = p - drop.foot.xyz;
    float high = drop.foot.w, z = dot(q, drop.axis.xyz), s = clamp(z / high, PENDANT_ABOVE, 1.3);
    vec3 lean = drop.lean.xyz * max(s, 0.0);
    vec3 e = q - drop.axis.xyz * z - lean * (0.5 * s * high);
    vec4 w = drop.swell;
    float t = min(s, 1.0);  // below the tip it is as at the tip
    float swell = w.x + t * (w.y + t * (w.z + t * w.w)), square = (1.0 - s) * swell;
    float slope = ((1.0 - t) * (w.y + t * (2.0 * w.z + t * 3.0 * w.w)) - swell) / high;
    float above = PENDANT_ABOVE * high - z;
    if (above > 0.0) slope = 0.0, square = -above * drop.lean.w;  // it ends there
    return vec4(dot(e, e) - square, 2.0 * e - drop.axis.xyz * (slope + 2.0 * dot(e, lean)));
}

// m along the way from `from`, where it enters (`sign_` 1) or leaves (-1) the drop; -1: nowhere. `near`: the least distance, m.
float meets(vec3 from, vec3 way, float reach, int steps, float sign_, out float near) {
    near = 1.0e6;
    float nearest = 0.0, before = 0.0, step_ = reach / float(steps);
    for (int k = 1; k <= steps; ++k) {
        float at = step_ * float(k);
        vec4 f = outside(from + way * at) * sign_;
        if (f.x < 0.0) {
            float low = before, high = at;
            for (int i = 0; i < 12; ++i) {
                float middle = 0.5 * (low + high);
                if (outside(from + way * middle).x * sign_ < 0.0) high = middle;
                else low = middle;
            }
            near = 0.0;
            return high;
        }
        float away = f.x / max(length(f.yzw), 1.0e-9);
        if (away < near) near = away, nearest = at;
        before = at;
    }
    // It may pass through the edge of the drop between two steps.
    float low = nearest - step_, high = nearest + step_;
    for (int i = 0; i < 10; ++i) {
        float a = mix(low, high, 0.382), b = mix(low, high, 0.618);
        if (outside(from + way * a).x * sign_ < outside(from + way * b).x * sign_) high = b;
        else low = a;
    }
    float at = 0.5 * (low + high);
    vec4 f = outside(from + way * at) * sign_;
    near = max(f.x, 0.0) / max(length(f.yzw), 1.0e-9);
    return f.x < 0.0 ? at : -1.0;
}

// The skin, where the eye sees it: a little above its place, for it may face away; at its place, where nothing is above.
vec3 skinAt(vec3 at) {
    for (float above = 0.4; ; above = 0.0) {
        vec2 uv = pixelOf(at - drop.axis.xyz * (above * drop.lean.w)) * frame.viewport.zw;
        uv = clamp(uv, frame.viewport.zw, 1.0 - frame.viewport.zw);
        bool there = abs(depthOfWindow(textureLod(sceneDepth, uv, 0.0).r) + at.z) < 10.0 * drop.lean.w;
        if (there || above == 0.0) return unfogged(textureLod(sceneColour, uv, 0.0).rgb, fogPasses(gl_FragCoord.xy, -at.z));
    }
}

// What a ray sees that leaves the drop: what climbs meets the skin beside the foot.
vec3 seenOutside(vec3 from, vec3 way, float depth) {
    float climbs = -dot(way, drop.axis.xyz), skin = smoothstep(0.2, 0.6, climbs);
    vec3 aside = way + drop.axis.xyz * climbs;
    vec3 beside = skinAt(drop.foot.xyz + normalize(aside + 1.0e-6) * (2.0 * drop.lean.w));
    return mix(seenThrough(from, way, depth, 0.8 - 0.8 * smoothstep(0.03, 0.15, depthBehind() - depth)), beside, skin);
}

// What a ray inside the drop sees: the skin that the drop hangs from, or what is outside, perhaps after a total reflection.
vec3 seenInside(vec3 from, vec3 way, float radius, float depth) {
    vec3 clear = vec3(1.0);
    for (int k = 0; k < 2; ++k) {
        float unused, short_ = 0.02 * radius;
        float deep = max(meets(from + way * short_, way, 2.5 * radius, 24, -1.0, unused), 0.0) + short_;
        float climbs = -dot(way, drop.axis.xyz), skin = max(dot(from - drop.foot.xyz, drop.axis.xyz), 0.0) / max(climbs, 1.0e-4);
        if (climbs > 0.0 && skin < deep) return skinAt(from + way * skin) * clear * exp(-drop.absorption * skin);
        clear *= exp(-drop.absorption * deep);
        from += way * deep;
        vec3 n = -normalize(outside(from).yzw), out_ = refract(way, n, refractiveIndex);
        vec3 back = reflect(way, n);
        if (dot(out_, out_) > 0.5) {
            // Its far side reflects the lamp: a bright spot on the side away from it, where the ray back leaves about as it goes.
            vec3 mirrored = 0.04 * environment(directionToWorld(back), 0.1);
            for (int light = 0; light < lightCount(); ++light) {
                float glint = smoothstep(0.9, 0.99, dot(directionToWorld(back), lightTowards(light)));
                mirrored += lightColour(light) * (0.3 * glint * lightShare(light, toWorld(from)));
            }
            return (seenOutside(from, out_, depth) + mirrored) * clear;
        }
        way = back;
    }
    return seenOutside(from, way, depth) * clear;
}

void main() {
    vec3 eye = sightFrom(through), sight = -towardsEye(through), top = centreLine(drop, PENDANT_ABOVE), tip = centreLine(drop, 1.0), middle = 0.5 * (top + tip);
    float radius = 1.15 * length(vec2(0.5 * distance(top, tip), drop.lean.w)), start = max(dot(middle - eye, sight) - radius, 0.0);
    float near, unused, at = meets(eye + sight * start, sight, 2.0 * radius, 40, 1.0, near);
    float pixel = pixelSize(-middle.z).x;
    float cover = at >= 0.0 ? 1.0 : 1.0 - near / pixel;
    if (cover <= 0.0) discard;
    if (at < 0.0) at = max(dot(middle - eye, sight) - start, 0.0);  // the edge of the drop, less than a pixel off
    vec3 p = eye + sight * (start + at);
    float depth = -p.z;
    if (isHidden(depth)) discard;
    gl_FragDepth = windowOfDepth(cover > 0.5 ? depth : depthBehind());
    cover *= smoothstep(0.0, 2.0e-4, depthBehind() - depth);  // it joins the skin

    vec3 n = normalize(outside(p).yzw);
    if (dot(n, sight) > 0.0) n = normalize(n - sight * (dot(n, sight) + 1.0e-3));
    float closed = 1.0 - smoothstep(0.1, 0.4, depthBehind() - depth);
    vec3 inside = seenInside(p, refract(sight, n, 1.0 / refractiveIndex), radius, depth);
    colour = vec4(lightOfDrop(inside, p, n, -sight, closed), cover * drop.axis.w);
}
