// Repeats the measurements of the thesis, chapter 4 (thesis 4.4): frames per second with and without collision against the number of
// particles (fig. 4.8), and the size of work groups.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

constexpr int kThesisParticles = 16384, kThesisWorkGroup = 128;  // of the thesis's headline figure
constexpr double kThesisFrames = 15;                             // frames per second at least, with collision, on a GTX 650
constexpr int kThesisHalf = 4000;                                // above this number of particles collision costs about half the frame

struct Chapter4Row {
    int particles = 0;
    std::string grid = {};  // fluid.grid
    std::string walk = {};  // fluid.collision.walk; "" = without collision
    int workGroup = 0;
    bool sizes = false;                         // a row of the comparison of work groups
    Spread frames = {};                         // frames per second, over the runs
    std::vector<double> runMs = {};             // ms per frame of each run; run k of two rows can be compared
    double frameMs = 0;                         // medians
    double stepMs = 0, drawMs = 0;              // its parts
    std::map<std::string, double> passes = {};  // ms per frame of each kernel of a step; means
};

struct Chapter4 {
    std::vector<Chapter4Row> rows;
    std::string drawnBy;
    int width = 0, height = 0;  // pixels
    std::string mesh;           // the collider
    int voxels = 0;             // along its longest side
    bool stopped = false;
};

struct Chapter4Request {
    Device* device = nullptr;  // gl, its context current
    Log log = {};
    int runs = 5;
    std::vector<int> particles = {1024, 2048, 4096, 8192, 16384, 32768};  // powers of two
    std::vector<int> workGroups = {32, 64, 128, 256, 512};  // compared at the last but one number of particles, or the only one
    std::function<void(const Chapter4Row&)> report = [](const Chapter4Row&) {};
    std::function<bool()> goOn = [] { return true; };
};
// Rows that are compared run in turn. Error (failed): a shader does not compile, or memory is exhausted.
Result<Chapter4> runChapter4(const Chapter4Request& request);

// Writes FOLDER/chapter4.csv, chapter4.svg and chapter4.md, which compares the results with the thesis; `machine` and `command` are named
// in it. Error (failed): a file cannot be written; or gnuplot is missing: the table and the page are written nevertheless.
Status writeChapter4(const Chapter4& chapter, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
