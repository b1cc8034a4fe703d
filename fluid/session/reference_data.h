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
// The tables under assets/gpus, of the cost model (fluid/validate/gpu_cost.h).
std::span<const ReferenceTable> gpuTables();

// The cells of a table as text. A column that is not there is a programming error (ASSERT).
struct ReferenceRows {
    std::vector<std::string_view> columns;
    std::vector<std::vector<std::string_view>> rows;
    size_t column(std::string_view name) const;
};
ReferenceRows rowsOf(std::span<const ReferenceTable> tables, std::string_view name);  // the table must be there
double numberIn(std::string_view cell);                                               // 0: empty

// Two columns of a table, by number. The table must be there.
std::vector<glm::dvec2> referenceCurve(std::string_view name, size_t x = 0, size_t y = 1);

// The curve at `x`, by straight lines between its points; beyond its ends the end's value.
double valueAt(std::span<const glm::dvec2> curve, double x);

}  // namespace rivulet
