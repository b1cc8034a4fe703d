// One level of surface smoothing: a 3x3 binomial kernel with holes (Holschneider et al. 1989, "a trous"), in levels of growing step.
// The depths of the surface are selected as in the narrow-range filter (Truong and Yuksel 2018): depths far in front are ignored,
// depths far behind are clamped to near ones, so that surfaces curve at their edges and do not merge. Opposite neighbours are tested
// together, by the deviation of the three depths from a straight line: a steep surface is smoothed as much as a level one.
// At the walls of the box, where the water is cut off, it does not curve.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
uniform float step_;    // m
uniform float maxStep;  // pixels: wider holes would be visible, because other levels could not fill them
uniform float range;    // m: maximum deviation from a straight line of depths of one surface
uniform float bend;     // m

float z, sum, weights;
void addPair(ivec2 away, float w) {
    float a = at(here + away), b = at(here - away);
    float off = a + b - 2.0 * z;
    float near = min(a, b);
    float pair = a + b;
    if (off > range) {
        vec3 place = frame.cameraPos.xyz + directionToWorld(viewRay(gl_FragCoord.xy)) * z, wall = min(place - low, high - place);
        float curved = min(min(wall.x, wall.y), wall.z) < 5.0 * bend ? 0.0 : bend;
        pair = 2.0 * z + curved * (near > z + range ? 2.0 : 1.0);
    }
    sum += w * (off < -range ? 2.0 * z : pair);
    weights += 2.0 * w;
}
void main() {
    z = begin();
    // In whole pixels; the weight is reduced so that the variance equals that of the step, at every distance and resolution.
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
