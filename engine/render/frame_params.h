// FrameParams: what every render pass knows of the frame, packed for the shaders.
#pragma once

#include "engine/core/math.h"
#include "engine/render/frame_view.h"
#include "shaders/render/frame.h"

namespace rivulet {

// What the studio looks like; colours linear.
struct Studio {
    vec3 horizon{0.80F, 0.84F, 0.88F};
    vec3 zenith{0.30F, 0.42F, 0.58F};
    vec3 floor{0.42F, 0.40F, 0.38F};
    float floorHeight = 0.0F;  // m
    bool showFloor = true;
    Bounds shown;  // m; what the picture is about: the floor fades around it
};

// The uniform block of a frame. `meshes`, `water`: the world bounds that the light's maps must cover (m); empty: no map.
FrameParams packFrame(const FrameView& view, const Studio& studio, const Bounds& meshes, const Bounds& water);

}  // namespace rivulet
