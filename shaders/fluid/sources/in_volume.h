// Whether a point is inside a box or a sphere. After emit_params.h.
#if !defined(RIVULET_IN_VOLUME_H)
#define RIVULET_IN_VOLUME_H
FN bool inVolume(vec3 x, SinkVolume v) {
    vec3 d = x - v.low.xyz;
    vec3 e = v.high.xyz - x;
    bool inBox = v.low.w == 0.0f && min(min(d.x, d.y), d.z) >= 0.0f && min(min(e.x, e.y), e.z) >= 0.0f;
    return inBox || (v.low.w != 0.0f && dot(d, d) <= v.high.x * v.high.x);
}
#endif
