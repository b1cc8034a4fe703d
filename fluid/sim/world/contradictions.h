// Values of a scene's water that contradict each other, each within its range: what a scene file, the C interface and the program refuse
// alike.
#pragma once

#include <string>
#include <string_view>

#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

inline constexpr double kLongestFrame = 3600;  // s: a longer step is refused

// "", or the first contradiction: "fluid.box.min (...) must lie below ...".
std::string contradiction(const FluidParams& fluid);
// The same of emitters[index], which is in the box if it is no mesh.
std::string contradiction(const EmitterParams& emitter, size_t index, const BoxParams& box);
// "", or that a place is not in the box: "bodies[2].position (...) must lie in fluid.box from (...) to (...)".
std::string outside(std::string_view what, const vec3& place, const BoxParams& box);

}  // namespace rivulet
