// FrameParams: the uniform block of a frame, which all render passes read.
#pragma once

#include "engine/core/math.h"
#include "engine/render/frame_view.h"
#include "shaders/render/frame.h"

namespace rivulet {

// The default background, a studio; colours are linear RGB.
struct Studio {
    vec3 horizon{0.80F, 0.84F, 0.88F};
    vec3 zenith{0.30F, 0.42F, 0.58F};
    vec3 floor{0.42F, 0.40F, 0.38F};
    float floorHeight = 0.0F;  // m
    float tiles = 0.0F;        // m, side of the floor's square tiles; 0: a plain floor
    bool showFloor = true;
    float fill = 0.0F, rim = 0.0F;  // light of the softboxes beside and behind, as shares of the key light's; 0: only reflected
    Bounds shown;                   // m; the visible content: the floor fades out around it
};

// Fills the uniform block. `meshes`, `water`: world bounds, m, that the light's shadow and water maps must cover; empty: no map.
FrameParams packFrame(const FrameView& view, const Studio& studio, const Bounds& meshes, const Bounds& water);

}  // namespace rivulet
