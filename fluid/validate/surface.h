// The case `surface`: the measurements of `rivulet validate surface` for each filter.
#pragma once

#include <string>
#include <vector>

#include "fluid/validate/physics_case.h"

namespace rivulet {

// The filters, the default first, and "reference": the ray-marched iso-surface, compared only with analytic shapes.
std::vector<std::string> surfaceMethods();

// Errors of normals in degrees, of depth in radii of a drawn particle, flicker in 255ths. Error (failed): there is no OpenGL.
Result<Outcome> runSurface(const CaseSettings& settings);

}  // namespace rivulet
