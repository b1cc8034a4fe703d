// Where light goes that the water refracts, for caustics (Wyman and Davis 2006; Shah, Konttinen and Pattanaik 2007): one photon for each
// texel of the light's map of the water, whose upper and lower faces refract. In the light's space: x and y across, z along the light, m.
#include "shaders/render/frame.glsl"
#include "shaders/render/fresnel.glsl"
#include "shaders/render/shadow.glsl"
uniform sampler2D water;  // thickness along the light (m), that times its depth (0..1), share that is covered
uniform mat4 fromLight;   // clip of frame.waterProjection -> world
uniform vec3 absorption;  // 1/m, with scattering
uniform float refractiveIndex;
uniform float least;      // m: less water than that hardly bends light
layout(location = 0) out vec2 landed;  // texels
layout(location = 1) out vec4 flux;    // of a texel of sunlight; w: 0: it met no water
const float kSteepest = 2.0;

float metres = 0.5 * frame.shadow.w;  // of half the map's width
float side = float(textureSize(water, 0).x), texel = 2.0 * metres / side;

struct Faces {
    float top, bottom;  // m
    float wet;          // 0..1: how much of it is thick enough to bend light
};
Faces facesAt(vec2 xy) {
    vec3 w = textureLod(water, xy / metres * 0.5 + 0.5, 0.0).xyz;
    float middle = w.y / max(w.x, 1.0e-6) * 2.0 * metres, thick = w.x / max(w.z, 1.0e-3);
    return Faces(middle - 0.5 * thick, middle + 0.5 * thick, smoothstep(0.35, 0.6, w.z) * smoothstep(0.0, least, thick));
}

// How far it is along the light to what it reaches first, m; below 0: p is behind that.
float toReceiver(vec3 p) {
    vec3 world = (fromLight * vec4(p.xy / metres, p.z / metres - 1.0, 1.0)).xyz;
    float away = 4.0 * metres;  // there is nothing: as if a floor lay below, so that light under water has its pattern
    if (frame.floorFade.w > 0.0) away = (world.y - frame.floorColour.w) / max(frame.lightDir.y, 0.05);
    if (frame.shadow.x > 0.0) {
        vec3 at = (frame.shadowProjection * vec4(world, 1.0)).xyz * 0.5 + 0.5;
        float depth = log(max(textureLod(shadowSharp, at.xy, 0.0).x, 1.0e-20)) / kWarp;  // 1 where there is no mesh
        bool inMap = all(greaterThan(at.xy, vec2(0.0))) && all(lessThan(at.xy, vec2(1.0)));
        vec3 row = vec3(frame.shadowProjection[0].z, frame.shadowProjection[1].z, frame.shadowProjection[2].z);
        if (inMap && depth < 0.9999) away = min(away, (depth - at.z) / (-0.5 * dot(row, frame.lightDir.xyz)));
    }
    return away;
}
// The normal of a face towards the light, from its depth beside a point: without slope where there is no water beside.
vec3 facing(vec2 xy, bool top) {
    vec2 s = vec2(0.0);
    for (int k = 0; k < 2; ++k) {
        vec2 way = k == 0 ? vec2(texel, 0.0) : vec2(0.0, texel);
        Faces a = facesAt(xy + way), b = facesAt(xy - way);
        s[k] = (top ? a.top - b.top : a.bottom - b.bottom) * a.wet * b.wet / (2.0 * texel);
    }
    return normalize(vec3(s * min(1.0, kSteepest / max(length(s), 1.0e-6)), -1.0));
}

void main() {
    vec2 xy = (gl_FragCoord.xy / side * 2.0 - 1.0) * metres;
    landed = gl_FragCoord.xy;
    flux = vec4(1.0, 1.0, 1.0, 0.0);
    Faces f = facesAt(xy);
    float wet = f.wet;
    vec3 p = vec3(xy, f.top);
    if (wet == 0.0 || toReceiver(p) <= 0.0) return;  // no water, or before it something that light reaches first
    vec3 n = facing(xy, true), dir = refract(vec3(0.0, 0.0, 1.0), n, 1.0 / refractiveIndex);
    dir = normalize(mix(vec3(0.0, 0.0, 1.0), dir, wet));
    // Through the water, to its lower face or to what lies in it; Newton's iteration along the light.
    vec3 slope = dir / dir.z;
    float t = 0.0, within = 0.0, behind = 0.0;
    for (int k = 0; k < 5; ++k) {
        vec3 q = p + t * slope;
        Faces there = facesAt(q.xy);
        within = there.wet > 0.25 ? there.bottom - q.z : 0.0;
        behind = toReceiver(q);
        t = clamp(t + min(within, behind), 0.0, 2.0 * metres);
    }
    vec3 q = p + t * slope;
    vec3 passed = exp(-absorption * distance(p, q)) * (1.0 - fresnel(-n.z, refractiveIndex) * wet);
    if (behind > within + least) {  // out at the lower face, and on through the air
        vec3 m = facing(q.xy, false), onwards = refract(dir, m, refractiveIndex);
        bool out_ = dot(onwards, onwards) > 0.0;
        if (!out_) onwards = reflect(dir, m);
        onwards = normalize(mix(vec3(0.0, 0.0, 1.0), onwards, wet));
        slope = onwards / max(onwards.z, 0.1);
        t = 0.0;
        for (int k = 0; k < 4; ++k) t = clamp(t + toReceiver(q + t * slope), 0.0, 1.0e3);
        passed *= out_ ? vec3(1.0 - fresnel(clamp(-dot(onwards, m), 0.02, 1.0), refractiveIndex) * wet) : exp(-absorption * t * length(slope));
        q += t * slope;
    }
    landed = (q.xy / metres * 0.5 + 0.5) * side;
    flux = vec4(passed, 1.0);
}
