// Physics cases: a scene, a measurement in it, and the reference from an experiment, a paper or a formula. `rivulet validate` runs them,
// `rivulet chart` sweeps them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
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
    double error = 0;                 // a fraction, >= 0; `what` and the doc of the case name its base
    std::optional<double> tolerance;  // of the error; empty: the figure is only reported
    std::string known = {};           // of a figure that misses its tolerance: the cause, if known_misses.cpp lists it
    bool pass() const { return !tolerance || error <= *tolerance; }
    bool fails() const { return !pass() && known.empty(); }  // a known miss is printed and does not fail a run
};

// A curve of a plot: measured values or the reference.
struct Curve {
    std::string name;
    bool line = true;  // false: points
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
    std::string method;        // the method that ran
    std::string refused = {};  // the sentence with which the method refused the case; empty: the case ran
    double spacing = 0;        // m
    uint32_t particles = 0;
    double wallPerSecond = 0;  // wall seconds of the steps per simulated second
    double sweepsPerSecond =
        0;  // sweeps over all neighbours per simulated second, of the share that is awake: a cost that no machine changes
    double stepsPerSecond = 0;
    double compression = 0;  // mean over particles and frames, a fraction
    double fastest = 0;      // m/s that falling water reaches
};

// Settings of a run.
struct CaseSettings {
    Device* device = nullptr;
    std::string method = "dfsph";
    bool quick = false;                    // about 8,000 particles; false: the size for which tolerances hold
    std::vector<std::string> assignments;  // as --set, applied after those of the case
    // Saves a picture of a case that draws: its name without ending, RGBA8 with the top row first, width, height. Empty: none is drawn.
    std::function<Status(const std::string&, const std::vector<uint8_t>&, int, int)> savePicture = {};
    Log log = {};
    std::function<bool(double)> goOn = [](double) { return true; };  // called in each frame with the finished share; false: stop
};

struct PhysicsCase {
    const char* name;   // and of its scene: cases/NAME.json among the assets
    const char* doc;    // the measurement and its reference
    const char* quick;  // assignments, separated by "; ", for about 8,000 particles
    // Error: the scene is missing, or cannot be run with these settings. A stopped run has no findings.
    Result<Outcome> (*run)(const CaseSettings& settings);
    // The method that is judged by the tolerances; the others are reported. Flow on skins and the drawn surface have methods of their own
    // and run unchanged on any device.
    const char* judged = "dfsph";
    // True: the case sets tolerances of pbf and wcsph too, and they are judged.
    bool everyMethod = false;
    // Of a row that repeats another case with numerical parameters of its own: the name of that case, and the assignments. Such a row is
    // only reported, and only for dfsph: its parameters are not those that users get.
    const char* of = "";
    const char* tuned = "";
    // Four sizes from coarse to fine for orderOf(), separated by " | ", each as `quick`; "" = none.
    const char* sizes = "";
    const char* sceneName() const { return *of != '\0' ? of : name; }
};
std::vector<std::string> methodsOf(const PhysicsCase& row);  // the methods that can run the case, the judged one first
bool judges(const PhysicsCase& row, std::string_view method);
Table<PhysicsCase> physicsCases();
// The tolerance of an error that the method must keep: 5 % for dfsph, 10 % for the others.
double toleranceOf(const CaseSettings& settings);

Result<Outcome> runHydrostatic(const CaseSettings& settings);
Result<Outcome> runDamBreak(const CaseSettings& settings);
Result<Outcome> runPoiseuille(const CaseSettings& settings);
Result<Outcome> runPoiseuilleMesh(const CaseSettings& settings);
Result<Outcome> runPipe(const CaseSettings& settings);
Result<Outcome> runCouette(const CaseSettings& settings);
Result<Outcome> runTaylorGreen(const CaseSettings& settings);
Result<Outcome> runStandingWave(const CaseSettings& settings);
Result<Outcome> runMomentum(const CaseSettings& settings);
Result<Outcome> runFloating(const CaseSettings& settings);
Result<Outcome> runSpheric2(const CaseSettings& settings);
Result<Outcome> runTension(const CaseSettings& settings);
Result<Outcome> runFlow(const CaseSettings& settings);
Result<Outcome> runSloshing(const CaseSettings& settings);
Result<Outcome> runUTube(const CaseSettings& settings);
Result<Outcome> runCavity(const CaseSettings& settings);
Result<Outcome> runCavity400(const CaseSettings& settings);
Result<Outcome> runRotatingPatch(const CaseSettings& settings);
Result<Outcome> runSiphon(const CaseSettings& settings);
Result<Outcome> runEllipticalDrop(const CaseSettings& settings);
Result<Outcome> runPool(const CaseSettings& settings);
Result<Outcome> runSubmerged(const CaseSettings& settings);
Result<Outcome> runDrag(const CaseSettings& settings);
Result<Outcome> runDragCylinder(const CaseSettings& settings);

// Runs the case. If the method refuses it but dfsph accepts it, the outcome holds one finding with the refusal, which is not judged. With
// `cpu` the run is compared with the cpu, see compareWithCpu; null: the case is measured. Error: as PhysicsCase::run.
Result<Outcome> runCase(const PhysicsCase& row, const CaseSettings& settings, Device* cpu = nullptr);

// Compares the first half second of the quick size with the cpu: centre of mass, kinetic energy (relative to its maximum, because water at
// rest has almost none) and mean compression, each within 1 %.
Result<Outcome> compareWithCpu(const PhysicsCase& row, const CaseSettings& settings, Device& cpu);

// Writes an SVG file by gnuplot. Error (failed): gnuplot is not installed, or the file cannot be written.
Status drawPlot(const Plot& plot, const std::string& path);

}  // namespace rivulet
