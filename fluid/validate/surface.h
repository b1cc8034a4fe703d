// The case surface: what `rivulet validate surface` measures of each filter.
#pragma once

#include <string>
#include <vector>

#include "fluid/validate/physics_case.h"

namespace rivulet {

// The filters, the default first, and "reference": the ray-marched iso-surface itself, against analytic shapes alone.
std::vector<std::string> surfaceMethods();

// Normals' errors in deg, depths' in radii of a drawn particle, flicker in 255ths. Error (failed): there is no OpenGL.
Result<Outcome> runSurface(const CaseSettings& settings);

}  // namespace rivulet
