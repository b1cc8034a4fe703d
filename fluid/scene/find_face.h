// Finds a face in a mesh that has no marks: its eyes, lower lids and tear points, nose and chin, and where up and forward are.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/model.h"

namespace rivulet {

// All points in the frame and unit of the parts.
struct FoundEye {
    vec3 inner{0.0F}, outer{0.0F};  // corners, on the skin
    vec3 tear{0.0F};                // on the skin, below the inner corner
    std::vector<vec3> lowerLid;     // 25 points along its edge, from the inner to the outer corner
    vec3 centre{0.0F};              // of the eyeball
    float radius = 0;               // of the eyeball; 0: there is no ball
};

struct FoundFace {
    // How the eyes were found: by two balls behind openings of the skin, by two holes of the skin alone, or, in a skin without openings, by
    // the proportions of a face between its nose and its sockets. none: there are no eyes, `missing` says why.
    enum class By { none, balls, holes, proportions };
    By by = By::none;
    std::array<FoundEye, 2> eyes;    // left, right, as the face sees them; if `by` is not none
    vec3 up{0, 1, 0};                // unit; if `by` is not none, as the next ones
    vec3 forward{0, 0, 1};           // unit
    std::optional<vec3> nose;        // the tip
    std::optional<vec3> chin;        // the lowest point of the front, below the mouth
    std::vector<std::string> balls;  // nameOf the parts that hold the eyeballs
    std::string missing;             // one sentence about what was not found; "" where all was

    bool found() const { return by != By::none; }
    float eyeDistance() const;  // between the middles of the two lids
};

// Its name, and in brackets its material if that has another.
std::string nameOf(const ModelPart& part);

// `parts`: in one common frame, of any unit and orientation. `skin`: index of the part whose lids are wanted. Lengths are judged against
// the mesh itself. A face looks along an axis of the frame, or, with eyeballs, in any direction. Takes time in proportion to the triangles.
FoundFace findFace(std::span<const ModelPart> parts, size_t skin);

}  // namespace rivulet
