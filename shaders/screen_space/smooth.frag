// Narrow-range filter (Truong & Yuksel 2018), one axis: depths far in front are left out, depths far behind are pulled near, so that
// surfaces bend at their edges and do not melt into each other. The range follows the surface as the filter walks out.
#include "shaders/render/frame.glsl"
uniform sampler2D source;
uniform ivec2 axis;
uniform float reach;      // m, of the kernel
uniform float range;      // m
uniform float bend;       // m, how far behind what is behind is taken to be
uniform int maxTaps;
layout(location = 0) out float depth;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    float z = texelFetch(source, here, 0).r;
    depth = z;
    if (z >= kFar) return;
    float pixels = min(reach / (z * frame.ray.y), 0.5 * frame.viewport.y);
    if (pixels < 1.0) return;
    int taps = min(int(pixels), maxTaps);
    float stride = pixels / float(taps);
    float sum = z, weights = 1.0;
    float low = z - range, high = z + range;
    for (int k = 1; k <= taps; ++k) {
        ivec2 away = int(float(k) * stride + 0.5) * axis;
        float a = texelFetch(source, clamp(here + away, ivec2(0), last), 0).r;
        float b = texelFetch(source, clamp(here - away, ivec2(0), last), 0).r;
        float t = float(k) / float(taps);
        float w = exp(-2.0 * t * t);
        if (a < low || b < low) continue;  // both or none: a one-sided average would tilt the surface
        float wa = w, wb = w;
        if (a > high) a = z + bend; else { low = min(low, a - range); high = max(high, a + range); }
        if (b > high) b = z + bend; else { low = min(low, b - range); high = max(high, b + range); }
        sum += wa * a + wb * b;
        weights += wa + wb;
    }
    depth = sum / weights;
}
