// Which triangles a drop's weight rests on where it stands at a place of the skin.
#pragma once

#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

struct Footprint {
    std::vector<uint32_t> begin;     // of each place's, and the end
    std::vector<uint32_t> triangle;  // those that join at the place first
    std::vector<float> weight;       // 0 to 1, of a triangle's area
};

// Triangles that hang together with a place and lie within half of `width` (m, at rest) of it: what is near through the air does not count.
Footprint footprintOf(const FlowMesh& mesh, float width);

}  // namespace rivulet
