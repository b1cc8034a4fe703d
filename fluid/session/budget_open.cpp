// A scene's budget in milliseconds of this machine: half a second of its own water, with each method and then with the resulting picks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/session/budget.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

constexpr double kCalibration = 300;  // ms, of all methods together
constexpr double kCloser = 100;       // ms, of the resulting pick, each time
constexpr int kCloserTimes = 2;
constexpr int kSmallerTimes = 10;   // halvings of the particles, if the device has not enough memory
constexpr double kAtMost = 20000;   // particles of a whole box of water: the cost per particle is constant
constexpr double kSomeWater = 200;  // particles: with fewer, the cost of one cannot be measured
constexpr double kUsual = 60;       // ns: if nothing could be measured

struct Cost {
    double ns = 0, frameMs = 0;  // per particle and sweep; per frame, mean
};

// Steps the scene for this many ms. nullopt: there was too little water.
std::optional<Cost> costOf(Session& session, double budgetMs) {
    double ms = 0, work = 0, frames = 0;  // work: particles times sweeps
    const FluidWorld& world = session.world();
    session.step(1.0 / kFramesPerSecond, true);  // the first one creates kernels and buffers
    for (double spent = 0; spent < budgetMs;) {
        const uint64_t before = world.stats().sweeps;
        const double took = session.step(1.0 / kFramesPerSecond, true);
        spent += std::max(took, 0.1);
        const double particles = world.stats().particles;
        if (particles < kSomeWater) continue;
        ms += took;
        work += particles * static_cast<double>(world.stats().sweeps - before);
        frames += 1;
    }
    return work > 0 ? std::optional(Cost{1e6 * ms / work, ms / frames}) : std::nullopt;
}

struct Calibration {
    std::vector<SweepCost> costs;
    SceneSize size;
    bool measured = true;
};

// The scene without its budget, at a spacing.
SceneFile trialOf(const SceneFile& scene, double spacing) {
    SceneFile trial = scene;
    trial.budget = {};
    trial.fluid.spacing = static_cast<float>(spacing);
    trial.fluid.maxParticles = 0;  // the unlimited number is wanted
    return trial;
}

// Runs a trial. If the device has not enough memory for it (`small`), the device stays usable for the next.
struct Tried {
    Result<std::unique_ptr<Session>> session;
    std::optional<Cost> cost;
    bool small = false;
};
Tried tryOut(const SceneFile& trial, Device& device, double budgetMs) {
    const bool roomy = device.health().state != DeviceHealth::full;
    Tried tried{Session::create(trial, device, Log{}), {}, false};
    if (tried.session && (*tried.session)->world().particles().count > 0) tried.cost = costOf(**tried.session, budgetMs);
    tried.small = roomy && device.health().state == DeviceHealth::full;
    if (!tried.small) return tried;
    if (tried.session) tried.session = failed(fmt::format("{} {}", device.info().name, device.health().why));
    tried.cost.reset();
    device.forgiveFull();
    return tried;
}

// Tries each of these methods with default settings at this spacing (m). Methods that refuse the scene are skipped, and so are those that
// the device has not enough memory for: returns whether there were such. `refused`: the last one's error.
bool tryMethods(const SceneFile& scene, Device& device, std::span<const ChartSetting* const> plain, double coarse, Calibration& c,
                std::optional<Error>& refused) {
    bool small = false;
    for (const ChartSetting* setting : plain) {
        Tried tried{failed(""), {}, false};
        double spacing = coarse;
        for (;; spacing = std::max(0.5 * spacing, c.size.finest)) {  // until it is fine enough for the scene and its drops
            SceneFile trial = trialOf(scene, spacing);
            applySetting(*setting, trial);
            tried = tryOut(trial, device, kCalibration / static_cast<double>(plain.size()));
            if (tried.small || spacing <= c.size.finest || (tried.session && (*tried.session)->world().particles().count > 0)) break;
        }
        small = small || tried.small;
        if (!tried.session) {
            refused = tried.session.error();
            continue;
        }
        const FluidWorld& world = (*tried.session)->world();
        if (world.particles().count == 0) continue;
        c.size.spacing = spacing;
        c.size.particlesAt = world.particles().count;
        c.size.fastest = double{world.fastestFall()};
        c.costs.push_back({setting->method, tried.cost ? tried.cost->ns : kUsual});
        c.measured = c.measured && tried.cost.has_value();
    }
    return small;
}

// Tries each method that the chart can pick. Error: the last one's, if all refuse the scene.
Result<Calibration> calibrate(const SceneFile& scene, Device& device, std::span<const ChartRow> chart) {
    Calibration c;
    c.size.finest = scene.budget.finest > 0 ? double{scene.budget.finest} : double{scene.fluid.spacing};
    c.size.most = scene.fluid.maxParticles;
    std::vector<const ChartSetting*> plain;
    for (const ChartSetting& s : chartSettings().rows)
        if (*s.assignments == '\0' && std::any_of(chart.begin(), chart.end(), [&](const ChartRow& row) { return row.setting == s.name; }))
            plain.push_back(&s);
    const dvec3 box(scene.fluid.box.max - scene.fluid.box.min);
    double coarse = std::max(c.size.finest, std::cbrt(box.x * box.y * box.z / kAtMost));
    std::optional<Error> refused;
    bool small = tryMethods(scene, device, plain, coarse, c, refused);
    for (int k = 0; k < kSmallerTimes && small && c.costs.empty(); ++k) {
        coarse *= std::cbrt(2.0);
        small = tryMethods(scene, device, plain, coarse, c, refused);
    }
    if (c.costs.empty() && refused) return *refused;
    return c;
}

// Measures the pick itself, with its number of particles. Costs that the chart's dam break does not have (bodies, a viscous liquid, short
// steps) raise the cost of a sweep.
Status comeCloser(const SceneFile& scene, Device& device, std::span<const ChartRow> chart, Calibration& c,
                  std::optional<BudgetPick>& pick) {
    int smaller = 0;
    for (int k = 0; k < kCloserTimes;) {
        SceneFile trial = trialOf(scene, pick->spacing);
        applySetting(*pick->setting, trial);
        const Tried tried = tryOut(trial, device, kCloser);
        if (tried.small && smaller < kSmallerTimes) {
            c.size.finest = std::cbrt(2.0) * pick->spacing;
            pick = pickSetting(chart, c.costs, c.size, scene.budget);
            ++smaller;
            continue;
        }
        if (!tried.session) return tried.session.error();
        if (const double count = (*tried.session)->world().particles().count; count > 0) {
            c.size.particlesAt = count;
            c.size.spacing = pick->spacing;
        }
        if (const std::optional<Cost>& cost = tried.cost) {
            const auto own =
                std::find_if(c.costs.begin(), c.costs.end(), [&](const SweepCost& s) { return s.method == trial.fluid.method; });
            own->ns = cost->ns;
            const double expected = frameCost(chart, c.costs, c.size, *pick->setting, pick->spacing).value_or(cost->frameMs);
            own->ns *= std::max(cost->frameMs / expected, 1.0);
        }
        pick = pickSetting(chart, c.costs, c.size, scene.budget);
        ++k;
    }
    return ok();
}

}  // namespace

Result<std::optional<Budget>> openBudget(SceneFile& scene, Device& device, const Log& log) {
    if (scene.budget.frameMs <= 0) return std::optional<Budget>();
    std::vector<ChartRow> chart = readChart(builtInChart());
    Result<Calibration> c = calibrate(scene, device, chart);
    if (!c) return c.error();
    std::optional<BudgetPick> pick = pickSetting(chart, c->costs, c->size, scene.budget);
    if (!pick) {
        log.notice("the scene starts without water: its budget has nothing to measure and is ignored");
        return std::optional<Budget>();
    }
    if (Status closer = comeCloser(scene, device, chart, *c, pick); !closer) return closer.error();
    device.finish();
    (void)device.takeTimes();  // of the trials: not part of the run
    applySetting(*pick->setting, scene);
    scene.fluid.spacing = static_cast<float>(pick->spacing);
    scene.budget.finest = static_cast<float>(c->size.finest);  // a later pick may be finer again
    const std::string allowed = percentText(double{scene.budget.maxDensityError});
    std::string sentence = fmt::format(
        "budget of {:.4g} ms and {}: {}, particles {:.3g} m apart, about {:.0f} of them; {:.3g} ms and {} expected", scene.budget.frameMs,
        allowed, pick->setting->name, pick->spacing, pick->particles, pick->frameMs, percentText(pick->densityError));
    if (!c->measured) sentence += "; the scene starts with too little water to measure its cost on this machine";
    if (!pick->holdsError) sentence += fmt::format("; no setting of the chart keeps the density error within {}", allowed);
    if (!pick->holdsFrame) sentence += "; the fewest particles that look like water still take longer: raise budget.frameMs";
    log.notice(sentence);
    return std::optional(Budget(scene.budget, std::move(chart), c->costs, c->size, *pick));
}

}  // namespace rivulet
