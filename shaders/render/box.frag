// The colour of box edges. OVER_WATER: only where the edge is in front of the water, so that edges behind it are refracted and others are
// not.
#include "shaders/render/frame.glsl"
uniform float width;
uniform vec4 lineColour;
uniform sampler2D sceneDepth;
#if defined(OVER_WATER)
uniform sampler2D fluidDepth;
#endif
in float across;
in vec3 posView;
layout(location = 0) out vec4 colour;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float depth = depthOfWindow(gl_FragCoord.z);
    if (depth > depthOfWindow(texelFetch(sceneDepth, here, 0).r) * 1.002) discard;
#if defined(OVER_WATER)
    float water = texelFetch(fluidDepth, here, 0).r;
    if (water >= kFar || depth > water) discard;
#endif
    float coverage = clamp(0.5 * width + 0.5 - abs(across) * (0.5 * width + 0.5), 0.0, 1.0);
    colour = vec4(lineColour.rgb, lineColour.a * coverage);
}
