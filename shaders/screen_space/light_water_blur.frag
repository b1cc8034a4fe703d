// Blurs the light's map of the water along one axis. The narrow map, for shadows: xy thickness, thickness times depth; z thickness with
// twice the width. WIDE, for caustics: all with twice the width, and z the share that is covered by water, by which the others are to be
// divided (normalised convolution: Knutsson and Westin 1993), so that the water does not get thinner towards its edge. FIRST: the source
// has only xy.
uniform sampler2D source;
uniform ivec2 axis;
uniform int reach;    // texels either side, of the narrow blur
uniform float least;  // m: a texel with more water is covered
layout(location = 0) out vec4 value;
vec3 at(ivec2 p) {
    vec3 v = texelFetch(source, clamp(p, ivec2(0), textureSize(source, 0) - 1), 0).xyz;
#if defined(FIRST) && defined(WIDE)
    v.z = smoothstep(0.0, least, v.x);
    v.xy *= v.z;
#elif defined(FIRST)
    v.z = v.x;
#endif
    return v;
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float narrow = 2.0 / float(reach * reach), wide = narrow / 4.0;
    vec3 sum = at(here);
    vec2 weights = vec2(1.0);
    for (int k = 1; k <= 2 * reach; ++k) {
        vec2 w = exp(-float(k * k) * vec2(narrow, wide));
#if defined(WIDE)
        w.x = w.y;
#endif
        sum += w.xxy * (at(here + k * axis) + at(here - k * axis));
        weights += 2.0 * w;
    }
    value = vec4(sum / weights.xxy, 1.0);
}
