// Ambient occlusion from depth, at half resolution (the estimator of McGuire et al. 2011, "The Alchemy screen-space ambient obscurance").
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
uniform float reach;           // m
layout(location = 0) out float open;
const int kTaps = 10;
vec3 at(ivec2 p) {
    p = clamp(p, ivec2(0), ivec2(frame.viewport.xy) - 1);
    return viewRay(vec2(p) + 0.5) * depthOfWindow(texelFetch(sceneDepth, p, 0).r);
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy) * 2;
    float z = texelFetch(sceneDepth, min(here, ivec2(frame.viewport.xy) - 1), 0).r;
    open = 1.0;
    if (z >= 1.0) return;
    vec3 p = at(here);
    vec3 right = at(here + ivec2(1, 0)) - p, left = p - at(here - ivec2(1, 0));
    vec3 up = at(here + ivec2(0, 1)) - p, down = p - at(here - ivec2(0, 1));
    vec3 n = normalize(cross(abs(right.z) < abs(left.z) ? right : left, abs(up.z) < abs(down.z) ? up : down));
    float pixels = min(reach / (-p.z * frame.ray.y), 0.25 * frame.viewport.y);
    if (pixels < 2.0) return;
    float turn = 6.2831853 * pixelNoise(gl_FragCoord.xy);
    float sum = 0.0;
    for (int k = 0; k < kTaps; ++k) {
        float angle = turn + 2.3999632 * float(k);
        float radius = pixels * (float(k) + 0.5) / float(kTaps);
        vec3 v = at(here + ivec2(radius * vec2(cos(angle), sin(angle)))) - p;
        float vv = dot(v, v);
        float falloff = max(1.0 - vv / (reach * reach), 0.0);
        sum += falloff * max(dot(v, n) - 0.006 * -p.z, 0.0) / (sqrt(vv) + 0.02 * reach);
    }
    open = max(1.0 - 2.0 * sum / float(kTaps), 0.0);
}
