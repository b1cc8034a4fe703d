// Drops without gravity: the pressure inside is 2 sigma / R (Laplace), and an elongated drop oscillates with
// w^2 = n (n - 1) (n + 2) sigma / (rho R^3), n = 2 (Lamb 1932).
//
// The force of the surface (fluid/forces/cohesion) acts only at the surface: inside a drop at rest there is only the pressure of the
// method, and a gauge there measures the pressure of the surface. A ball cut from a lattice stays a crystal that carries loads (its
// pressures are a fifth higher), unless start positions are jittered (tension_tuned). The stress of a packing at rest still differs by a
// tenth between starts, so each pressure is the mean of three.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/trial.h"
#include "fluid/validate/virial.h"

namespace rivulet {

namespace {

struct Drop {
    double radius = 0;  // m, of a ball of the same volume
    double spacing = 0;
};

// Reduces the block of the scene, a cube around the origin, to the ball in it. With `start` the block is larger by that many spacings on
// all sides, so that other particles with other jitter form the ball.
Result<Trial> openDrop(const CaseSettings& settings, const Drop& wanted, int start, std::vector<std::string> assignments, Drop& drop) {
    assignments.push_back(fmt::format("fluid.spacing={:.9g}", wanted.spacing));
    const double half = wanted.radius + start * wanted.spacing;
    assignments.push_back(fmt::format("fluid.blocks.0.min=-{0:.9g},-{0:.9g},-{0:.9g}", half));
    assignments.push_back(fmt::format("fluid.blocks.0.max={0:.9g},{0:.9g},{0:.9g}", half));
    CaseSettings with = settings;
    with.assignments.insert(with.assignments.begin(), assignments.begin(), assignments.end());
    Result<Trial> trial = Trial::open("tension", with);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    if (Status kept = trial->keep([&](const dvec3& x) { return glm::length(x) < wanted.radius; }); !kept) return kept.error();
    drop.spacing = p.spacing;
    const double volume = trial->world().stats().particles * std::pow(drop.spacing, 3);
    drop.radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
    return trial;
}

// Mean virial pressure within half the radius, Pa, over the second half of the run.
std::optional<double> pressureInside(Trial& trial, const Drop& drop, Curve& curve) {
    double sum = 0, count = 0;
    const double late = 0.5 * double{trial.scene().duration};
    const bool done = trial.run(1.0 / 60, [&] {
        const ParticleView view = trial.world().particles();
        const std::vector<vec4> x = trial.world().device().readAll<vec4>(*view.position, view.count);
        const std::vector<double> virial = virialPressures(x, trial.world().pressures(), trial.params());
        double now = 0, inside = 0;
        for (size_t i = 0; i < x.size(); ++i) {
            if (x[i].w < 0 || double{glm::length(vec3(x[i]))} > 0.5 * drop.radius) continue;
            now += virial[i];
            inside += 1;
        }
        curve.points.emplace_back(trial.time(), now / std::max(inside, 1.0));
        if (trial.time() < late) return;
        sum += now;
        count += inside;
    });
    return done ? std::optional(sum / std::max(count, 1.0)) : std::nullopt;
}

}  // namespace

Result<Outcome> runTension(const CaseSettings& settings) {
    struct Run {
        double radius;  // m
        int across;     // its radius in spacings
    };
    // Three radii, the middle one at two resolutions. The quick size omits the large ones.
    const std::vector<Run> runs = settings.quick ? std::vector<Run>{{0.02, 8}, {0.02, 10}, {0.025, 10}}
                                                 : std::vector<Run>{{0.015, 9}, {0.02, 8}, {0.02, 12}, {0.03, 12}};
    std::vector<Finding> findings;
    Plot plot{"Pressure in drops", "time, s", "pressure, Pa", {}};
    const int kStarts = 3;
    for (const Run& run : runs) {
        Drop drop;
        double inside = 0, expected = 0;
        for (int start = 0; start < kStarts; ++start) {
            // Duration and viscosity scale with the period of oscillation (one Ohnesorge number).
            const double larger = run.radius / 0.02;
            const std::vector<std::string> alike = {fmt::format("duration={:.6g}", 0.8 * std::pow(larger, 1.5)),
                                                    fmt::format("fluid.viscosity={:.6g}", 2e-4 * std::sqrt(larger))};
            Result<Trial> trial = openDrop(settings, {run.radius, run.radius / run.across}, start, alike, drop);
            if (!trial) return trial.error();
            Curve curve{fmt::format("R = {:.3g} mm, {:.3g} spacings", 1000 * drop.radius, drop.radius / drop.spacing), true, {}};
            const std::optional<double> pressure = pressureInside(*trial, drop, curve);
            if (!pressure) return trial->outcome({}, {});
            inside += *pressure / kStarts;
            expected += 2 * double{trial->params().forces.tension} / drop.radius / kStarts;
            if (start > 0) continue;
            plot.curves.push_back(curve);
            plot.curves.push_back({"2 sigma / R", true, {{0, expected * kStarts}, {trial->time(), expected * kStarts}}});
        }
        // The force is calibrated at 20 mm with 10 spacings (fluid/sim/forces/force_tension.cpp); the others are predictions.
        findings.push_back(
            {fmt::format("pressure in a drop, R = {:.3g} mm = {:.3g} spacings", 1000 * drop.radius, drop.radius / drop.spacing), "Pa",
             inside, expected, std::abs(inside / expected - 1), 0.1});
    }
    // Elongated and released.
    Drop drop;
    Result<Trial> trial = openDrop(settings, {0.02, 0.0025}, 0, {"fluid.viscosity=3e-5", "duration=1.1"}, drop);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double w = std::sqrt(8 * double{p.forces.tension} / (double{p.restDensity} * std::pow(drop.radius, 3)));
    const auto mode = [](const dvec3& x) { return dvec3(-0.5 * x.x, -0.5 * x.y, x.z); };
    // Elongated by a tenth of the radius at the first maximum.
    if (Status set = trial->setVelocities([&](const dvec3& x) { return 0.1 * w * mode(x); }); !set) return set.error();
    std::vector<glm::dvec2> swing;
    const bool done = trial->run(1.0 / 120, [&] { swing.emplace_back(trial->time(), amplitudeOf(trial->particles(), mode) / (0.1 * w)); });
    if (!done) return trial->outcome({}, {});
    const std::vector<double> zeros = zerosOf(swing);
    const double measured =
        zeros.size() > 1 ? std::numbers::pi * static_cast<double>(zeros.size() - 1) / (zeros.back() - zeros.front()) : 0;
    findings.push_back({fmt::format("w of the second mode, R = {:.3g} spacings", drop.radius / drop.spacing), "1/s", measured, w,
                        std::abs(measured / w - 1), 0.1});
    return trial->outcome(findings, plot);
}

}  // namespace rivulet
