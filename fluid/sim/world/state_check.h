// The numbers that a saved state may hold: a file from anyone is checked before any of them is used.
#pragma once

#include <span>
#include <string_view>

#include "engine/core/math.h"
#include "engine/core/result.h"
#include "fluid/sim/world/pose.h"

namespace rivulet {

// What no world reaches, whatever its params: density ratios; pressures over density, m^2/s^2; times, s. (And kMostDistance, kMostSpeed.)
inline constexpr float kDensest = 1.0e4F, kHighestPressure = 1.0e12F, kLatest = 1.0e9F;

// Error (badInput): names the section, the item and the value of the first that is not from `least` to `most`; NaN is not.
Status checkRange(std::string_view section, std::span<const float> values, float least, float most);
Status checkRange(std::string_view section, std::span<const double> values, double least, double most);
// The same of x, y, z, from -most to most, and of w.
Status checkRange(std::string_view section, std::span<const vec4> values, float most, float leastW, float mostW);
Error outOfRange(std::string_view section, size_t item, double value, double least, double most);

}  // namespace rivulet
