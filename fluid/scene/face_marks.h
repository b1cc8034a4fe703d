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
    vec3 up{0, 1, 0};              // unit, in the same frame
    vec3 forward{0, 0, 1};         // unit: where the face looks
    bool knowsUp = false;          // the file says so; else it is not known how the face stands in the file's frame
    bool knowsForward = false;
};

// The head's own form ({"eyes": {"left": {"tear": {"position", "uv"}, "lower_lid_margin"}}}, and, if known, "up" and "forward"), or the ICT
// head's landmarks ({"tear_points": {"left_inner_corner": {"start_uv"...}}}), which has +y up and +z forward. Error (badInput): no such
// file, no JSON, neither form, values that are not numbers.
Result<FaceMarks> readFaceMarks(const std::string& path);

// The marks in the head's own form: JSON with a line break at its end. Eyes without marks are written without them.
std::string faceMarksText(const FaceMarks& marks);

}  // namespace rivulet
