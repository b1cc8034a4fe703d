// Landmarks of a face beside its mesh: the origins of tears and the wet edges of the lower lids.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/result.h"

namespace rivulet {

struct EyeMarks {
    std::optional<vec3> tear;    // below the inner corner, on the skin; in the mesh file's unit and frame
    std::optional<vec2> tearUv;  // the same, v up
    std::vector<vec3> lowerLid;  // points along its wet edge
};

struct FaceMarks {
    std::array<EyeMarks, 2> eyes;  // left, right, as the face sees them
};

// The head's own form ({"eyes": {"left": {"tear": {"position", "uv"}, "lower_lid_margin"}}}), or the ICT head's landmarks
// ({"tear_points": {"left_inner_corner": {"start_uv"...}}}). Error (badInput): no such file, no JSON, neither form, values that are not
// numbers.
Result<FaceMarks> readFaceMarks(const std::string& path);

}  // namespace rivulet
