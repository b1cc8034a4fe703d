// A face of a clear body: reflects, and transmits the rest of the light; blended by GL_ONE, GL_SRC1_COLOR.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/fresnel.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/material/surface.glsl"
in vec3 posWorld;
in vec3 normalWorld;
uniform vec3 baseColour;      // transmission of a wall (two faces) at normal incidence,
uniform float opacity;        // reduced by this share
uniform float roughness;
uniform float metallic;       // a metal is not clear: 0
uniform sampler2D fluidDepth; // m
uniform int side;             // 0: everything; 1: only behind the water's surface, or where there is none; 2: only in front of it
layout(location = 0, index = 0) out vec4 colour;
layout(location = 0, index = 1) out vec4 passed;

const float kIndex = 1.52;  // of soda-lime glass

void main() {
    vec3 toEye = normalize(frame.cameraPos.xyz - posWorld);
    float depth = -(frame.view * vec4(posWorld, 1.0)).z;
    if (side > 0) {
        float water = texelFetch(fluidDepth, ivec2(gl_FragCoord.xy), 0).r;
        bool behind = water >= kFar || depth > water;
        if (behind != (side == 1)) discard;
    }
    vec3 n = normalize(normalWorld);
    if (!gl_FrontFacing) n = -n;
    float nv = clamp(dot(n, toEye), 0.02, 1.0);
    float mirror = fresnel(nv, kIndex) * (1.0 - metallic);
    vec3 wall = baseColour * (1.0 - opacity);
    passed = vec4(pow(max(wall, vec3(1.0e-4)), vec3(0.5 / max(nv, 0.12))) * (1.0 - mirror), 1.0);
    float lit = meshShadow(posWorld, n), rough = max(roughness, 0.03);
    vec3 h = halfway(toEye, frame.lightDir.xyz);
    float nl = max(dot(n, frame.lightDir.xyz), 0.0);
    float sun = highlight(nl, nv, max(dot(n, h), 0.0), max(rough * rough, 0.002)) * nl * fresnel(max(dot(toEye, h), 0.02), kIndex);
    colour = vec4(environment(reflect(-toEye, n), rough) * mirror + frame.lightColour.rgb * (lit * min(sun, 8.0)), 1.0);
}
