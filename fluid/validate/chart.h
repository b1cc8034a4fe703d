// Speed against accuracy: every setting of every method, run on the physics cases at several resolutions, with what it cost.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "fluid/validate/physics_case.h"

namespace rivulet {

// A way to simulate: a method, how long its steps are and how often it corrects.
struct ChartSetting {
    const char* name;
    const char* doc;
    const char* method;
    const char* assignments;  // "; " between them
    bool quick;               // whether it is run when the chart is to be quick
};
std::vector<std::string> assignmentsOf(std::string_view joined);  // what "; " stands between
// Per method from the cheapest to the most careful; the one without assignments is as the method comes.
Table<ChartSetting> chartSettings();

struct ChartRow {
    std::string name;     // of the case
    std::string what;     // the figure whose error it is
    std::string setting;  // of chartSettings()
    double spacing = 0;   // m
    uint32_t particles = 0;
    double error = 0;            // a fraction
    double wallPerSecond = 0;    // s on the wall per simulated second, steps alone
    double sweepsPerSecond = 0;  // over all neighbours
    double stepsPerSecond = 0;
    double compression = 0;  // mean over particles and frames, a fraction
    double fastest = 0;      // m/s, what the water reaches by falling: FluidWorld::fastestFall
    bool onFront = false;    // no other row of its case is both cheaper and more accurate
};

// What pressure solved in so many corrections, and steps so long, adds to viscosity: of the standing wave, method pbf.
struct ViscosityRow {
    int iterations = 0, stepsPerFrame = 0;
    double viscosity = 0, periodError = 0, wallPerSecond = 0;  // m^2/s, a fraction, s
};

struct Chart {
    std::vector<ChartRow> rows;
    std::vector<ViscosityRow> viscosity;
    std::vector<std::string> refused;  // "CASE, SETTING: why" of what could not be run
    bool stopped = false;
};

struct ChartRequest {
    Device* device = nullptr;
    bool quick = false;              // fewer cases and resolutions
    std::vector<std::string> names;  // cases; all when empty
    std::function<bool(double share, const std::string& what)> goOn = [](double, const std::string&) { return true; };
};
Result<Chart> runChart(const ChartRequest& request);
std::vector<std::string> chartCases();  // names

void markFront(std::vector<ChartRow>& rows);

// Into `folder`: speed_accuracy.csv, speed_accuracy_CASE.svg, pbf_viscosity.csv and .svg, and speed_accuracy.md, which reads them aloud.
// `machine` and `command` say where they come from. Error (failed): gnuplot is not installed, or a file cannot be written.
Status writeChart(const Chart& chart, const std::string& folder, const std::string& machine, const std::string& command);

// docs/speed_accuracy.csv as it was when the program was built.
std::string_view builtInChart();

// "0.5 %", "120 %".
std::string percentText(double fraction);

// The rows of a speed_accuracy.csv. A line that is no row is left out.
std::vector<ChartRow> readChart(std::string_view csv);

}  // namespace rivulet
