// Blurs the light's map of the water along one axis: x thickness, y thickness times depth, z thickness with twice the width. LAST: z becomes
// the excess of thickness over the surroundings, which focuses light.
uniform sampler2D source;
uniform ivec2 axis;
uniform int reach;  // texels either side, of the narrow blur
layout(location = 0) out vec4 value;
vec3 at(ivec2 p) {
    vec3 v = texelFetch(source, clamp(p, ivec2(0), textureSize(source, 0) - 1), 0).xyz;
#if defined(LAST)
    return v;
#else
    return v.xyx;
#endif
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float narrow = 2.0 / float(reach * reach), wide = narrow / 4.0;
    value = vec4(at(here), 1.0);
    float weights = 1.0, wideWeights = 1.0;
    for (int k = 1; k <= 2 * reach; ++k) {
        vec3 both = at(here + k * axis) + at(here - k * axis);
        float w = exp(-float(k * k) * narrow), v = exp(-float(k * k) * wide);
        value.xyz += vec3(w, w, v) * both;
        weights += 2.0 * w;
        wideWeights += 2.0 * v;
    }
    value.xyz /= vec3(weights, weights, wideWeights);
#if defined(LAST)
    value.z = value.x - value.z;
#endif
}
