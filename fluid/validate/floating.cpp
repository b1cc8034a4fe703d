// Floating boxes displace their weight (Archimedes), a heavy one sinks to the floor, and water and boxes exchange equal impulses.
#include <fmt/format.h>

#include <cmath>

#include "fluid/validate/draught.h"
#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runFloating(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("floating", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const BoxParams& box = p.box;
    const std::vector<BodyParams>& bodies = trial->scene().bodies;
    const double area = double{box.max.x - box.min.x} * double{box.max.z - box.min.z};
    const auto massOf = [](const BodyParams& b) { return double{b.density} * double{b.size.x} * double{b.size.y} * double{b.size.z}; };
    // Along x and z only water and bodies interact: there are no walls, and the floor has no friction.
    const auto level = [](const dvec3& v) { return dvec3(v.x, 0.0, v.z); };
    const auto momentumOfBody = [&](size_t k) {
        return level(massOf(bodies[k]) * dvec3(trial->world().bodies()[k].velocity) + trial->world().bodyLoads()[k].pendingImpulse);
    };
    const auto momentum = [&](const HostParticles& all) {
        dvec3 sum(0.0);
        for (size_t i = 0; i < all.velocity.size(); ++i) sum += level(double{all.mass[i]} * dvec3(all.velocity[i]));
        for (size_t k = 0; k < bodies.size(); ++k) sum += momentumOfBody(k);
        return sum;
    };
    const dvec3 before = momentum(trial->particles());
    std::vector<dvec3> first;
    for (size_t k = 0; k < bodies.size(); ++k) first.push_back(momentumOfBody(k));

    std::vector<Curve> measured, reference;
    for (const BodyParams& b : bodies) {
        const double ratio = double{b.density} / double{p.restDensity};
        if (ratio >= 1) continue;
        measured.push_back({fmt::format("box {:.3g} times as dense as water", ratio), true, {}});
        reference.push_back({fmt::format("Archimedes, {:.3g}", ratio), true, {{0, ratio}, {double{trial->scene().duration}, ratio}}});
    }
    // In the second half of the run the boxes are at rest except for small oscillations.
    const double settled = 0.5 * double{trial->scene().duration};
    std::vector<double> under(measured.size());
    double frames = 0, drift = 0, given = 0, sunk = 0;
    const bool done = trial->run(1.0 / 60, [&] {
        const HostParticles all = trial->particles();
        drift = std::max(drift, glm::length(momentum(all) - before));
        double handed = 0;
        for (size_t k = 0; k < bodies.size(); ++k) handed += glm::length(momentumOfBody(k) - first[k]);
        given = std::max(given, handed);
        std::vector<Floater> floaters;
        for (size_t k = 0; k < bodies.size(); ++k) {
            const double height = bodies[k].size.y, middle = double{trial->world().bodies()[k].pose.position.y - box.min.y};
            floaters.push_back({height, height * double{bodies[k].size.x} * double{bodies[k].size.z}, middle - 0.5 * height});
        }
        const double top = waterLevel(waterVolume(all.position, double{p.spacing}), area, floaters);
        const bool late = trial->time() > settled;
        if (late) frames += 1;
        size_t floating = 0;
        for (size_t k = 0; k < bodies.size(); ++k) {
            if (bodies[k].density >= p.restDensity) {
                sunk = std::max(floaters[k].keel, 0.0);
                continue;
            }
            const double share = floaters[k].shareUnder(top - floaters[k].keel);
            measured[floating].points.emplace_back(trial->time(), share);
            if (late) under[floating] += share;
            ++floating;
        }
    });
    if (!done) return trial->outcome({}, {});
    std::vector<Finding> findings;
    for (size_t k = 0; k < under.size(); ++k) {
        const double share = under[k] / frames, ratio = reference[k].points[0].y;
        findings.push_back(
            {fmt::format("share under water of the box {:.3g} as dense", ratio), "", share, ratio, std::abs(share / ratio - 1), 0.03});
    }
    findings.push_back(
        {"keel of the sunk box over the floor, in spacings", "", sunk / double{p.spacing}, 0, sunk / double{p.spacing}, 0.5});
    findings.push_back({"impulse lost between water and boxes, over what they gave", "", drift / given, 0, drift / given, 1.0e-4});
    Plot plot{"Floating boxes", "time, s", "share under water", {}};
    for (size_t k = 0; k < measured.size(); ++k) plot.curves.insert(plot.curves.end(), {measured[k], reference[k]});
    return trial->outcome(findings, plot);
}

}  // namespace rivulet
