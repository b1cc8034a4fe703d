// The stability envelope: the value at which each method fails with the limits off (fluid.limits), the value that the literature predicts,
// and the same scene with the limits on.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "engine/core/table.h"

namespace rivulet {

struct EnvelopeSettings {
    Device* device = nullptr;
    Log log = {};
    std::function<bool()> goOn = [] { return true; };  // called in each frame; false: stop
};

// One method in one scene; one parameter is increased until the scene fails.
struct EnvelopeFinding {
    std::string row, method;
    std::string what;                // the parameter and its conditions: "step, nu = 5 m^2/s"
    std::string unit;                // of the values below; "" = none
    double predicted = 0;            // the limit of the predictor
    std::optional<double> measured;  // the first value that failed, limits off; empty: none
    double reached = 0;              // the greatest value tried
    std::string criterion;           // the definition of failure

    // The run with the limits on, with twice the value that failed or the greatest value tried.
    struct Limited {
        double asked = 0;  // in `unit`
        bool finite = false, bounded = false, nothingLost = false;
        uint64_t steps = 0;
        std::string notice;  // the notices of the program
        bool holds() const { return finite && bounded && nothingLost; }
    } limited;

    double ratio() const { return measured ? *measured / predicted : reached / predicted; }
};

struct EnvelopeRow {
    const char* name;       // and of its scene: stability/NAME.json among the assets
    const char* doc;        // the failure and its cause
    const char* predictor;  // the formula and its source
    const char* remark;     // a remark on the result; "" = none
    // Error: the scene is missing or cannot be run; failed("...stopped") after goOn returned false.
    Result<std::vector<EnvelopeFinding>> (*run)(const EnvelopeSettings& settings);
};
Table<EnvelopeRow> envelope();

// Writes FOLDER/stability.csv, stability.svg (predicted against measured) and stability.md, which explains them. `machine`: as
// machineName(). Error (failed): a file cannot be written; or gnuplot is missing: the table and the page are written nevertheless.
Status writeEnvelope(const std::string& folder, std::span<const EnvelopeFinding> findings, const std::string& machine);

Result<std::vector<EnvelopeFinding>> envelopeOfSound(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfViscosity(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfTension(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfLargeSteps(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfSpikes(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfPbf(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfDfsph(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfPairing(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfClumping(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfDistance(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfTunnelling(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfSpawning(const EnvelopeSettings& settings);
Result<std::vector<EnvelopeFinding>> envelopeOfCoupling(const EnvelopeSettings& settings);

}  // namespace rivulet
