// The depth of the scene at which thickness.frag cuts the water; with CHANGED only where it differs from what was kept.
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
uniform int scale;             // as thickness.frag
layout(location = 0) out float depth;
#if defined(CHANGED)
uniform sampler2D kept;
#endif
void main() {
    depth = texelFetch(sceneDepth, min(ivec2(gl_FragCoord.xy * float(scale)), ivec2(frame.viewport.xy) - 1), 0).r;
#if defined(CHANGED)
    if (depth == texelFetch(kept, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
}
