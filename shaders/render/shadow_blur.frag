// Moments of the warped depth (exponential variance shadow map: Lauritzen and McCool 2008), blurred along one axis; or with
// HALVE only reduced to half the width and height.
uniform sampler2D source;   // FROM_DEPTH: a depth map; else moments
uniform ivec2 axis;         // (1,0) or (0,1)
uniform int reach;          // texels either side
uniform float scale;        // of the source's size to the target's
layout(location = 0) out vec2 moments;
const float kWarp = 40.0;
vec2 at(ivec2 p, ivec2 last) {
#if defined(FROM_DEPTH)
    float e = exp(kWarp * texelFetch(source, clamp(p, ivec2(0), last), 0).r);
    return vec2(e, e * e);
#else
    return texelFetch(source, clamp(p, ivec2(0), last), 0).rg;
#endif
}
void main() {
    ivec2 last = textureSize(source, 0) - 1, here = ivec2(gl_FragCoord.xy * scale);
#if defined(HALVE)
    moments = 0.25 * (at(here, last) + at(here - ivec2(1, 0), last) + at(here - ivec2(0, 1), last) + at(here - 1, last));
#else
    ivec2 stride = axis * int(scale);
    float inverse = 2.0 / max(float(reach * reach), 1.0);
    vec2 sum = at(here, last);
    float weights = 1.0;
    for (int k = 1; k <= reach; ++k) {
        float w = exp(-float(k * k) * inverse);
        sum += w * (at(here + k * stride, last) + at(here - k * stride, last));
        weights += 2.0 * w;
    }
    moments = sum / weights;
#endif
}
