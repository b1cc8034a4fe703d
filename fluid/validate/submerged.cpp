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

Result<Outcome> runSubmerged(const CaseSettings& settings) {
    constexpr double kAddedMass = 0.54;
    const auto open = [&](std::vector<std::string> assignments) {
        CaseSettings with = settings;
        with.assignments.insert(with.assignments.begin(), assignments.begin(), assignments.end());
        return Trial::open("submerged", with);
    };
    std::vector<Finding> findings;
    Curve rise{"released", true, {}}, expectedRise{"added mass", true, {}};
    const double tolerance = toleranceOf(settings);

    Result<Trial> light = open({});
    if (!light) return light.error();
    const FluidParams p = light->params();
    const BodyParams body = light->scene().bodies[0];
    const double g = glm::length(p.gravity), water = p.restDensity, density = body.density, radius = body.radius;
    const double expected = (water - density) * g / (density + kAddedMass * water);
    // A line through the speed, from a fifth of sqrt(R / a) to one: then the sphere has risen by half its radius, and drag begins.
    const double scale = std::sqrt(radius / expected);
    double n = 0, st = 0, sv = 0, stt = 0, stv = 0;
    bool done = light->run(
        1.0 / 240,
        [&] {
            const double t = light->time(), v = double{light->world().bodies()[0].velocity.y};
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
    if (!done) return light->outcome({}, {});
    const double acceleration = (n * stv - st * sv) / (n * stt - st * st);
    findings.push_back({fmt::format("acceleration of a released sphere, R = {:.3g} spacings", radius / double{p.spacing}), "m/s^2",
                        acceleration, expected, std::abs(acceleration / expected - 1), tolerance});

    const double seconds = settings.quick ? 0.5 : 1.0;
    Result<Trial> held = open({"bodies.0.fixed=true"});
    if (!held) return held.error();
    double force = 0, frames = 0;
    done = held->run(
        1.0 / 120,
        [&] {
            if (held->time() < 0.4 * seconds) return;
            force += held->world().bodyLoads()[0].force.y;
            frames += 1;
        },
        seconds);
    if (!done) return held->outcome({}, {});
    force /= std::max(frames, 1.0);
    const double weight = water * g * 4 / 3 * std::numbers::pi * std::pow(radius, 3);
    findings.push_back({"force on a held sphere", "N", force, weight, std::abs(force / weight - 1), tolerance});

    Result<Trial> neutral = open({fmt::format("bodies.0.density={:.9g}", water)});
    if (!neutral) return neutral.error();
    const vec3 from = neutral->world().bodies()[0].pose.position;
    double drift = 0;
    done = neutral->run(
        1.0 / 60, [&] { drift = std::max(drift, double{glm::length(vec3(neutral->world().bodies()[0].pose.position) - from)}); }, seconds);
    if (!done) return neutral->outcome({}, {});
    findings.push_back(
        {fmt::format("path of a sphere as dense as water in {:.1f} s, over R", seconds), "m", drift, 0, drift / radius, tolerance});
    return neutral->outcome(findings, {"Released sphere", "time, s", "speed, m/s", {rise, expectedRise}});
}

}  // namespace rivulet
