// Ambient occlusion from depth, at half resolution (the estimator of McGuire et al. 2011, "The Alchemy screen-space ambient obscurance").
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
uniform float reach;           // m
layout(location = 0) out vec2 openDepth;  // openness 0..1, and the depth, m
const int kTaps = 8;
vec3 at(ivec2 p) {
    p = clamp(p, ivec2(0), ivec2(frame.viewport.xy) - 1);
    return placeAt(vec2(p) + 0.5, depthOfWindow(texelFetch(sceneDepth, p, 0).r));
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy) * 2;
    float z = texelFetch(sceneDepth, min(here, ivec2(frame.viewport.xy) - 1), 0).r;
    openDepth = vec2(1.0, kFar);
    if (z >= 1.0) return;
    vec3 p = at(here);
    vec3 right = at(here + ivec2(1, 0)) - p, left = p - at(here - ivec2(1, 0));
    vec3 up = at(here + ivec2(0, 1)) - p, down = p - at(here - ivec2(0, 1));
    vec3 n = normalize(cross(abs(right.z) < abs(left.z) ? right : left, abs(up.z) < abs(down.z) ? up : down));
    float pixels = min(reach / (-p.z * frame.ray.y), 0.25 * frame.viewport.y);
    openDepth.y = -p.z;
    if (pixels < 2.0) return;
    float turn = 6.2831853 * pixelNoise(gl_FragCoord.xy);
    vec2 dir = vec2(cos(turn), sin(turn));
    const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);  // by the golden angle
    float sum = 0.0;
    for (int k = 0; k < kTaps; ++k) {
        vec3 v = at(here + ivec2(pixels * (float(k) + 0.5) / float(kTaps) * dir)) - p;
        dir = golden * dir;
        float vv = dot(v, v);
        float falloff = max(1.0 - vv / (reach * reach), 0.0);
        sum += falloff * max(dot(v, n) - 0.006 * -p.z, 0.0) / (sqrt(vv) + 0.02 * reach);
    }
    openDepth.x = max(1.0 - 2.0 * sum / float(kTaps), 0.0);
}
