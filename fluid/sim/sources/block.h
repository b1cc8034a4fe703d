// A block of particles: the cubic lattice that fills a box or a ball at rest spacing, with optional jitter.
#pragma once

#include <vector>

#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct NewParticle {
    vec3 position;       // m
    vec3 velocity;       // m/s
    uint32_t block = 0;  // which one it is of
};

// How many particles a block's box holds, without making them: a block too large for memory is refused before it is built. A ball has
// fewer.
double blockCount(const BlockParams& block, float spacing);
// Appends the lattice, centred in the block, x fastest; of a ball what lies within. With jitter no particle stands further out than the
// outermost of the lattice; the same every time. An empty or inverted block adds nothing.
void fillBlock(const BlockParams& block, float spacing, std::vector<NewParticle>& to);

}  // namespace rivulet
