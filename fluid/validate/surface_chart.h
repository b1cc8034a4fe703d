// Quality of the drawn surface against its cost: every filter at every quality, on the trials of the case `surface`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fluid/validate/surface_trial.h"

namespace rivulet {

// Spacings. All filters are also charted with this reach, to separate the kind of a filter from its reach.
constexpr float kShortReach = 1.0F;

struct SurfaceChartRow {
    SurfaceLook look;
    DrawTimes times;                     // of the moment of the dam break
    SurfaceErrors sphere, slab;          // of the judged shapes
    std::optional<MomentErrors> moment;  // against the reference; empty for the reference itself
    Steadiness still, slow;              // of 255
};

struct SurfaceChart {
    std::vector<SurfaceChartRow> rows;  // the default filter first, the reference last
    int width = 0, height = 0;          // pixels
    size_t particles = 0;               // of the dam break
    int slowFrames = 0, stillFrames = 0;
    std::string drawnBy;
    bool stopped = false;
};

struct SurfaceChartRequest {
    Device* device = nullptr;
    Log log = {};
    std::function<bool(double share, const std::string& what)> goOn = [](double, const std::string&) { return true; };
    bool quick = false;
};
// Error (failed): there is no OpenGL.
Result<SurfaceChart> runSurfaceChart(const SurfaceChartRequest& request);

// Writes FOLDER/surface.csv, surface.svg and surface.md, which explains them and names `machine` and `command`. Error (failed): a file
// cannot be written; or gnuplot is missing: the table and the page are written nevertheless.
Status writeSurfaceChart(const SurfaceChart& chart, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
