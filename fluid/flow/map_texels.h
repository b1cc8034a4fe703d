// Which triangle each texel of a map shows: the tables that drawing a flow into UV rests on, made once a mesh.
#pragma once

#include <span>
#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// See shaders/flow/map_step.h for what is in the words.
struct MapTexels {
    int size = 0;
    std::vector<uint32_t> tile;      // TILE_UINTS each
    std::vector<uint32_t> texel;     // 64 a tile, a word each
    std::vector<uint32_t> pinBegin;  // of each piece's, and the end
    std::vector<uint32_t> pin;
    std::vector<vec4> chart;   // 2 a triangle, see map_step.h
    std::vector<float> cover;  // of every texel of mip 1 and above: how much of it has skin
    size_t inside = 0;         // texels whose centre lies in their triangle: the others are the charts' gutters
    size_t pieces() const { return pinBegin.size() - 1; }
    size_t tiles() const { return texel.size() / 64; }
};

// `taps`: 3 a texel of map.texel, of those that are none whatever. As map_step.h has them, a tile's after the other; `map`'s tiles then say
// where.
std::vector<uint32_t> packTexels(MapTexels& map, std::span<const uint32_t> taps);

// A texel belongs to the triangle in which its centre lies, of several to the first; `gutter` texels round every chart show what its
// triangles would if they went on. `uvs`: 3 a triangle. UVs outside 0 to 1 wrap round. Triangles without area in UV, or with UVs that are
// no numbers or span more than the map, have no texels. `folds`: see fluid/flow/skin_folds.h.
MapTexels layTexels(const FlowMesh& mesh, std::span<const vec2> uvs, std::span<const float> folds, int size, int gutter = 3);

// Barycentric coordinates of a texel on its triangle: as the kernels have them.
SkinPoint skinPointOf(const MapTexels& map, uint32_t word, int x, int y);

}  // namespace rivulet
