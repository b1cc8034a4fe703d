// A Gaussian blur along one axis.
uniform sampler2D source;
uniform ivec2 axis;
uniform int reach;  // texels either side
layout(location = 0) out vec4 value;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    float inverse = 2.0 / max(float(reach * reach), 1.0), weights = 1.0;
    value = texelFetch(source, here, 0);
    for (int k = 1; k <= reach; ++k) {
        float w = exp(-float(k * k) * inverse);
        value += w * (texelFetch(source, clamp(here + k * axis, ivec2(0), last), 0) + texelFetch(source, clamp(here - k * axis, ivec2(0), last), 0));
        weights += 2.0 * w;
    }
    value /= weights;
}
