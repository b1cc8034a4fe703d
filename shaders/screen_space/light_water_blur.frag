// Blurs the light's map of the water along one axis: x thickness, y nearest depth, z thickness blurred widely; LAST: z becomes how much more
// water there is here than around, which is where light gathers.
uniform sampler2D source;   // FIRST: thickness; else x, y, z
uniform sampler2D nearest;  // FIRST: depth
uniform ivec2 axis;
uniform int reach;          // texels either side, of the narrow blur
layout(location = 0) out vec4 value;
vec3 at(ivec2 p) {
    p = clamp(p, ivec2(0), textureSize(source, 0) - 1);
#if defined(FIRST)
    float t = texelFetch(source, p, 0).r;
    return vec3(t, texelFetch(nearest, p, 0).r, t);
#else
    return texelFetch(source, p, 0).xyz;
#endif
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float narrow = 2.0 / float(reach * reach), wide = narrow / 4.0;
    vec3 c = at(here);
    float sum = c.x, depth = c.y, wideSum = c.z, weights = 1.0, wideWeights = 1.0;
    for (int k = 1; k <= 2 * reach; ++k) {
        vec3 a = at(here + k * axis), b = at(here - k * axis);
        float w = exp(-float(k * k) * narrow), v = exp(-float(k * k) * wide);
        sum += w * (a.x + b.x);
        wideSum += v * (a.z + b.z);
        weights += 2.0 * w;
        wideWeights += 2.0 * v;
        if (k <= reach) depth = min(depth, min(a.y, b.y));
    }
    value = vec4(sum / weights, depth, wideSum / wideWeights, 1.0);
#if defined(LAST)
    value.z = value.x - value.z;
#endif
}
