// A block of particles: the cubic lattice that fills a shape at rest spacing, with optional jitter, and its velocity field.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

inline constexpr uint32_t kNoBlock = 0xffffffffU;  // of a particle that a host placed: it is of the world's own liquid

struct NewParticle {
    vec3 position{0.0F};        // m
    vec3 velocity{0.0F};        // m/s
    uint32_t block = kNoBlock;  // of fluid.blocks
};

// How many particles a block's box holds, without making them: a block too large for memory is refused before it is built. Other shapes
// have fewer.
double blockCount(const BlockParams& block, float spacing);
// Appends the lattice, centred in the block, x fastest; of a ball the sites within. Of a cylinder or a cone, each layer across the axis has
// as many sites as its volume holds, those next to the axis first: the particles have the volume of the layers to within one spacing^3.
// Of a mesh the sites that it encloses: `triangles`, m, three corners each; an open mesh by its generalized winding number
// (voxelize_solid.h). With jitter a particle that lacks a neighbour along an axis keeps its place on that axis, so that surfaces stay flat;
// the same every time. An empty or inverted block adds nothing. `tile`: offsets from the sites, in spacings, of kTile^3 sites, x fastest,
// which are repeated through the block; none: random ones.
inline constexpr int kTile = 24;  // sites along an edge
void fillBlock(const BlockParams& block, float spacing, std::vector<NewParticle>& to, std::span<const vec3> triangles = {},
               std::span<const vec3> tile = {});
// Random offsets of such a tile, as those of a block.
std::vector<vec3> randomTile(float jitter);
// m/s, the velocity field of a block at `at` (m).
vec3 velocityAt(const BlockParams& block, const vec3& at);
// The highest speed of a point between the block's corners at the start, m/s.
float fastestOf(const BlockParams& block);

}  // namespace rivulet
