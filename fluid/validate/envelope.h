// The stability envelope: where each method fails once the program's limits are off (fluid.limits), beside where the literature says it
// does, and what the limits make of the same scene.
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
    std::function<bool()> goOn = [] { return true; };  // asked each frame; false: stop
};

// One method in one scene, something swept until it fails.
struct EnvelopeFinding {
    std::string row, method;
    std::string what;                // is swept, and under which circumstances: "step, nu = 5 m^2/s"
    std::string unit;                // of the figures below; "" = none
    double predicted = 0;            // where the predictor's promise ends
    std::optional<double> measured;  // where it first failed, limits off; nothing: nowhere
    double reached = 0;              // how far was looked
    std::string criterion;           // what failure was taken as

    // With the limits on: asked for what had failed, or for the most that was looked at.
    struct Limited {
        double asked = 0;  // in `unit`
        bool finite = false, bounded = false, nothingLost = false;
        uint64_t steps = 0;
        std::string notice;  // what the program said of it
        bool holds() const { return finite && bounded && nothingLost; }
    } limited;

    double ratio() const { return measured ? *measured / predicted : reached / predicted; }
};

struct EnvelopeRow {
    const char* name;       // and of its scene: stability/NAME.json among the assets
    const char* doc;        // what fails, and why
    const char* predictor;  // the formula, and whose it is
    const char* remark;     // a sentence on what was found; "" = none
    // Error: the scene is missing or cannot be run; failed("...stopped") where goOn said so.
    Result<std::vector<EnvelopeFinding>> (*run)(const EnvelopeSettings& settings);
};
Table<EnvelopeRow> envelope();

// FOLDER/stability.csv, stability.svg (predicted against measured) and stability.md, which reads them aloud. `machine`: as machineName().
// Error (failed): a file cannot be written; or gnuplot is missing: the table and the page are there all the same.
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
