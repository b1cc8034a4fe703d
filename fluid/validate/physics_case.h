// Physics cases: a scene, what is measured in it, and what nature, a paper or a formula says it should be. `rivulet validate` runs them,
// `rivulet chart` sweeps them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/math.h"
#include "engine/core/result.h"
#include "engine/core/table.h"

namespace rivulet {

// One figure against its reference.
struct Finding {
    std::string what;  // "pressure", "period"
    std::string unit;  // of measured and reference; "" = none
    double measured = 0, reference = 0;
    double error = 0;                 // a fraction, >= 0: what the case's doc says it is of
    std::optional<double> tolerance;  // of the error; nothing: the figure is only reported
    bool pass() const { return !tolerance || error <= *tolerance; }
};

// What a picture shows: measured as points or a line, the reference beside it.
struct Curve {
    std::string name;
    bool line = true;  // else points
    std::vector<glm::dvec2> points;
};
struct Plot {
    std::string title, x, y;
    std::vector<Curve> curves;
    bool logX = false, logY = false;      // axes
    std::vector<std::string> ticks = {};  // names of x = 0, 1, ...; empty: x is a number
};

struct Outcome {
    std::vector<Finding> findings;
    Plot plot;
    std::string method;        // that ran
    std::string refused = {};  // the sentence with which the method refused the case; empty: it ran
    double spacing = 0;        // m
    uint32_t particles = 0;
    double wallPerSecond = 0;    // s on the wall per simulated second, steps alone
    double sweepsPerSecond = 0;  // over all neighbours, per simulated second: cost whatever the machine
    double stepsPerSecond = 0;
    double compression = 0;  // mean over particles and frames, a fraction
    double fastest = 0;      // m/s, what the water reaches by falling
};

// What a case is run with.
struct CaseSettings {
    Device* device = nullptr;
    std::string method = "dfsph";
    bool quick = false;                    // about 8,000 particles; else the size that the aim is for
    std::vector<std::string> assignments;  // as --set, after the case's own
    Log log = {};
    std::function<bool(double)> goOn = [](double) { return true; };  // asked each frame with the share that is done; false: stop early
};

struct PhysicsCase {
    const char* name;   // and of its scene: cases/NAME.json among the assets
    const char* doc;    // what is measured, against what
    const char* quick;  // assignments, "; " between them, that make it about 8,000 particles
    // Error: the scene is missing, or cannot be run so. A run that was stopped has no findings.
    Result<Outcome> (*run)(const CaseSettings& settings);
    // The method whose tolerances hold, the others beside it. Flow on skins and the drawn surface have methods of their own, and run as
    // they are on any device.
    const char* judged = "dfsph";
};
std::vector<std::string> methodsOf(const PhysicsCase& row);  // that it can be run with, the judged one first
Table<PhysicsCase> physicsCases();

Result<Outcome> runHydrostatic(const CaseSettings& settings);
Result<Outcome> runDamBreak(const CaseSettings& settings);
Result<Outcome> runPoiseuille(const CaseSettings& settings);
Result<Outcome> runCouette(const CaseSettings& settings);
Result<Outcome> runTaylorGreen(const CaseSettings& settings);
Result<Outcome> runStandingWave(const CaseSettings& settings);
Result<Outcome> runMomentum(const CaseSettings& settings);
Result<Outcome> runFloating(const CaseSettings& settings);
Result<Outcome> runSpheric2(const CaseSettings& settings);
Result<Outcome> runTension(const CaseSettings& settings);
Result<Outcome> runFlow(const CaseSettings& settings);

// The case, or what a method says that cannot do it and where dfsph could: then one finding, which says so and is not judged. `cpu`:
// another device's run is compared with it, see compareWithCpu; null: the case is measured. Error: as PhysicsCase::run.
Result<Outcome> runCase(const PhysicsCase& row, const CaseSettings& settings, Device* cpu = nullptr);

// The first half second of the quick size, there and on the cpu: centre of mass, kinetic energy (of the most there was: water at rest has
// next to none) and mean compression, each within 1 %.
Result<Outcome> compareWithCpu(const PhysicsCase& row, const CaseSettings& settings, Device& cpu);

// As an SVG file, by gnuplot. Error (failed): gnuplot is not installed, or the file cannot be written.
Status drawPlot(const Plot& plot, const std::string& path);

}  // namespace rivulet
