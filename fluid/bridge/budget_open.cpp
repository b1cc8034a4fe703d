// A scene's budget in this machine's milliseconds: half a second of its own water with each method.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/bridge/budget.h"
#include "fluid/bridge/session.h"
#include "fluid/validate/reference_data.h"

namespace rivulet {

namespace {

constexpr double kCalibration = 300;  // ms, of all methods together
constexpr double kCloser = 200;       // ms, of what they lead to
constexpr double kAtMost = 20000;     // particles of the calibration: a sweep costs each the same
constexpr double kSomeWater = 200;    // particles, below which a frame says nothing of what one costs
constexpr double kUsual = 60;         // ns: where nothing could be measured

constexpr const char* kNoChart = "the program was built without a chart to pick from: `rivulet chart`, then build again";

std::vector<ChartRow> builtInChart() {
    for (const ReferenceTable& table : referenceTables())
        if (table.name == "speed_accuracy") return readChart(table.text);
    return {};
}

struct Calibration {
    std::vector<SweepCost> costs;
    SceneSize size;
    bool measured = true;
};

// Steps the scene with a method for so many ms. ns a particle and sweep; nullopt: there was too little water.
std::optional<double> sweepCost(Session& session, double budgetMs) {
    double ms = 0, work = 0;  // work: particles times sweeps
    const FluidWorld& world = session.world();
    session.step(1.0 / kFramesPerSecond, true);  // the first one makes what the others find made
    for (double spent = 0; spent < budgetMs;) {
        const uint64_t before = world.stats().sweeps;
        const double took = session.step(1.0 / kFramesPerSecond, true);
        spent += std::max(took, 0.1);
        const double particles = world.stats().particles;
        if (particles < kSomeWater) continue;
        ms += took;
        work += particles * static_cast<double>(world.stats().sweeps - before);
    }
    return work > 0 ? std::optional(1e6 * ms / work) : std::nullopt;
}

Result<Calibration> calibrate(const SceneFile& scene, Device& device, std::span<const ChartRow> chart) {
    Calibration c;
    c.size.finest = scene.budget.finest > 0 ? double{scene.budget.finest} : double{scene.fluid.spacing};
    SceneFile trial = scene;
    trial.budget = {};
    const dvec3 box(scene.fluid.box.max - scene.fluid.box.min);
    trial.fluid.spacing = static_cast<float>(std::max(c.size.finest, std::cbrt(box.x * box.y * box.z / kAtMost)));
    std::vector<std::string> methods;
    for (const ChartSetting& s : chartSettings().rows)
        if (std::any_of(chart.begin(), chart.end(), [&](const ChartRow& row) { return row.setting == s.name; }) &&
            std::find(methods.begin(), methods.end(), s.method) == methods.end())
            methods.emplace_back(s.method);
    Error refused = failed(kNoChart);
    for (const std::string& method : methods) {
        trial.fluid.method = method;
        Result<std::unique_ptr<Session>> session = Session::create(trial, device, Log{});
        if (!session && trial.fluid.spacing > scene.fluid.spacing) {  // too coarse for this scene
            trial.fluid.spacing = static_cast<float>(c.size.finest);
            session = Session::create(trial, device, Log{});
        }
        if (!session) {  // others may take the scene
            refused = session.error();
            continue;
        }
        const FluidWorld& world = (*session)->world();
        c.size.spacing = double{trial.fluid.spacing};
        c.size.particlesAt = world.particles().count;
        c.size.fastest = world.fastestFall();
        const std::optional<double> ns = sweepCost(**session, kCalibration / static_cast<double>(methods.size()));
        c.costs.push_back({method, ns.value_or(kUsual)});
        c.measured = c.measured && ns.has_value();
    }
    if (c.costs.empty()) return refused;
    return c;
}

}  // namespace

Result<std::optional<Budget>> openBudget(SceneFile& scene, Device& device, const Log& log) {
    if (scene.budget.frameMs <= 0) return std::optional<Budget>();
    std::vector<ChartRow> chart = builtInChart();
    Result<Calibration> c = calibrate(scene, device, chart);
    if (!c) return c.error();
    std::optional<BudgetPick> pick = pickSetting(chart, c->costs, c->size, scene.budget);
    if (!pick) return failed(kNoChart);
    // Closer: as it was picked, with as many particles as there are then.
    SceneFile closer = scene;
    Budget(scene, chart, c->costs, c->size, *pick).apply(closer);
    closer.budget = {};
    closer.fluid.spacing = static_cast<float>(pick->spacing);
    Result<std::unique_ptr<Session>> session = Session::create(closer, device, Log{});
    if (!session) return session.error();
    c->size.particlesAt = (*session)->world().particles().count;
    c->size.spacing = pick->spacing;
    const auto own = std::find_if(c->costs.begin(), c->costs.end(), [&](const SweepCost& s) { return s.method == closer.fluid.method; });
    own->ns = sweepCost(**session, kCloser).value_or(own->ns);
    pick = pickSetting(chart, c->costs, c->size, scene.budget);
    Budget budget(scene, std::move(chart), c->costs, c->size, *pick);
    budget.apply(scene);
    scene.fluid.spacing = static_cast<float>(pick->spacing);
    scene.budget.finest = static_cast<float>(c->size.finest);  // so that another pick may be finer again
    std::string said =
        fmt::format("budget of {:.3g} ms and {:.2g} %: {}, particles {:.3g} m apart, about {:.0f} of them; {:.3g} ms and {:.2g} % expected",
                    scene.budget.frameMs, 100 * scene.budget.maxDensityError, pick->setting->name, pick->spacing, pick->particles,
                    pick->frameMs, 100 * pick->densityError);
    if (!c->measured) said += "; the scene starts with too little water to measure what it costs here";
    if (!pick->holdsError) said += fmt::format("; nothing on the chart keeps density within {:.2g} %", 100 * scene.budget.maxDensityError);
    if (!pick->holdsFrame) said += "; so few particles that water would not be seen still take longer: allow a frame more";
    log.notice(said);
    return std::optional(std::move(budget));
}

}  // namespace rivulet
