// One level of the surface's smoothing: a 3x3 binomial kernel with holes (Holschneider et al. 1989, "a trous"), levels of growing step in turn.
// Which depths belong to the surface is decided as in the narrow-range filter (Truong & Yuksel 2018): what lies far in front is left out, what
// lies far behind is pulled near, so that surfaces bend at their edges and do not melt into each other. Opposite neighbours are judged
// together, by how far the three depths are from a straight line: a steep surface is as smooth as a level one.
#include "shaders/render/frame.glsl"
uniform sampler2D source;
uniform float step_;    // m
uniform float maxStep;  // pixels: wider holes than other levels can fill would show
uniform float range;    // m: how far from a straight line depths of one surface may be
uniform float bend;     // m
#if defined(LAST)
uniform sampler2D spray; // y, m: drops stay as they are
uniform vec3 low, high; // m, world: the box that the water cannot leave
#endif
layout(location = 0) out float depth;

float z, sum, weights;
ivec2 here, last;
float at(ivec2 p) { return texelFetch(source, clamp(p, ivec2(0), last), 0).r; }
void addPair(ivec2 away, float w) {
    float a = at(here + away), b = at(here - away);
    float off = a + b - 2.0 * z;
    float near = min(a, b);
    float pulled = near > z + range ? 2.0 * (z + bend) : 2.0 * z + bend;
    float pair = off > range ? pulled : a + b;
    sum += w * (off < -range ? 2.0 * z : pair);
    weights += 2.0 * w;
}
void main() {
    here = ivec2(gl_FragCoord.xy);
    last = textureSize(source, 0) - 1;
    z = texelFetch(source, here, 0).r;
    depth = z;
    int k = max(int(min(step_ / (z * frame.ray.y), maxStep) + 0.5), 1);
    sum = 4.0 * z;
    weights = 4.0;
    addPair(ivec2(k, 0), 2.0);
    addPair(ivec2(0, k), 2.0);
    addPair(ivec2(k, k), 1.0);
    addPair(ivec2(k, -k), 1.0);
    if (z < kFar) depth = sum / weights;
#if defined(LAST)
    depth = min(depth, texelFetch(spray, here, 0).g);
    // The spheres reach a little out of the box. Cut, its walls are as flat as glass.
    vec3 ray = directionToWorld(viewRay(gl_FragCoord.xy));
    vec3 a = (low - frame.cameraPos.xyz) / ray, b = (high - frame.cameraPos.xyz) / ray;
    vec3 enter = min(a, b), leave = max(a, b);
    float entry = max(max(enter.x, enter.y), enter.z), exit_ = min(min(leave.x, leave.y), leave.z);
    depth = entry > exit_ || depth > exit_ ? kFar : max(depth, entry);
#endif
}
