// One axis of the bilateral Gaussian filter (Tomasi and Manduchi 1998) with which the thesis smooths depth: weights by image and depth
// distance.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/filter.glsl"
uniform ivec2 axis;
uniform float reach;   // m, two standard deviations
uniform float range;   // m, two standard deviations in depth
uniform float most;    // pixels either side
void main() {
    float z = begin();
    float pixels = min(reach / pixelSize(z).y, most);
    float across = 2.0 / max(pixels * pixels, 1.0e-6), inDepth = 2.0 / (range * range);
    float sum = z, weights = 1.0;
    for (int k = 1; float(k) <= pixels && z < kFar; ++k) {
        float w = exp(-float(k * k) * across);
        float a = at(here + k * axis), b = at(here - k * axis);
        float u = w * exp(-(a - z) * (a - z) * inDepth), v = w * exp(-(b - z) * (b - z) * inDepth);
        sum += u * a + v * b;
        weights += u + v;
    }
    end(sum / weights);
}
