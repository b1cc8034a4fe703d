// A standing wave in the lowest mode: w^2 = g k tanh(k H), and its energy decays as exp(-4 nu k^2 t) (Lamb 1932).
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runStandingWave(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("standing_wave", settings);
    if (!trial) return trial.error();
    const FluidParams p = trial->params();
    constexpr double pi = std::numbers::pi, amplitude = 0.02;  // m, of the surface
    const double k = 2 * pi / double{p.box.max.x}, depth = double{p.blocks[0].max.y}, g = glm::length(p.gravity);
    const double w = std::sqrt(g * k * std::tanh(k * depth));
    const auto mode = [&](const dvec3& x) {
        return dvec3(-std::cosh(k * x.y) * std::sin(k * x.x), std::sinh(k * x.y) * std::cos(k * x.x), 0.0) / std::sinh(k * depth);
    };
    if (Status set = trial->setVelocities([&](const dvec3& x) { return amplitude * w * mode(x); }); !set) return set.error();
    Curve measured{"measured", true, {}}, reference{"Lamb", true, {}};
    const bool done = trial->run(1.0 / 120, [&] {
        const double t = trial->time();
        measured.points.emplace_back(t, amplitudeOf(trial->particles(), mode) / (amplitude * w));
        reference.points.emplace_back(t, std::cos(w * t) * std::exp(-2 * double{p.viscosity} * k * k * t));
    });
    if (!done) return trial->outcome({}, {});
    // The period from the zeros, the viscosity from the decay of the crests.
    const std::vector<double> zeros = zerosOf(measured.points);
    std::vector<glm::dvec2> crests;
    for (size_t n = 1; n < zeros.size(); ++n) {
        crests.emplace_back(0.0, 0.0);
        for (const glm::dvec2& at : measured.points)
            if (at.x > zeros[n - 1] && at.x < zeros[n] && std::abs(at.y) > crests.back().y) crests.back() = {at.x, std::abs(at.y)};
    }
    const double period = zeros.size() > 1 ? 2 * (zeros.back() - zeros.front()) / static_cast<double>(zeros.size() - 1) : 0;
    const double expected = 2 * pi / w;
    const double viscosity = crests.size() > 1 && crests.back().y > 0
                                 ? std::log(crests.front().y / crests.back().y) / (crests.back().x - crests.front().x) / (2 * k * k)
                                 : 0;
    return trial->outcome(
        {{"period", "s", period, expected, std::abs(period / expected - 1), 0.02},
         {"viscosity of the decay", "m^2/s", viscosity, double{p.viscosity}, std::abs(viscosity - double{p.viscosity}), {}}},
        {"Standing wave", "time, s", "the mode over that at the start", {measured, reference}});
}

}  // namespace rivulet
