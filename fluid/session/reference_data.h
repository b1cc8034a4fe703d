// Published measurements and reference solutions: the tables under assets/reference, each with its source in its first lines, embedded in
// the library.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

struct ReferenceTable {
    std::string_view name;  // of the file, without .csv
    std::string_view text;  // lines of '#', the columns' names, then rows
};
std::span<const ReferenceTable> referenceTables();

// Two columns of a table, by number. The table must be there.
std::vector<glm::dvec2> referenceCurve(std::string_view name, size_t x = 0, size_t y = 1);

// The curve at `x`, by straight lines between its points; beyond its ends the end's value.
double valueAt(std::span<const glm::dvec2> curve, double x);

}  // namespace rivulet
