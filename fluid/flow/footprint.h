// The triangles that support a drop at a place of the skin.
#pragma once

#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

struct Footprint {
    std::vector<uint32_t> begin;     // of each place's, and the end
    std::vector<uint32_t> triangle;  // those that share the place first
    std::vector<float> weight;       // 0 to 1, of a triangle's area
};

// The triangles connected to each place within half of `width` (m, at rest); skin that is near through the air is left out.
Footprint footprintOf(const FlowMesh& mesh, float width);

}  // namespace rivulet
