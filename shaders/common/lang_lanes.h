// `real` in a kernel unit: eight lanes, one for each particle; loads and stores of groups of particles.
// Part of lang_cpp.h, which includes it.
#pragma once

namespace rivulet::RIVULET_KERNEL_UNIT {

typedef float Lanes __attribute__((vector_size(32)));
typedef int LaneMask __attribute__((vector_size(32)));
struct real {
    Lanes v;
    real() = default;
    INLINE real(float s) : v{s, s, s, s, s, s, s, s} {}
    INLINE real(Lanes l) : v(l) {}
};
INLINE real operator+(real a, real b) { return a.v + b.v; }
INLINE real operator-(real a, real b) { return a.v - b.v; }
INLINE real operator*(real a, real b) { return a.v * b.v; }
INLINE real operator/(real a, real b) { return a.v / b.v; }
INLINE real operator-(real a) { return -a.v; }
INLINE real& operator+=(real& a, real b) {
    a.v += b.v;
    return a;
}
INLINE real& operator-=(real& a, real b) {
    a.v -= b.v;
    return a;
}
INLINE real& operator*=(real& a, real b) {
    a.v *= b.v;
    return a;
}
INLINE LaneMask operator<(real a, real b) { return a.v < b.v; }
INLINE LaneMask operator>(real a, real b) { return a.v > b.v; }
INLINE LaneMask operator<=(real a, real b) { return a.v <= b.v; }
INLINE LaneMask operator>=(real a, real b) { return a.v >= b.v; }
#if defined(__AVX__)
INLINE real max(real a, real b) { return real(static_cast<Lanes>(_mm256_max_ps(a.v, b.v))); }  // a NaN in a gives b
INLINE real min(real a, real b) { return real(static_cast<Lanes>(_mm256_min_ps(a.v, b.v))); }
INLINE real sqrt(real a) { return real(static_cast<Lanes>(_mm256_sqrt_ps(a.v))); }
INLINE real floor(real a) { return real(static_cast<Lanes>(_mm256_floor_ps(a.v))); }
INLINE bool anyLane(LaneMask m) { return _mm256_movemask_ps(reinterpret_cast<__m256>(m)) != 0; }
INLINE real select(LaneMask m, real a, real b) { return real(static_cast<Lanes>(_mm256_blendv_ps(b.v, a.v, reinterpret_cast<__m256>(m)))); }
#else
INLINE real perLane(real a, float (*f)(float)) {
    for (int k = 0; k < 8; ++k) a.v[k] = f(a.v[k]);
    return a;
}
INLINE real max(real a, real b) {
    for (int k = 0; k < 8; ++k) a.v[k] = a.v[k] > b.v[k] ? a.v[k] : b.v[k];
    return a;
}
INLINE real min(real a, real b) {
    for (int k = 0; k < 8; ++k) a.v[k] = a.v[k] < b.v[k] ? a.v[k] : b.v[k];
    return a;
}
INLINE real sqrt(real a) {
    for (int k = 0; k < 8; ++k) a.v[k] = __builtin_sqrtf(a.v[k]);
    return a;
}
INLINE real floor(real a) {
    for (int k = 0; k < 8; ++k) a.v[k] = __builtin_floorf(a.v[k]);
    return a;
}
INLINE bool anyLane(LaneMask m) {
    int any = 0;
    for (int k = 0; k < 8; ++k) any |= m[k];
    return any != 0;
}
INLINE real select(LaneMask m, real a, real b) {
    for (int k = 0; k < 8; ++k) a.v[k] = m[k] ? a.v[k] : b.v[k];
    return a;
}
#endif
INLINE real max0(real a) { return max(a, real(0.0f)); }
INLINE float max0(float a) { return a > 0.0f ? a : 0.0f; }
INLINE float select(bool c, float a, float b) { return c ? a : b; }
INLINE real select(bool c, real a, real b) { return c ? a : b; }
#define SELECT(condition, a, b) select(condition, a, b)
#define ANY_LANE(condition) anyLane(condition)

struct real3 {
    real x, y, z;
    real3() = default;
    INLINE real3(real ax, real ay, real az) : x(ax), y(ay), z(az) {}
    INLINE real3(const vec3& v) : x(v.x), y(v.y), z(v.z) {}
};
INLINE real3 operator+(const real3& a, const real3& b) { return real3(a.x + b.x, a.y + b.y, a.z + b.z); }
INLINE real3 operator-(const real3& a, const real3& b) { return real3(a.x - b.x, a.y - b.y, a.z - b.z); }
INLINE real3 operator*(const real3& a, real b) { return real3(a.x * b, a.y * b, a.z * b); }
INLINE real3 operator*(real a, const real3& b) { return b * a; }
INLINE real3 operator*(const real3& a, float b) { return a * real(b); }
INLINE real3 operator*(float a, const real3& b) { return b * real(a); }
INLINE real3 operator*(const vec3& a, real b) { return real3(a.x * b, a.y * b, a.z * b); }
INLINE real3 operator-(const real3& a) { return real3(-a.x, -a.y, -a.z); }
INLINE real3& operator+=(real3& a, const real3& b) { return a = a + b; }
INLINE real3& operator-=(real3& a, const real3& b) { return a = a - b; }
INLINE real dot(const real3& a, const real3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// A group: up to 8 consecutive particles of one row of cells. Lanes beyond `lanes` repeat the last particle and are never stored.
struct Group {
    uint first, lanes, listBegin, listCount;
    uint seenCount;  // the first entries of the list: those of which a lane may see an image, see fluid/solids/images.h
};
struct NeighborLists {
    const Group* groups;
    uint* list;
    const Group* samples;
};
INLINE float LOAD(const float* b, uint j) { return b[j]; }
INLINE uint LOAD(const uint* b, uint j) { return b[j]; }
INLINE vec4 LOAD(const vec4* b, uint j) { return b[j]; }
INLINE vec3 LOAD3(const vec4* b, uint j) { return b[j].xyz; }
INLINE float LOADX(const vec4* b, uint j) { return b[j].x; }
INLINE float LOADY(const vec4* b, uint j) { return b[j].y; }
INLINE float LOADZ(const vec4* b, uint j) { return b[j].z; }
INLINE float LOADW(const vec4* b, uint j) { return b[j].w; }
INLINE uint laneOf(const Group& g, uint k) { return g.first + (k < g.lanes ? k : g.lanes - 1); }
INLINE real LOAD(const float* b, const Group& g) {
    real r;
    if (g.lanes == 8) {
        memcpy(&r.v, b + g.first, sizeof r.v);
        return r;
    }
    for (uint k = 0; k < 8; ++k) r.v[k] = b[laneOf(g, k)];
    return r;
}
struct real4 {
    real3 xyz;
    real w;
};
INLINE real4 loadLanes(const vec4* b, const Group& g) {
    real4 r;
#if defined(__AVX__)
    const float* p[8];
    for (uint k = 0; k < 8; ++k) p[k] = &b[laneOf(g, k)].x;
    const __m256 l0 = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(p[0])), _mm_load_ps(p[4]), 1);
    const __m256 l1 = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(p[1])), _mm_load_ps(p[5]), 1);
    const __m256 l2 = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(p[2])), _mm_load_ps(p[6]), 1);
    const __m256 l3 = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(p[3])), _mm_load_ps(p[7]), 1);
    const __m256 xy01 = _mm256_unpacklo_ps(l0, l1), zw01 = _mm256_unpackhi_ps(l0, l1), xy23 = _mm256_unpacklo_ps(l2, l3),
                 zw23 = _mm256_unpackhi_ps(l2, l3);
    r.xyz.x.v = static_cast<Lanes>(_mm256_shuffle_ps(xy01, xy23, 0x44));
    r.xyz.y.v = static_cast<Lanes>(_mm256_shuffle_ps(xy01, xy23, 0xEE));
    r.xyz.z.v = static_cast<Lanes>(_mm256_shuffle_ps(zw01, zw23, 0x44));
    r.w.v = static_cast<Lanes>(_mm256_shuffle_ps(zw01, zw23, 0xEE));
#else
    for (uint k = 0; k < 8; ++k) {
        const vec4& a = b[laneOf(g, k)];
        r.xyz.x.v[k] = a.x;
        r.xyz.y.v[k] = a.y;
        r.xyz.z.v[k] = a.z;
        r.w.v[k] = a.w;
    }
#endif
    return r;
}
INLINE real4 LOAD4_AT(const vec4* b, const Group& g, uint offset) { return loadLanes(b + offset, g); }
INLINE real3 LOAD3(const vec4* b, const Group& g) { return loadLanes(b, g).xyz; }
INLINE real LOADX(const vec4* b, const Group& g) { return loadLanes(b, g).xyz.x; }
INLINE real LOADY(const vec4* b, const Group& g) { return loadLanes(b, g).xyz.y; }
INLINE real LOADZ(const vec4* b, const Group& g) { return loadLanes(b, g).xyz.z; }
INLINE real LOADW(const vec4* b, const Group& g) { return loadLanes(b, g).w; }
INLINE void STORE(float* b, const Group& g, real v) {
    if (g.lanes == 8) {
        memcpy(b + g.first, &v.v, sizeof v.v);
        return;
    }
    for (uint k = 0; k < g.lanes; ++k) b[g.first + k] = v.v[k];
}
INLINE void STORE4(vec4* b, const Group& g, const real3& v, real w) {
    float x[8], y[8], z[8], ws[8];
    memcpy(x, &v.x.v, 32);
    memcpy(y, &v.y.v, 32);
    memcpy(z, &v.z.v, 32);
    memcpy(ws, &w.v, 32);
    for (uint k = 0; k < g.lanes; ++k) b[g.first + k] = vec4(x[k], y[k], z[k], ws[k]);
}
INLINE void STORE4_AT(vec4* b, const Group& g, uint offset, const real3& v, real w) { STORE4(b + offset, g, v, w); }
INLINE void STORE4(vec4* b, uint i, const vec3& v, float w) { b[i] = vec4(v, w); }
template <class T>
INLINE void STORE(T* b, uint i, const T& v) {
    b[i] = v;
}
}  // namespace rivulet::RIVULET_KERNEL_UNIT
