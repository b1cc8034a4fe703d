// A sphere under water. Released, it starts with (rho_w - rho_s) g / (rho_s + C rho_w), because it accelerates a share C of its volume of
// water with it (Lamb 1932); held, it carries rho_w g V (Archimedes); as dense as water, it stays where it is.
//
// C is 0.5 without walls. In this tank, six radii wide with a free surface, it is 0.54: from the potential flow, solved by finite
// differences in the tank and in one of 16 radii with the same cells.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// Adds the acceleration of a sphere that is let go and its curves; false: the run was stopped.
bool release(Trial& light, double tolerance, std::vector<Finding>& findings, Plot& plot) {
    constexpr double kAddedMass = 0.54;
    const FluidParams p = light.params();
    const BodyParams body = light.scene().bodies[0];
    const double g = glm::length(p.gravity), water = p.restDensity, density = body.density, radius = body.radius;
    const double expected = (water - density) * g / (density + kAddedMass * water), spacings = radius / double{p.spacing};
    Curve rise{fmt::format("R = {:.3g} spacings", spacings), true, {}}, expectedRise{"added mass", true, {}};
    // A line through the speed, from a fifth of sqrt(R / a) to one: then the sphere has risen by half its radius, and drag begins.
    const double scale = std::sqrt(radius / expected);
    double n = 0, st = 0, sv = 0, stt = 0, stv = 0;
    const bool done = light.run(
        1.0 / 240,
        [&] {
            const double t = light.time(), v = double{light.world().bodies()[0].velocity.y};
            rise.points.emplace_back(t, v);
            expectedRise.points.emplace_back(t, expected * t);
            if (t < 0.2 * scale) return;
            n += 1;
            st += t;
            sv += v;
            stt += t * t;
            stv += t * v;
        },
        scale);
    if (!done) return false;
    const double acceleration = (n * stv - st * sv) / (n * stt - st * st);
    findings.push_back({fmt::format("acceleration of a released sphere, R = {:.3g} spacings", spacings), "m/s^2", acceleration, expected,
                        std::abs(acceleration / expected - 1), tolerance});
    plot.curves.push_back(rise);
    if (plot.curves.size() == 1) plot.curves.push_back(expectedRise);
    return true;
}

// Adds the force on a sphere that is held for `seconds`.
bool hold(Trial& held, double seconds, double tolerance, std::vector<Finding>& findings) {
    const FluidParams p = held.params();
    const double radius = held.scene().bodies[0].radius;
    double force = 0, frames = 0;
    const bool done = held.run(
        1.0 / 120,
        [&] {
            if (held.time() < 0.4 * seconds) return;
            force += held.world().bodyLoads()[0].force.y;
            frames += 1;
        },
        seconds);
    if (!done) return false;
    force /= std::max(frames, 1.0);
    const double weight = double{p.restDensity} * double{glm::length(p.gravity)} * 4 / 3 * std::numbers::pi * std::pow(radius, 3);
    findings.push_back({fmt::format("force on a held sphere, R = {:.3g} spacings", radius / double{p.spacing}), "N", force, weight,
                        std::abs(force / weight - 1), tolerance});
    return true;
}

}  // namespace

Result<Outcome> runSubmerged(const CaseSettings& settings) {
    const auto open = [&](std::vector<std::string> assignments) {
        CaseSettings with = settings;
        with.assignments.insert(with.assignments.begin(), assignments.begin(), assignments.end());
        return Trial::open("submerged", with);
    };
    std::vector<Finding> findings;
    Plot plot{"Released sphere", "time, s", "speed, m/s", {}};
    const double tolerance = toleranceOf(settings), seconds = settings.quick ? 0.5 : 1.0;
    float water = 0;                        // kg/m^3
    std::vector<std::string> sizes = {""};  // R = 0.05 m: 5 spacings in the scene
    if (!settings.quick) sizes.insert(sizes.end(), {"fluid.spacing=0.0166666667", "fluid.spacing=0.005"});
    for (const std::string& size : sizes) {
        std::vector<std::string> with;
        if (!size.empty()) with.push_back(size);
        Result<Trial> light = open(with);
        if (!light) return light.error();
        water = light->params().restDensity;
        if (!release(*light, tolerance, findings, plot)) return light->outcome({}, {});
        with.emplace_back("bodies.0.fixed=true");
        Result<Trial> held = open(with);
        if (!held) return held.error();
        if (!hold(*held, seconds, tolerance, findings)) return held->outcome({}, {});
    }

    Result<Trial> neutral = open({fmt::format("bodies.0.density={:.9g}", water)});
    if (!neutral) return neutral.error();
    const double radius = neutral->scene().bodies[0].radius;
    const vec3 from = neutral->world().bodies()[0].pose.position;
    double drift = 0;
    const bool done = neutral->run(
        1.0 / 60, [&] { drift = std::max(drift, double{glm::length(vec3(neutral->world().bodies()[0].pose.position) - from)}); }, seconds);
    if (!done) return neutral->outcome({}, {});
    findings.push_back(
        {fmt::format("path of a sphere as dense as water in {:.1f} s, over R", seconds), "m", drift, 0, drift / radius, tolerance});
    return neutral->outcome(findings, plot);
}

}  // namespace rivulet
