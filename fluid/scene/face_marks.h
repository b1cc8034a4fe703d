// What is known of a face beside its mesh: where tears begin and where its lower lids have their wet edge.
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
    std::vector<vec3> lowerLid;  // along its wet edge
};

struct FaceMarks {
    std::array<EyeMarks, 2> eyes;  // left, right: the face's own
};

// The head's own form ({"eyes": {"left": {"tear": {"position", "uv"}, "lower_lid_margin"}}}), or the ICT head's landmarks
// ({"tear_points": {"left_inner_corner": {"start_uv"...}}}). Error (badInput): no such file, no JSON, neither form, numbers that are none.
Result<FaceMarks> readFaceMarks(const std::string& path);

}  // namespace rivulet
