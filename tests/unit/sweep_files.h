// What tests of `rivulet sweep` share.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/program_runner.h"

namespace rivulet::testing {

// Rows of a table without quotations; the first names the columns.
inline std::vector<std::vector<std::string>> rowsAt(const Scratch& scratch, const std::string& file) {
    std::vector<std::vector<std::string>> rows;
    std::istringstream lines(scratch.text(file));
    for (std::string line; std::getline(lines, line);) {
        rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
    }
    return rows;
}

// Eight tasks of some 20 ms.
inline const std::string kSmallSweep = R"({"command": "run small.json --no-render --backend cpu --frames 2 --stats {task}/stats.json",
    "parameters": {"fluid.viscosity": {"from": 1e-6, "to": 1e-3, "count": 4, "scale": "log"}, "fluid.method": ["pbf", "wcsph"]}})";

}  // namespace rivulet::testing
