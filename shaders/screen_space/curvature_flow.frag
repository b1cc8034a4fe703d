// One step of screen-space curvature flow (van der Laan et al. 2009): the surface moves by its mean curvature, so that bumps vanish and
// flat parts stay. The differences use a stencil with holes whose width is in metres: a step over k pixels has the effect of k^2 steps over
// one.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
uniform float step_;    // m, width of the stencil
uniform float maxStep;  // pixels
uniform float range;    // m: depths further apart belong to different surfaces

float z;
// How far in front of this pixel's depth, to first order; in a perspective of 1 / depth, which unlike depth is straight along a flat
// surface.
float near(ivec2 p) {
    float there = at(here + p);
    return abs(there - z) > range ? 0.0 : parallel() > 0.0 ? there - z : z - z * z / there;  // at an outline the slope is 0
}
void main() {
    z = begin();
    float pixels = min(step_ / pixelSize(z).y, maxStep);
    int k = max(int(ceil(pixels)), 1);
    float left = near(ivec2(-k, 0)), right = near(ivec2(k, 0)), below = near(ivec2(0, -k)), above = near(ivec2(0, k));
    float zx = 0.5 * (right - left), zy = 0.5 * (above - below), zxx = right + left, zyy = above + below;
    float zxy = 0.25 * (near(ivec2(k, k)) + near(ivec2(-k, -k)) - near(ivec2(k, -k)) - near(ivec2(-k, k)));
    // Slopes are per step; a step at depth z is `width` wide.
    vec2 width = pixelSize(z) * float(k);
    float sx = zx / width.x, sy = zy / width.y;
    // Twice the mean curvature (1/m) of a graph over the picture's plane, along the normal. Along the line of sight the displacement is
    // longer by the root of the last divisor, so one power of that root is left out. The paper moves depth by the curvature itself, which
    // smooths oblique surfaces less.
    float twice = ((1.0 + sy * sy) * zxx / (width.x * width.x) + (1.0 + sx * sx) * zyy / (width.y * width.y) -
                   2.0 * sx * sy * zxy / (width.x * width.y)) / (1.0 + sx * sx + sy * sy);
    float wide = pixels * pixelSize(z).y;
    end(z < kFar ? z + 0.125 * wide * wide * twice : z);  // half of the stability limit
}
