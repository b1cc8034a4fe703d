// The drawn surface's quality against what it costs: every filter at every quality, on the trials of the case surface.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fluid/validate/surface_trial.h"

namespace rivulet {

// Spacings: all filters are charted with this reach, too, to tell how they smooth from how far.
constexpr float kShortReach = 1.0F;

struct SurfaceChartRow {
    SurfaceLook look;
    DrawTimes times;                     // of the dam break's moment
    SurfaceErrors sphere, slab;          // of the shapes that are judged
    std::optional<MomentErrors> moment;  // against the reference: not of itself
    double flicker = 0;                  // of 255
};

struct SurfaceChart {
    std::vector<SurfaceChartRow> rows;  // the default filter first, the reference last
    int width = 0, height = 0;          // pixels
    size_t particles = 0;               // of the dam break
    int stillFrames = 0;
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

// FOLDER/surface.csv, surface.svg and surface.md, which reads them aloud. `machine` and `command` say where they come from. Error (failed):
// a file cannot be written; or gnuplot is missing: the table and the page are there all the same.
Status writeSurfaceChart(const SurfaceChart& chart, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
