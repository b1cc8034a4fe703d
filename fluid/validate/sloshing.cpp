// Sloshing in a tank: gravity tilts at t = 0, and the centre of mass oscillates in the first mode about its new place of rest:
// w^2 = g k tanh(k H), k = pi / L, with a decay of exp(-2 nu k^2 t) (Lamb 1932). Walls slip, so that they damp nothing.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/oscillation.h"
#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

struct Tank {
    const char* name;
    std::vector<std::string> assignments;  // of shape alone
};

}  // namespace

Result<Outcome> runSloshing(const CaseSettings& settings) {
    std::vector<Tank> tanks = {{"H/L 0.2", {}}};
    if (!settings.quick) {
        tanks.push_back({"H/L 0.5", {"fluid.box.max=1,1.2,0.16", "fluid.blocks.0.max=1,0.5,0.16"}});
        tanks.push_back({"H/L 0.2, no side walls", {"fluid.box.periodicZ=true"}});
        // A half and three spacings high at the walls; the case itself tilts by 0.05, 1.25 spacings.
        tanks.push_back({"H/L 0.2, tilt 0.02", {"fluid.gravity=0.196187,-9.808038,0"}});
        tanks.push_back({"H/L 0.2, tilt 0.12", {"fluid.gravity=1.174376,-9.739454,0"}});
    }
    const double periods = settings.quick ? 3 : 5;
    std::vector<Finding> findings;
    Plot plot{"Sloshing", "time / period", "centre of mass along x over its amplitude at rest", {}};
    std::optional<Outcome> outcome;
    for (const Tank& tank : tanks) {
        CaseSettings with = settings;
        with.assignments.insert(with.assignments.begin(), tank.assignments.begin(), tank.assignments.end());
        Result<Trial> trial = Trial::open("sloshing", with);
        if (!trial) return trial.error();
        const FluidParams& p = trial->params();
        const double length = double{p.box.max.x - p.box.min.x}, depth = double{p.blocks[0].max.y - p.blocks[0].min.y};
        const double g = glm::length(p.gravity), k = std::numbers::pi / length, w = std::sqrt(g * k * std::tanh(k * depth));
        const double period = 2 * std::numbers::pi / w, tilt = -double{p.gravity.x} / double{p.gravity.y};
        // The place of rest: the surface is inclined by the tilt.
        const double rest = tilt * length * length / (12 * depth);
        Curve measured{tank.name, true, {}};
        std::vector<glm::dvec2> fitted;
        const bool done = trial->run(
            1.0 / 60,
            [&] {
                double sum = 0, count = 0;
                for (const vec4& x : trial->particles().position) {
                    sum += double{x.x};
                    count += 1;
                }
                const double x = sum / std::max(count, 1.0) - 0.5 * double{p.box.max.x + p.box.min.x};
                measured.points.emplace_back(trial->time() / period, x / rest);
                // The first quarter of a period holds the start from the lattice.
                if (trial->time() > 0.25 * period) fitted.emplace_back(trial->time(), x);
            },
            periods * period);
        if (!done) return trial->outcome({}, {});
        if (fitted.size() < 5) return badInput("duration is too short for the case sloshing: set it to more than half a period");
        const Oscillation o = fitOscillation(fitted, w);
        const double found = 2 * std::numbers::pi / o.frequency, viscosity = o.decay / (2 * k * k);
        const double most = 0.002 * double{p.spacing} / 0.01;
        findings.push_back({fmt::format("period, {}", tank.name), "s", found, period, std::abs(found / period - 1), toleranceOf(settings)});
        findings.push_back({fmt::format("viscosity of the decay, error over 0.2 m/s x spacing, {}", tank.name), "m^2/s", viscosity,
                            double{p.viscosity}, std::abs(viscosity - double{p.viscosity}) / most, 1.0});
        findings.push_back({fmt::format("residual of the fit over the amplitude, {}", tank.name), "", o.misfit, 0, o.misfit, {}});
        plot.curves.push_back(measured);
        plot.curves.push_back({fmt::format("Lamb, {}", tank.name), true, {}});
        for (int i = 0; i <= 200; ++i) {
            const double t = periods * i / 200;
            plot.curves.back().points.emplace_back(t, 1 - std::cos(2 * std::numbers::pi * t));
        }
        if (outcome) continue;
        Result<Outcome> cost = trial->outcome({}, {});  // of the tank that all sizes run
        if (!cost) return cost.error();
        outcome = std::move(*cost);
    }
    outcome->findings = findings;
    outcome->plot = plot;
    return *outcome;
}

}  // namespace rivulet
