// One level of the surface's smoothing: a 3x3 binomial kernel with holes (Holschneider et al. 1989, "a trous"), levels of growing step in turn.
// Which depths belong to the surface is decided as in the narrow-range filter (Truong & Yuksel 2018): what lies far in front is left out, what
// lies far behind is pulled near, so that surfaces bend at their edges and do not melt into each other. Opposite neighbours are judged
// together, by how far the three depths are from a straight line: a steep surface is as smooth as a level one.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
uniform float step_;    // m
uniform float maxStep;  // pixels: wider holes than other levels can fill would show
uniform float range;    // m: how far from a straight line depths of one surface may be
uniform float bend;     // m

float z, sum, weights;
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
    z = begin();
    // In whole pixels, with so much less weight that the variance is the step's own, whatever the distance and the resolution.
    float pixels = min(step_ / (z * frame.ray.y), maxStep);
    int k = max(int(ceil(pixels)), 1);
    float side = 0.25 * pixels * pixels / float(k * k), centre = 1.0 - 2.0 * side;
    sum = centre * centre * z;
    weights = centre * centre;
    addPair(ivec2(k, 0), side * centre);
    addPair(ivec2(0, k), side * centre);
    addPair(ivec2(k, k), side * side);
    addPair(ivec2(k, -k), side * side);
    end(z < kFar ? sum / weights : z);
}
