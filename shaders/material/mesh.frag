#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/render/water_light.glsl"
#include "shaders/material/surface.glsl"
#include "shaders/material/noise.glsl"
#if defined(WET)
#if defined(POSED)
#include "shaders/material/posed.glsl"
#endif
#include "shaders/material/wet.glsl"
#endif
in vec3 posWorld;
in vec3 posOwn;
in vec3 normalWorld;
uniform vec3 baseColour;
uniform float roughness;
uniform float metallic;
uniform vec2 grain;  // strength, size of the largest spots (m)
uniform sampler2D occlusion;
layout(location = 0) out vec4 colour;
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
    float open = textureLod(occlusion, gl_FragCoord.xy * frame.viewport.zw, 0.0).r;
    vec3 colourHere = baseColour;
    if (grain.x > 0.0) {
        vec4 g = grainAt(posOwn, grain.y, length(frame.cameraPos.xyz - posWorld) * frame.ray.x);
        vec3 slope = g.yzw - dot(g.yzw, n) * n;
        n = normalize(n - 0.8 * grain.x * grain.y * slope);
        colourHere *= clamp(1.0 + 1.1 * grain.x * g.x, 0.3, 1.6);
    }
    vec3 light = frame.lightColour.rgb * meshShadow(posWorld, n) * waterShadow(posWorld);
#if defined(WET)
    vec3 smooth_ = normalize(normalWorld);
    if (!gl_FrontFacing) smooth_ = -smooth_;
    Wet w = wetnessAt(posWorld, n, smooth_, roughness, metallic);
    vec3 body = darkened(colourHere, w) * (1.0 - metallic);
    vec3 matte = body * (0.3183099 * max(dot(n, frame.lightDir.xyz), 0.0) * light + ambient(n) * open);
    vec3 shine = gloss(n, toEye, mix(vec3(0.04), colourHere, metallic), max(roughness, 0.1), 0.0, light, open);
    colour = vec4(wetted(matte, shine, metallic, w, toEye, light, open), 1.0);
#else
    colour = vec4(shadeSurface(Surface(colourHere, roughness, metallic, n, open), toEye, light), 1.0);
#endif
}
