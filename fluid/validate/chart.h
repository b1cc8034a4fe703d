// Speed against accuracy: every setting of every method, run on the physics cases at several resolutions, with its cost.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fluid/session/chart_table.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

// Numerical viscosity of pbf, measured on the standing wave, by corrections per step and steps per frame.
struct ViscosityRow {
    int iterations = 0, stepsPerFrame = 0;
    double viscosity = 0, periodError = 0, wallPerSecond = 0;  // m^2/s, a fraction, s
};

struct Chart {
    std::vector<ChartRow> rows;
    std::vector<ViscosityRow> viscosity;
    std::vector<std::string> refused;  // "CASE, SETTING: reason" of each combination that could not be run
    bool stopped = false;
};

struct ChartRequest {
    Device* device = nullptr;
    bool quick = false;              // fewer cases and resolutions
    std::vector<std::string> names;  // cases; all when empty
    std::function<bool(double share, const std::string& what)> goOn = [](double, const std::string&) { return true; };
};
Result<Chart> runChart(const ChartRequest& request);

// One measurement: a row, or a viscosity, or the reason why there is none. All empty: the combination is left out.
struct ChartPoint {
    std::optional<ChartRow> row;
    std::optional<ViscosityRow> viscosity;
    std::string refused;  // as Chart::refused
    bool stopped = false;
};
// A chart is the points 0 to chartPoints() - 1, added in this order, then markFront(). Each may be measured by another process.
size_t chartPoints(const ChartRequest& request);
Result<ChartPoint> runChartPoint(const ChartRequest& request, size_t k);
void addPoint(Chart& chart, const ChartPoint& point);

std::vector<std::string> chartCases();  // names
// What the chart sets in a case at all sizes: "duration=8"; empty: nothing.
std::string_view chartAssignments(std::string_view name);

void markFront(std::vector<ChartRow>& rows);

// Writes into `folder`: speed_accuracy.csv, speed_accuracy_CASE.svg, pbf_viscosity.csv and .svg, and speed_accuracy.md, which explains them
// and names `machine` and `command`. Error (failed): gnuplot is not installed, or a file cannot be written.
Status writeChart(const Chart& chart, const std::string& folder, const std::string& machine, const std::string& command);

}  // namespace rivulet
