// rivulet.h's plain numbers as the types of engine/core and fluid/sim.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "fluid/capi/rivulet.h"
#include "fluid/sim/query/volumes.h"
#include "fluid/sim/world/pose.h"

namespace rivulet::capi {

inline void put(const vec3& v, float* to) { std::copy_n(&v.x, 3, to); }
// Whether all are from -most to most; NaN is not.
inline bool areWithin(std::span<const float> values, float most) {
    return std::all_of(values.begin(), values.end(), [most](float v) { return std::abs(v) <= most; });
}
inline constexpr float kBrightest = 1.0e6F;  // radiance, over 1
inline bool isSet(const float* v) { return v[0] != 0 || v[1] != 0 || v[2] != 0; }
inline vec3 vectorOf(const float* v) { return {v[0], v[1], v[2]}; }
inline mat4 matrixOf(const float* m) {
    mat4 out;
    std::memcpy(&out[0][0], m, sizeof out);
    return out;
}
Pose poseOf(const rivulet_pose& pose);
rivulet_pose poseOf(const Pose& pose);

// Error (badInput): an unknown shape.
Result<Volume> volumeOf(const rivulet_volume& volume, const std::string& name);

// A caller's mesh. Error (badInput): NULL arrays, counts that give no triangles, an index without a vertex, values that are not finite.
struct HostMesh {
    std::vector<vec3> positions;
    std::vector<vec2> uvs;
    std::vector<uint32_t> indices;
    MeshView view() const { return {.positions = positions, .indices = indices, .normals = {}, .uvs = uvs}; }
};
Result<HostMesh> meshOf(const rivulet_mesh& mesh, const std::string& name);

}  // namespace rivulet::capi
