// Whether the liquid of a world starts with a free surface, or fills all the space between its walls.
#pragma once

#include <functional>
#include <span>

#include "fluid/sim/sources/block.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

// True if somewhere beside a particle there is room for one more: a point a spacing away along an axis, in the box, at which `maySpawn` is
// true and no other particle is nearer than a spacing. A gap along a wall that is too narrow for a layer is no room.
bool hasFreeSurface(std::span<const NewParticle> particles, const FluidParams& params, const std::function<bool(const vec3&)>& maySpawn);

}  // namespace rivulet
