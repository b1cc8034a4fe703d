// 4x4 box over the noise pattern of occlusion.frag, not across depth edges.
#include "shaders/render/frame.glsl"
uniform sampler2D source;
uniform sampler2D sceneDepth;
layout(location = 0) out float open;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1, lastFull = ivec2(frame.viewport.xy) - 1;
    float depth = depthOfWindow(texelFetch(sceneDepth, min(here * 2, lastFull), 0).r);
    float sum = 0.0, weights = 1.0e-4;
    for (int y = -2; y < 2; ++y)
        for (int x = -2; x < 2; ++x) {
            ivec2 q = clamp(here + ivec2(x, y), ivec2(0), last);
            float other = depthOfWindow(texelFetch(sceneDepth, min(q * 2, lastFull), 0).r);
            float w = max(1.0 - abs(other - depth) * 30.0 / depth, 0.0);
            sum += w * texelFetch(source, q, 0).r;
            weights += w;
        }
    open = weights > 0.01 ? sum / weights : texelFetch(source, min(here, last), 0).r;
}
