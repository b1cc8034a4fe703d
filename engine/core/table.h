// Rows {name, doc, ...}: methods, forces, renderers, demos. The JSON reader, the combo boxes and the docs read the tables.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

// The name among `names` with the smallest edit distance to `typed` (case folded); "" when nothing is near enough to be meant.
std::string nearestName(std::string_view typed, std::span<const std::string> names);

// Row must have `const char* name` and `const char* doc`. A Table does not own its rows: they are constants of the program.
template <class Row>
struct Table {
    std::span<const Row> rows;
    const Row* find(std::string_view name) const {
        for (const Row& row : rows)
            if (name == row.name) return &row;
        return nullptr;
    }
    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (const Row& row : rows) all.emplace_back(row.name);
        return all;
    }
};

}  // namespace rivulet
