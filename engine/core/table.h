// Tables of rows {name, doc, ...}: methods, forces, renderers, verbs. The JSON reader, the combo boxes and the docs read them.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/abi.h"

namespace rivulet {

// The name among `names` with the smallest edit distance to `typed`, ignoring case; "" if the distance exceeds a third of the length.
std::string nearestName(std::string_view typed, std::span<const std::string> names);

// Row must have `const char* name` and `const char* doc`. A Table does not own its rows, which are constants of the program.
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
    std::vector<std::string> namesOrNone() const {  // "" first: a choice that may be left empty
        std::vector<std::string> all = names();
        all.insert(all.begin(), "");
        return all;
    }
};

}  // namespace rivulet
