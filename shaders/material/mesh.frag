#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/material/surface.glsl"
in vec3 posWorld;
in vec3 normalWorld;
uniform vec3 baseColour;
uniform float roughness;
uniform float metallic;
uniform sampler2D occlusion;
layout(location = 0) out vec4 colour;
void main() {
    vec3 toEye = normalize(frame.cameraPos.xyz - posWorld);
    vec3 n = normalize(normalWorld);
    if (!gl_FrontFacing) n = -n;
    float open = texture(occlusion, gl_FragCoord.xy * frame.viewport.zw).r;
    vec3 light = frame.lightColour.rgb * meshShadow(posWorld, n) * waterShadow(posWorld);
    colour = vec4(shadeSurface(Surface(baseColour, roughness, metallic, n, open), toEye, light), 1.0);
}
