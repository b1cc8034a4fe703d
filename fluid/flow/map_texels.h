// The triangle of each texel of a map: the tables for drawing a flow into UV, made once for a mesh.
#pragma once

#include <span>
#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// shaders/flow/map_step.h describes the words.
struct MapTexels {
    int size = 0;
    std::vector<uint32_t> tile;      // TILE_UINTS each
    std::vector<uint32_t> texel;     // 64 a tile, a word each
    std::vector<uint32_t> pinBegin;  // of each piece's, and the end
    std::vector<uint32_t> pin;
    std::vector<vec4> chart;   // 2 a triangle, see map_step.h
    std::vector<float> cover;  // of every texel of mip 1 and above: the share of it with skin
    size_t inside = 0;         // texels whose centre lies in their triangle; the others are gutters of charts
    size_t pieces() const { return pinBegin.size() - 1; }
    size_t tiles() const { return texel.size() / 64; }
};

// `taps`: 3 for each texel of map.texel, any value where there is no texel. Packed tile by tile as in map_step.h; `map`'s tiles get the
// offsets.
std::vector<uint32_t> packTexels(MapTexels& map, std::span<const uint32_t> taps);

// A texel belongs to the first triangle that contains its centre; `gutter` texels round every chart show its triangles extended.
// `uvs`: 3 a triangle. UVs outside 0 to 1 wrap round. Triangles without area in UV, or with UVs that are
// not finite or span more than the map, have no texels. `folds`: see fluid/flow/skin_folds.h.
MapTexels layTexels(const FlowMesh& mesh, std::span<const vec2> uvs, std::span<const float> folds, int size, int gutter = 3);

// Barycentric coordinates of a texel on its triangle, as in the kernels.
SkinPoint skinPointOf(const MapTexels& map, uint32_t word, int x, int y);

}  // namespace rivulet
