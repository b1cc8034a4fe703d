// A stability scene under way: what is seen of it, and the search for where it fails. For fluid/validate/envelope_*.cpp alone.
#pragma once

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/validate/envelope.h"

namespace rivulet {

// So far in a run. Energies in J: kinetic, and of weight against the height 0.
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
    bool failed = false;               // by the run's own criterion; it ended there
    std::vector<std::string> notices;  // of the program
    bool whole() const { return finite && lost == 0; }
};

struct StabilityRun {
    const char* scene;                          // stability/SCENE.json
    std::vector<std::string> assignments = {};  // as --set
    bool limits = false;
    double frame = 1.0 / 60;                       // s. With the limits on it is asked for as fluid.fixedStep, as far as that goes
    double seconds = 0;                            // 0 = the scene's duration
    bool asFrames = false;                         // no fixedStep, even with the limits on
    std::function<bool(const Seen&)> fails = {};   // besides what is lost or not finite
    std::function<Status(Session&)> prepare = {};  // before the first step
    std::function<void(Session&)> each = {};       // after every frame
    std::function<bool(Session&)> verdict = {};    // after the last one: whether it failed
    std::function<double(int)> frameOf = {};       // s, of each frame, in place of `frame`
};
Result<Seen> watch(const EnvelopeSettings& settings, const StabilityRun& run);

// The params that the scene has with these assignments.
Result<SceneFile> stabilityScene(const char* name, const std::vector<std::string>& assignments);

// Where something fails that holds below, found by doubling from `first` and halving what is between until it is known to a tenth.
// Nothing: it holds up to `most`. `least`: below it nobody looks.
struct Threshold {
    std::optional<double> at;
    double reached = 0;
};
Result<Threshold> findThreshold(double first, double least, double most, const std::function<Result<bool>(double)>& fails);

// What is swept until it fails. With the limits on it is asked for `ask`, or where that is 0 for twice what failed or the most that was
// looked at, up to `askable`.
struct Sweep {
    const char* row;
    std::string method, what, unit;
    double predicted = 0, least = 0, most = 0;  // 0: a 64th, 64 times what is predicted
    double ask = 0, askable = 1e30;
    std::string criterion;
    std::function<StabilityRun(double at, bool limits)> run;
};
Result<EnvelopeFinding> sweep(const EnvelopeSettings& settings, const Sweep& asked);

// Of the step's length: `run` in frames of it.
Sweep stepSweep(const char* row, std::string method, std::string what, double predicted, std::string criterion, StabilityRun run);

// One after the other; the first error ends it.
Result<std::vector<EnvelopeFinding>> sweepAll(const EnvelopeSettings& settings, const std::vector<Sweep>& sweeps);

// Energy beyond what there was, by a tenth; `more` J may come from elsewhere.
std::function<bool(const Seen&)> gainsEnergy(double more = 0);
inline constexpr const char* kGainsEnergy = "kinetic energy and weight a tenth above the start's, or not finite, or lost";
// The same, or a mean compression of a tenth: who passes through others gains nothing by it where pressure is implicit.
std::function<bool(const Seen&)> gainsEnergyOrIsSqueezed();
inline constexpr const char* kGainsEnergyOrIsSqueezed =
    "kinetic energy and weight a tenth above the start's, or a tenth too dense on average, or not finite, or lost";

}  // namespace rivulet
