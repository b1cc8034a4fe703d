// Vectors and matrices: glm under the project's own names. SI units, right-handed, +Y up.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <type_traits>

#include "engine/core/abi.h"

namespace rivulet {

// Packed, whatever glm's settings in the host are: with GLM_FORCE_DEFAULT_ALIGNED_GENTYPES glm::vec3 is another type, and converts.
template <int N, class T>
using PackedVector = glm::vec<N, T, glm::packed_highp>;
template <int N, class T>
using PackedMatrix = glm::mat<N, N, T, glm::packed_highp>;

using vec2 = PackedVector<2, float>;
using vec3 = PackedVector<3, float>;
using vec4 = PackedVector<4, float>;
using dvec2 = PackedVector<2, double>;
using dvec3 = PackedVector<3, double>;
using dvec4 = PackedVector<4, double>;
using ivec2 = PackedVector<2, int>;
using ivec3 = PackedVector<3, int>;
using uvec2 = PackedVector<2, unsigned>;
using uvec3 = PackedVector<3, unsigned>;
using uvec4 = PackedVector<4, unsigned>;
using bvec3 = PackedVector<3, bool>;
using mat3 = PackedMatrix<3, float>;
using mat4 = PackedMatrix<4, float>;
using dmat3 = PackedMatrix<3, double>;
using dmat4 = PackedMatrix<4, double>;
using quat = glm::qua<float, glm::packed_highp>;
using dquat = glm::qua<double, glm::packed_highp>;

static_assert(sizeof(vec3) == 12 && alignof(vec4) == 4 && std::is_trivially_copyable_v<vec3> && std::is_trivially_copyable_v<mat4>,
              "Rivulet was built with vectors of glm that are packed and trivially copied: in files that include Rivulet, do without the "
              "GLM_FORCE_ macros that change this");
static_assert(offsetof(quat, x) == 0 && offsetof(quat, w) == 12,
              "Rivulet was built with quaternions in the order x, y, z, w: in files that include Rivulet, do without "
              "GLM_FORCE_QUAT_DATA_WXYZ");

inline constexpr float kPi = 3.14159265358979323846F;
inline constexpr double kPiD = 3.14159265358979323846;
inline constexpr float kDegree = kPi / 180.0F;  // rad

inline bool isFinite(const vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// An axis-aligned box; empty until a point is added.
struct Bounds {
    vec3 min{std::numeric_limits<float>::max()};
    vec3 max{std::numeric_limits<float>::lowest()};
    void add(const vec3& p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    vec3 size() const { return max - min; }
    vec3 centre() const { return 0.5F * (min + max); }
};

}  // namespace rivulet
