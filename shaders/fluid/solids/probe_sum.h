// Adds the impulse that a wall gives to a particle to the probes that measure this wall. Include after BUFFERS; the buffers are `probes`
// and `rows`; `t` is the thread, below PROBE_THREADS.
#undef PROBE_ON_BOX
#undef PROBE_ON_PLANE
#undef PROBE_ON_STILL
#undef PROBE_ON_RIGID
#undef PROBE_ON_DEFORMING
#undef PROBE_ON_BODY
#undef PROBE_ADD
#define PROBE_ON_BOX 0u  // as ProbeOn of fluid/sim/solids/probes.h
#define PROBE_ON_PLANE 1u
#define PROBE_ON_STILL 2u
#define PROBE_ON_RIGID 3u
#define PROBE_ON_DEFORMING 4u
#define PROBE_ON_BODY 5u

// The share of a contact within low .. high along one axis: the contact covers a spacing along the wall, and is a point across it, so that
// the load on a region changes evenly with its edges. A point on the edge of a region without thickness counts in full.
FN float footprintWithin(float x, float n, float low, float high, float spacing) {
    float e = max(spacing * sqrt(max(1.0f - n * n, 0.0f)), 1.0e-3f * spacing);
    float slack = 0.5e-3f * spacing;
    return clamp((min(0.5f * e, high + slack - x) - max(-0.5f * e, low - slack - x)) / e, 0.0f, 1.0f);
}

// The share of a contact that probe k measures. x: its point on the wall, m; n: the wall's normal, or 0.
FN float probeShare(GLOBAL(DeviceProbe, probes) uint k, uint on, uint index, vec3 x, vec3 n, float spacing) {
    if (probes[k].on != on || (probes[k].index != PROBE_ALL && probes[k].index != index)) return 0.0f;
    vec3 low = probes[k].low.xyz;
    vec3 high = probes[k].high.xyz;
    return footprintWithin(x.x, n.x, low.x, high.x, spacing) * footprintWithin(x.y, n.y, low.y, high.y, spacing) *
           footprintWithin(x.z, n.z, low.z, high.z, spacing);
}

// `impulse`: of the wall on the particle, N s; it counts only if it is finite.
#define PROBE_ADD(on_, index_, impulse_, x_, n_)                                                                  \
    if (SQUARE_BELOW(dot(impulse_, impulse_), 1.0e30f)) {                                                         \
        for (uint k_ = 0u; k_ < probes[0].count; ++k_) {                                                          \
            float share_ = probeShare(PASS(probes) k_, on_, index_, x_, n_, PARAMS.spacing);                      \
            if (share_ > 0.0f) {                                                                                  \
                vec3 load_ = (impulse_) * (-share_);                                                              \
                uint row_ = k_ * PROBE_THREADS + t;                                                               \
                rows[row_].impulse = rows[row_].impulse + vec4(load_, -dot(load_, n_));                           \
                rows[row_].angular = rows[row_].angular + vec4(cross((x_) - probes[k_].about.xyz, load_), 0.0f);  \
            }                                                                                                     \
        }                                                                                                         \
    }

// The box has six faces: -x, +x, -y, +y, -z, +z. Their normals point into the fluid.
FN vec3 faceNormal(uint face) {
    float side = (face & 1u) == 0u ? 1.0f : -1.0f;
    return vec3(face < 2u ? side : 0.0f, face == 2u || face == 3u ? side : 0.0f, face > 3u ? side : 0.0f);
}
