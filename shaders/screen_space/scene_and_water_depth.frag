// The window depth of the scene, or of the water's surface where that is nearer.
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
uniform sampler2D waterDepth;  // m
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float water = texelFetch(waterDepth, here, 0).r;
    gl_FragDepth = min(texelFetch(sceneDepth, here, 0).r, water < kFar ? windowOfDepth(water) : 1.0);
}
