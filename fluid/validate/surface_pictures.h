// Pictures of the differences of a drawn surface from the reference: RGBA8, top row first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "fluid/validate/surface_metrics.h"

namespace rivulet {

// flipMap() in grey, black: no difference, white: 0.5 and more.
std::vector<uint8_t> flipPicture(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height);

// Where both have a surface, the angle between normals in grey, white: 45 degrees and more; red: only the measured one has a surface; blue:
// only the reference.
std::vector<uint8_t> errorPicture(const SurfaceMap& measured, const SurfaceMap& reference);

}  // namespace rivulet
