// Features of a face in a depth map: the opening of an eye, nose and chin.
#pragma once

#include <optional>
#include <vector>

#include "fluid/scene/depth_map.h"

namespace rivulet {

constexpr size_t kLidPoints = 25;
// The place of a tear's start beside the inner corner, in distances between the eyes: outwards and downwards.
constexpr float kTearOut = 0.03F, kTearDown = 0.033F;

// An opening of the skin, seen along the frame's z: its corners and its lower edge. In the frame of the mesh.
struct Opening {
    vec3 inner{0.0F}, outer{0.0F};
    std::vector<vec3> lower;
    vec3 tear{0.0F};
};

// `frame`: about the ball; its x points away from the nose. `radius`: of the ball, or of one that would lie behind a hole. `ball`: false
// where only a hole is there. `apart`: between the eyes. Nothing if there is no opening, if no skin surrounds it, or if it is a slit.
std::optional<Opening> openingAt(const ViewFrame& frame, const std::vector<vec3>& skin, float radius, bool ball, float apart);

struct NoseAndChin {
    std::optional<vec3> nose, chin;  // in the frame
    float prominence = -1;           // of the nose, before the eyes' corners and the brow
};

// `d`: the distance between the eyes; the frame's origin lies between them. `cornerZ`: of the eyes' inner corners. No nose: prominence is
// -1 or less than 0.05; no chin: the front ends above it.
NoseAndChin noseAndChin(const ViewFrame& frame, const std::vector<vec3>& skin, float d, float cornerZ);

}  // namespace rivulet
