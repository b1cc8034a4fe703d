#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/render/water_light.glsl"
#include "shaders/material/surface.glsl"
in vec3 posWorld;
in vec3 posOwn;
in vec3 normalWorld;
uniform vec3 baseColour;
uniform float roughness;
uniform float metallic;
uniform vec2 grain;  // strength, size of the largest spots (m)
uniform sampler2D occlusion;
layout(location = 0) out vec4 colour;
float hashed(vec3 p) {
    uvec3 k = uvec3(ivec3(p)) * uvec3(374761393u, 668265263u, 2246822519u);
    uint h = k.x ^ k.y ^ k.z;
    h = (h ^ (h >> 13)) * 1274126177u;
    return float((h ^ (h >> 16)) & 65535u) / 65535.0;
}
// Value noise (Perlin 1985), -1..1, and its gradient.
vec4 noise(vec3 p) {
    vec3 cell = floor(p), f = p - cell, w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0), dw = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = hashed(cell), b = hashed(cell + vec3(1, 0, 0)), c = hashed(cell + vec3(0, 1, 0)), d = hashed(cell + vec3(1, 1, 0));
    float e = hashed(cell + vec3(0, 0, 1)), g = hashed(cell + vec3(1, 0, 1)), h = hashed(cell + vec3(0, 1, 1)), i = hashed(cell + vec3(1));
    float low = mix(mix(a, b, w.x), mix(c, d, w.x), w.y), high = mix(mix(e, g, w.x), mix(h, i, w.x), w.y);
    vec3 slope = dw * vec3(mix(mix(b - a, d - c, w.y), mix(g - e, i - h, w.y), w.z), mix(mix(c - a, d - b, w.x), mix(h - e, i - g, w.x), w.z), high - low);
    return 2.0 * vec4(mix(low, high, w.z), slope) - vec4(1.0, 0.0, 0.0, 0.0);
}
// Spots of `size` m and finer, without those finer than two pixels: about -1..1, and the gradient, 1/m.
vec4 grainAt(vec3 at, float size, float pixel) {
    vec4 sum = vec4(0.0);
    float share = 0.5;
    for (int k = 0; k < 5 && size > 2.0 * pixel; ++k) {
        vec4 one = noise(at / size + 31.7 * float(k));
        sum += share * smoothstep(2.0, 5.0, size / pixel) * vec4(one.x, one.yzw / size);
        size *= 0.47;
        share *= 0.6;
    }
    return sum;
}

void main() {
    vec3 toEye = normalize(frame.cameraPos.xyz - posWorld);
    vec3 n = normalize(normalWorld);
    if (!gl_FrontFacing) n = -n;
    float open = texture(occlusion, gl_FragCoord.xy * frame.viewport.zw).r;
    vec3 colourHere = baseColour;
    if (grain.x > 0.0) {
        vec4 g = grainAt(posOwn, grain.y, length(frame.cameraPos.xyz - posWorld) * frame.ray.x);
        vec3 slope = g.yzw - dot(g.yzw, n) * n;
        n = normalize(n - 0.8 * grain.x * grain.y * slope);
        colourHere *= clamp(1.0 + 1.1 * grain.x * g.x, 0.3, 1.6);
    }
    vec3 light = frame.lightColour.rgb * meshShadow(posWorld, n) * waterShadow(posWorld);
    colour = vec4(shadeSurface(Surface(colourHere, roughness, metallic, n, open), toEye, light), 1.0);
}
