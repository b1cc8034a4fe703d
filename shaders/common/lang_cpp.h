// lang.h for a C++ compiler. It has two users: the host, which needs the layout of shared structs (glm vectors), and a kernel unit
// (RIVULET_KERNEL_UNIT), which is compiled once for each instruction set inside a namespace of its own; there `real` is 8 lanes.
#if !defined(RIVULET_KERNEL_UNIT)

// No #pragma once: each shared header includes lang.h again, and lang_end.h last, so that none of these macros reaches a host, and a host's
// own macros of these names stay as they are.
#include "engine/core/math.h"
#pragma push_macro("FN")
#pragma push_macro("STRUCT")
#pragma push_macro("CONSTANT")
#pragma push_macro("GLOBAL")
#pragma push_macro("PASS")
#pragma push_macro("EXACT")
#pragma push_macro("TO_INT")
#pragma push_macro("TO_UINT")
#pragma push_macro("TO_DOUBLE")
#undef FN
#undef STRUCT
#undef CONSTANT
#undef GLOBAL
#undef PASS
#undef EXACT
#undef TO_INT
#undef TO_UINT
#undef TO_DOUBLE
#define FN inline
#define STRUCT(n) struct n
#define CONSTANT(T, n, v) inline constexpr T n = v
#define GLOBAL(T, n) const T *n,
#define PASS(n) n,
#define EXACT
#define TO_INT(x) static_cast<int>(x)
#define TO_UINT(x) static_cast<unsigned>(x)
#define TO_DOUBLE(x) static_cast<double>(x)
namespace rivulet {
using uint = unsigned;
}

#else

#pragma once
#if defined(__AVX__)
#include <immintrin.h>
#endif
#include <math.h>
#include <stdint.h>
#include <string.h>

namespace rivulet::RIVULET_KERNEL_UNIT {

#define INLINE inline __attribute__((always_inline))

using uint = unsigned;
struct vec2 {
    float x, y;
    vec2() = default;
    INLINE vec2(float ax, float ay) : x(ax), y(ay) {}
};
struct vec3 {
    float x, y, z;
    vec3() = default;
    INLINE explicit vec3(float s) : x(s), y(s), z(s) {}
    INLINE vec3(float ax, float ay, float az) : x(ax), y(ay), z(az) {}
};
struct alignas(16) vec4 {
    union {
        struct {
            float x, y, z, w;
        };
        vec3 xyz;
    };
    vec4() = default;
    INLINE vec4(float ax, float ay, float az, float aw) : x(ax), y(ay), z(az), w(aw) {}
    INLINE vec4(const vec3& v, float aw) : x(v.x), y(v.y), z(v.z), w(aw) {}
};
typedef float Four __attribute__((vector_size(16)));  // four at once; the compiler would otherwise compute one after the other
INLINE Four fourOf(const vec4& a) {
    Four v;
    memcpy(&v, &a, 16);
    return v;
}
INLINE vec4 vec4Of(Four v) {
    vec4 a;
    memcpy(&a, &v, 16);
    return a;
}
INLINE vec4 operator+(const vec4& a, const vec4& b) { return vec4Of(fourOf(a) + fourOf(b)); }
INLINE vec4 operator-(const vec4& a, const vec4& b) { return vec4Of(fourOf(a) - fourOf(b)); }
INLINE vec4 operator*(const vec4& a, float b) { return vec4Of(fourOf(a) * b); }
INLINE vec4 min(const vec4& a, const vec4& b) { return vec4Of(fourOf(b) < fourOf(a) ? fourOf(b) : fourOf(a)); }
INLINE vec4 max(const vec4& a, const vec4& b) { return vec4Of(fourOf(a) < fourOf(b) ? fourOf(b) : fourOf(a)); }
struct ivec3 {
    int x, y, z;
    ivec3() = default;
    INLINE explicit ivec3(int s) : x(s), y(s), z(s) {}
    INLINE ivec3(int ax, int ay, int az) : x(ax), y(ay), z(az) {}
};
#define RIVULET_VEC_OP(op)                                                                                     \
    INLINE vec3 operator op(const vec3& a, const vec3& b) { return vec3(a.x op b.x, a.y op b.y, a.z op b.z); } \
    INLINE vec3 operator op(const vec3& a, float b) { return vec3(a.x op b, a.y op b, a.z op b); }             \
    INLINE vec3 operator op(float a, const vec3& b) { return vec3(a op b.x, a op b.y, a op b.z); }
RIVULET_VEC_OP(+)
RIVULET_VEC_OP(-) RIVULET_VEC_OP(*) RIVULET_VEC_OP(/)
#undef RIVULET_VEC_OP
    INLINE vec3
    operator-(const vec3& a) {
    return vec3(-a.x, -a.y, -a.z);
}
INLINE vec3& operator+=(vec3& a, const vec3& b) { return a = a + b; }
INLINE vec3& operator-=(vec3& a, const vec3& b) { return a = a - b; }
INLINE vec3& operator*=(vec3& a, float b) { return a = a * b; }
INLINE ivec3 operator+(const ivec3& a, const ivec3& b) { return ivec3(a.x + b.x, a.y + b.y, a.z + b.z); }
INLINE ivec3 operator-(const ivec3& a, const ivec3& b) { return ivec3(a.x - b.x, a.y - b.y, a.z - b.z); }

INLINE float min(float a, float b) { return b < a ? b : a; }
INLINE float max(float a, float b) { return a < b ? b : a; }
INLINE int min(int a, int b) { return b < a ? b : a; }
INLINE int max(int a, int b) { return a < b ? b : a; }
INLINE uint min(uint a, uint b) { return b < a ? b : a; }
INLINE uint max(uint a, uint b) { return a < b ? b : a; }
INLINE float clamp(float x, float lo, float hi) { return min(max(x, lo), hi); }
INLINE int clamp(int x, int lo, int hi) { return min(max(x, lo), hi); }
INLINE float sqrt(float x) { return __builtin_sqrtf(x); }
INLINE float abs(float x) { return __builtin_fabsf(x); }
INLINE float floor(float x) { return __builtin_floorf(x); }
INLINE float dot(const vec3& a, const vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE float length(const vec3& a) { return sqrt(dot(a, a)); }
INLINE vec3 cross(const vec3& a, const vec3& b) { return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
INLINE vec3 min(const vec3& a, const vec3& b) { return vec3(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)); }
INLINE vec3 max(const vec3& a, const vec3& b) { return vec3(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)); }
INLINE vec3 floor(const vec3& a) { return vec3(floor(a.x), floor(a.y), floor(a.z)); }
INLINE vec3 abs(const vec3& a) { return vec3(abs(a.x), abs(a.y), abs(a.z)); }
INLINE float mix(float a, float b, float t) { return a + (b - a) * t; }
INLINE ivec3 TO_IVEC3(const vec3& v) { return ivec3(static_cast<int>(v.x), static_cast<int>(v.y), static_cast<int>(v.z)); }
INLINE vec3 TO_VEC3(const ivec3& v) { return vec3(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)); }
INLINE uint FLOAT_BITS(float f) {
    uint u;
    memcpy(&u, &f, 4);
    return u;
}
INLINE float BITS_FLOAT(uint u) {
    float f;
    memcpy(&f, &u, 4);
    return f;
}
INLINE void atomicMin(uint* x, uint v) {
    uint had = __atomic_load_n(x, __ATOMIC_RELAXED);
    while (v < had && !__atomic_compare_exchange_n(x, &had, v, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
}
// A bit that is there is not written again: other threads would lose the cache line.
INLINE uint atomicOr(uint* x, uint bits) {
    const uint had = __atomic_load_n(x, __ATOMIC_RELAXED);
    return (had & bits) == bits ? had : __atomic_fetch_or(x, bits, __ATOMIC_RELAXED);
}
INLINE void atomicMax(uint* p, uint v) {
    uint had = __atomic_load_n(p, __ATOMIC_RELAXED);
    while (had < v && !__atomic_compare_exchange_n(p, &had, v, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
}
#define SQUARE_BELOW(x, limit) (FLOAT_BITS(x) < FLOAT_BITS(limit))
#define TO_INT(x) static_cast<int>(x)
#define TO_UINT(x) static_cast<unsigned>(x)
#define TO_FLOAT(x) static_cast<float>(x)

}  // namespace rivulet::RIVULET_KERNEL_UNIT

#include "shaders/common/lang_lanes.h"
#include "shaders/common/lang_neighbors.h"

#define FN INLINE
#define STRUCT(n) struct n
#define CONSTANT(T, n, v) constexpr T n = v
#define GLOBAL(T, n) [[maybe_unused]] const T *n,
#define PASS(n) n,
#define RO(b, N, T, n) , [[maybe_unused]] const T* __restrict n
#define RW(b, N, T, n) , T* __restrict n
#define RO_CAST(b, N, T, n) , static_cast<const T*>(buffers_[(b)-1])
#define RW_CAST(b, N, T, n) , static_cast<T*>(buffers_[(b)-1])
#define BUFFERS(P)
#define ATOMIC_ADD(x, v) __atomic_fetch_add(&(x), v, __ATOMIC_RELAXED)
#define ATOMIC_OR(x, v) atomicOr(&(x), v)
#define ATOMIC_READ(x) __atomic_load_n(&(x), __ATOMIC_RELAXED)
#define PREFETCH(x) __builtin_prefetch(&(x))
#define ATOMIC_MIN(x, v) atomicMin(&(x), v)
#define ATOMIC_MAX(x, v) atomicMax(&(x), v)
#define KERNEL(name, P)                                                                             \
    static INLINE void name##_one(const uint tid_, [[maybe_unused]] const P& params_ ARGS(RO, RW)); \
    void name(uint32_t begin_, uint32_t end_, const void* p_, void* const* buffers_) {              \
        const P& params_ = *static_cast<const P*>(p_);                                              \
        for (uint32_t t_ = begin_; t_ < end_; ++t_) name##_one(t_, params_ ARGS(RO_CAST, RW_CAST)); \
    }                                                                                               \
    static INLINE void name##_one(const uint tid_, [[maybe_unused]] const P& params_ ARGS(RO, RW))
#define PARAMS params_
#define THREAD_ID tid_
#endif
