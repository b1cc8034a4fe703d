// One level of surface smoothing: a 3x3 binomial kernel with holes (Holschneider et al. 1989, "a trous"), in levels of growing step.
// The depths of the surface are selected as in the narrow-range filter (Truong and Yuksel 2018): depths far in front are ignored,
// depths far behind are clamped to near ones, so that surfaces curve at their edges and do not merge. Opposite neighbours are tested
// together, by the deviation of the three depths from a straight line: a steep surface is smoothed as much as a level one.
// At the walls of the box, where the water is cut off, it does not curve. A pixel whose ray enters the box in the water shows the wall: its
// depth is that of the wall, and has a negative sign between the levels. No level moves it, or mixes it with the surface beside it, so that
// the edge between the two stays sharp. The edge is where the spheres end, which is scalloped: each pixel joins the majority around it.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
uniform float step_;    // m
uniform float maxStep;  // pixels: wider holes would be visible, because other levels could not fill them
uniform float range;    // m: maximum deviation from a straight line of depths of one surface
uniform float bend;     // m
uniform bool first;     // marks the walls and smooths nothing

float z, sum, votes;
float curved;  // m: `bend`, but at the walls of the box 0
bool atWall = false;
float around[9];  // m, row by row, `k` pixels apart
float vote(float d) { return d < 0.0 ? 1.0 : d < kFar ? -1.0 : 0.0; }
void addPair(float a, float b, float w) {
    votes += vote(a) + vote(b);
    if (min(a, b) < 0.0) {
        a = b = z;
        atWall = true;
    }
    float off = a + b - 2.0 * z;
    float near = min(a, b);
    float pair = a + b;
    if (off > range) pair = 2.0 * z + curved * (near > z + range ? 2.0 : 1.0);
    sum += w * (off < -range ? 2.0 * z : pair);
}
// Beside a wall the surface goes on to one side only, and opposite neighbours do not balance: the depth of the plane through those that
// are there.
float planeAt(float side, float centre) {
    float s = 0.0, sz = 0.0;
    vec2 sp = vec2(0.0), spz = vec2(0.0);
    vec3 spp = vec3(0.0);  // xx, xy, yy
    for (int i = 0; i < 9; ++i) {
        ivec2 p = ivec2(i % 3, i / 3) - 1;
        float d = i == 4 ? z : around[i];
        if (d < 0.0 || abs(d - z) > range) continue;
        float w = (p.x == 0 ? centre : side) * (p.y == 0 ? centre : side);
        vec2 q = vec2(p);
        s += w;
        sz += w * d;
        sp += w * q;
        spz += w * d * q;
        spp += w * vec3(q.x * q.x, q.x * q.y, q.y * q.y);
    }
    // The first of the three normal equations' unknowns, by Cramer's rule.
    float a = spp.x * spp.z - spp.y * spp.y, b = sp.x * spp.z - sp.y * spp.y, c = sp.x * spp.y - sp.y * spp.x;
    float divisor = s * a - sp.x * b + sp.y * c;
    return divisor > 1.0e-3 * s * side * side ? (sz * a - spz.x * b + spz.y * c) / divisor : z;
}
void main() {
    float own = begin(), slant;
    z = abs(own);
    vec2 inside = throughBox(gl_FragCoord.xy, slant);
    if (first) {
        // Spheres do not cover a wall without gaps: what is seen in them is less than `bend` behind the wall.
        bool wall = inside.x > 0.0 && (z - inside.x) * slant < bend;
        depth = inside.x > inside.y || z >= kFar ? kFar : wall ? -inside.x : z;
        return;
    }
    votes = vote(own);
    // In whole pixels; the weight is reduced so that the variance equals that of the step, at every distance and resolution.
    float pixels = min(step_ / pixelSize(z).y, maxStep);
    int k = max(int(ceil(pixels)), 1);
    float side = 0.25 * pixels * pixels / float(k * k), centre = 1.0 - 2.0 * side;
    for (int i = 0; i < 9; ++i) around[i] = at(here + k * (ivec2(i % 3, i / 3) - 1));
    vec3 place = frame.cameraPos.xyz + directionToWorld(placeAt(gl_FragCoord.xy, z)), walls = min(place - low, high - place);
    curved = min(min(walls.x, walls.y), walls.z) < 5.0 * bend ? 0.0 : bend;
    sum = centre * centre * z;  // the weights' sum is 1
    addPair(around[5], around[3], side * centre);
    addPair(around[7], around[1], side * centre);
    addPair(around[8], around[0], side * side);
    addPair(around[2], around[6], side * side);
    bool wall = votes > 0.0 && z < kFar && (z - inside.x) * slant < 4.0 * bend;
    float smoothed = own < 0.0 || wall ? inside.x : z >= kFar ? z : atWall ? planeAt(side, centre) : sum;
#if !defined(LAST)
    if (wall) smoothed = -smoothed;
#endif
    end(smoothed);
}
