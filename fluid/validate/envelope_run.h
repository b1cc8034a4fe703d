// Runs a stability scene, observes it, and searches for the value at which it fails. Used only by fluid/validate/envelope_*.cpp.
#pragma once

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/validate/envelope.h"

namespace rivulet {

// Observations of a run so far. Energies in J: kinetic plus potential, with height 0 as the reference.
struct Seen {
    double start = 0;   // J, before the first step
    double energy = 0;  // J, now
    double mostEnergy = 0;
    double compression = 0, mostCompression = 0;  // mean over particles
    double mostSpeed = 0;                         // m/s
    uint32_t particles = 0, lost = 0;
    bool finite = true;
    uint64_t steps = 0;
    double time = 0;                   // s
    bool failed = false;               // by the criterion of the run, which ended it
    std::vector<std::string> notices;  // of the program
    bool whole() const { return finite && lost == 0; }
};

struct StabilityRun {
    const char* scene;                          // stability/SCENE.json
    std::vector<std::string> assignments = {};  // as --set
    bool limits = false;
    double frame = 1.0 / 60;  // s. With the limits on it is requested as fluid.fixedStep, within the range of that parameter
    double seconds = 0;       // 0 = the scene's duration
    bool asFrames = false;    // no fixedStep, even with the limits on
    std::function<bool(const Seen&)> fails = {};   // in addition to lost particles and values that are not finite
    std::function<Status(Session&)> prepare = {};  // before the first step
    std::function<void(Session&)> each = {};       // after every frame
    std::function<bool(Session&)> verdict = {};    // after the last frame: whether the run failed
    std::function<double(int)> frameOf = {};       // s, the length of frame k; replaces `frame`
};
Result<Seen> watch(const EnvelopeSettings& settings, const StabilityRun& run);

// The scene with these assignments applied.
Result<SceneFile> stabilityScene(const char* name, const std::vector<std::string>& assignments);

// The value above which `fails` is true, to a tenth: doubling from `first`, then bisection. No value (`at` is empty): nothing fails up to
// `most`. Values below `least` are not tried.
struct Threshold {
    std::optional<double> at;
    double reached = 0;
};
Result<Threshold> findThreshold(double first, double least, double most, const std::function<Result<bool>(double)>& fails);

// A parameter to sweep until the scene fails. The run with the limits on uses `ask`; if that is 0, twice the value that failed or the
// greatest value tried, at most `askable`.
struct Sweep {
    const char* row;
    std::string method, what, unit;
    double predicted = 0, least = 0, most = 0;  // 0: predicted / 64, predicted * 64
    double ask = 0, askable = 1e30;
    std::string criterion;
    std::function<StabilityRun(double at, bool limits)> run;
};
Result<EnvelopeFinding> sweep(const EnvelopeSettings& settings, const Sweep& asked);

// A sweep of the step length: `run` with frames of that length.
Sweep stepSweep(const char* row, std::string method, std::string what, double predicted, std::string criterion, StabilityRun run);

// Runs the sweeps in order and ends at the first error.
Result<std::vector<EnvelopeFinding>> sweepAll(const EnvelopeSettings& settings, const std::vector<Sweep>& sweeps);

// True if the energy exceeds that of the start by a tenth; `more` J of other sources are allowed.
std::function<bool(const Seen&)> gainsEnergy(double more = 0);
inline constexpr const char* kGainsEnergy =
    "kinetic and potential energy a tenth above the start, or a value not finite, or a particle lost";
// The same, or a mean compression above a tenth: with implicit pressure, particles that pass through each other gain no energy.
std::function<bool(const Seen&)> gainsEnergyOrIsSqueezed();
inline constexpr const char* kGainsEnergyOrIsSqueezed =
    "kinetic and potential energy a tenth above the start, or a mean density a tenth too high, or a value not finite, or a particle lost";

}  // namespace rivulet
