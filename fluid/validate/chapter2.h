// Chapter 2 of the thesis, measured as it measured [2.4]: a cube of water falls; the share of each step (fig. 2.4), and one device against
// the CPU and the GPU together (fig. 2.9).
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
        std::string name;   // what --cooperate auto takes there
        double behind = 0;  // a fraction: what a frame of it takes beyond the best plan's, median of the runs, in each the two of that run
    };
    std::vector<Picked> picked;
    bool stopped = false;
};

struct Chapter2Request {
    GlFacts gl = {};  // of the context that is current
    Log log = {};
    int runs = 5;
    int particles = kChapter2Particles;  // half a cube: 4, 32, 256, ...
    std::vector<int> times = {1, 2, 3, 4, 5, 6, 7, 8};
    std::function<void(const Chapter2Row&)> report = [](const Chapter2Row&) {};
    std::function<bool()> goOn = [] { return true; };
};
// Every plan on every device that there is; those of one number of particles take turns. Error (failed): a shader does not compile, out of
// memory.
Result<Chapter2> runChapter2(const Chapter2Request& request);

// FOLDER/chapter2.csv, chapter2.svg and chapter2.md, which reads them aloud beside the thesis's figures. Error (failed): a file cannot be
// written; or gnuplot is missing: the table and the page are there all the same.
Status writeChapter2(const Chapter2& chapter, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
