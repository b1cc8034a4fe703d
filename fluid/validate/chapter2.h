// Repeats the measurements of the thesis, chapter 2 (thesis 2.4), on a falling column of water: the share of each step (fig. 2.4), and one
// device against CPU and GPU together (fig. 2.9).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/result.h"
#include "fluid/render/backend.h"
#include "fluid/session/autotune.h"

namespace rivulet {

constexpr int kChapter2Particles = 16384;  // times 1..8

struct Chapter2Row {
    int particles = 0;
    PlanTried way = {};  // over the runs
};

struct Chapter2 {
    std::vector<Chapter2Row> rows;
    std::vector<std::string> devices;  // "gl: llvmpipe ..."
    std::string drawnBy;
    int width = 0, height = 0;  // pixels
    struct Picked {
        int particles = 0;
        std::string name;   // the choice of --cooperate auto
        double behind = 0;  // fraction by which its frame time exceeds the best plan's, compared within each run; median of the runs
    };
    std::vector<Picked> picked;
    bool stopped = false;
};

struct Chapter2Request {
    GlFacts gl = {};  // of the current context
    Log log = {};
    int runs = 5;
    int particles = kChapter2Particles;  // half the cube of a power of two: 4, 32, 256, ...
    std::vector<int> times = {1, 2, 3, 4, 5, 6, 7, 8};
    std::function<void(const Chapter2Row&)> report = [](const Chapter2Row&) {};
    std::function<bool()> goOn = [] { return true; };
};
// Every plan on every available device; plans with the same number of particles run in turn. Error (failed): a shader does not compile, or
// memory is exhausted.
Result<Chapter2> runChapter2(const Chapter2Request& request);

// Writes FOLDER/chapter2.csv, chapter2.svg and chapter2.md, which compares the results with the thesis. Error (failed): a file cannot be
// written; or gnuplot is missing: the table and the page are written nevertheless.
Status writeChapter2(const Chapter2& chapter, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
