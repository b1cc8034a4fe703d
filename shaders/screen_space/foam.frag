// A foam particle: all have one colour, so that their order does not matter. Below the water's surface it fades.
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
#if defined(OVER_WATER)
uniform sampler2D waterDepth;  // m
uniform float radius;          // m
uniform vec3 absorption;       // 1/m
uniform sampler2D glassDepth;  // window depth
uniform int side;              // 0: everything; 1: only behind glass where there is no water; 2: the rest
#endif
flat in vec4 white;
flat in float depth;
in vec2 place;
layout(location = 0) out vec4 colour;
void main() {
    float d2 = dot(place, place);
    ivec2 here = ivec2(gl_FragCoord.xy);
    if (d2 >= 1.0 || depth > depthOfWindow(texelFetch(sceneDepth, here, 0).r)) discard;
    colour = vec4(white.rgb, white.a * (1.0 - d2));
#if defined(OVER_WATER)
    float water = texelFetch(waterDepth, here, 0).r;
    if (side > 0) {
        bool glazed = water >= kFar && depth > depthOfWindow(texelFetch(glassDepth, here, 0).r);
        if (glazed != (side == 1)) discard;
    }
    // Foam on the surface is at its depth, up to the error of the smoothing.
    float under = max(depth - water - 3.0 * radius, 0.0);
    colour.rgb *= exp(-2.0 * absorption * under);
    colour.a *= exp(-under / (8.0 * radius));
#endif
}
