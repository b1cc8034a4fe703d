// The chart "speed against accuracy": its settings and its measured rows. The program embeds the last measurement; budgets pick from it,
// and `rivulet chart` measures it again.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/table.h"

namespace rivulet {

// A way to simulate: a method, its step length and its iterations.
struct ChartSetting {
    const char* name;
    const char* doc;
    const char* method;
    const char* assignments;  // "; " between them
    bool quick;               // whether `rivulet chart --quick` runs it
    bool picked = true;       // whether a budget may choose it: sleep is the scene's choice
};
std::vector<std::string> assignmentsOf(std::string_view joined);  // separated by "; "
// Per method from the cheapest to the most accurate; the one without assignments has the method's default settings.
Table<ChartSetting> chartSettings();

struct ChartRow {
    std::string name;     // of the case
    std::string what;     // the figure whose error it is
    std::string setting;  // of chartSettings()
    double spacing = 0;   // m
    uint32_t particles = 0;
    double error = 0;            // a fraction
    double wallPerSecond = 0;    // s of wall time per simulated second, steps alone
    double sweepsPerSecond = 0;  // sweeps over neighbours, of the particles awake
    double stepsPerSecond = 0;
    double compression = 0;  // mean over particles and frames, a fraction
    double fastest = 0;      // m/s, reached by falling: FluidWorld::fastestFall
    bool onFront = false;    // no other row of its case is both cheaper and more accurate
};

// assets/reference/speed_accuracy.csv as it was when the program was built.
std::string_view builtInChart();

// "0.5 %", "120 %".
std::string percentText(double fraction);

// The rows of a speed_accuracy.csv. Other lines are skipped.
std::vector<ChartRow> readChart(std::string_view csv);

}  // namespace rivulet
