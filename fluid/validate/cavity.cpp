// Steady flow in a closed square box under a wall that moves along it, Re = 100 and 400: the velocity on the vertical line through the
// centre (Ghia, Ghia and Shin 1982). At Re = 100 the lid is a mesh that moves. At Re = 400 the lid is the box's upper wall, at rest, and
// the other three walls are a mesh that moves: the same flow, seen from the lid, without a lid as long as its way.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "fluid/session/reference_data.h"
#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// A collider's mesh oscillates along x so slowly that its speed is nearly constant: it falls by 2e-4 in 2.5 s, 8e-4 in 5 s.
struct Sliding {
    double amplitude, rate;  // m, rad/s
    explicit Sliding(const ColliderParams& c)
        : amplitude(double{c.motion.shake.x}), rate(2 * std::numbers::pi * double{c.motion.shakeFrequency}) {}
    double speed() const { return amplitude * rate; }
    double way(double time) const { return amplitude * std::sin(rate * time); }
};

// What a cavity is measured in: `x0` and `speed` (m, m/s) are where its left wall is and how fast it moves, `lid` the velocity of the lid
// relative to it.
struct Frame {
    std::function<double(double)> x0;
    double speed = 0, lid = 0;
};

Result<Outcome> measure(Trial& trial, const Frame& frame, const char* published, const char* title, double tolerance) {
    const FluidParams p = trial.params();
    const BlockParams& water = p.blocks[0];
    const double width = double{water.max.x - water.min.x}, height = double{water.max.y - water.min.y};
    const double reach = 1.5 * double{p.spacing}, late = 0.9 * double{trial.scene().duration};
    // Weighted means around points of the line, over the last tenth of the run.
    constexpr int kPoints = 64;
    struct Mean {
        double velocity = 0, weight = 0;
        double value() const { return velocity / std::max(weight, 1e-30); }
    };
    std::vector<Mean> line(kPoints + 1);
    double moving = 0, frames = 0;
    const bool done = trial.run(1.0 / 60, [&] {
        if (trial.time() < late) return;
        const HostParticles all = trial.particles();
        const double middle = frame.x0(trial.time()) + 0.5 * width;
        for (size_t i = 0; i < all.position.size(); ++i) {
            const double x = double{all.position[i].x} - middle, y = double{all.position[i].y - water.min.y};
            const glm::dvec3 v = glm::dvec3(all.velocity[i]) - glm::dvec3(frame.speed, 0, 0);
            moving += glm::dot(v, v) / static_cast<double>(all.position.size());
            if (std::abs(x) >= reach) continue;
            const int first = static_cast<int>(std::ceil((y - reach) / height * kPoints)),
                      last = static_cast<int>(std::floor((y + reach) / height * kPoints));
            for (int k = std::max(first, 0); k <= std::min(last, kPoints); ++k) {
                const double r = std::hypot(x, y - height * k / kPoints) / reach;
                if (r >= 1) continue;
                line[static_cast<size_t>(k)].velocity += (1 - r) * v.x;
                line[static_cast<size_t>(k)].weight += 1 - r;
            }
        }
        frames += 1;
    });
    if (!done) return trial.outcome({}, {});
    Curve measured{"measured", false, {}}, reference{"Ghia, Ghia and Shin 1982", true, {}};
    std::vector<glm::dvec2> profile;
    double least = 0;
    for (int k = 0; k <= kPoints; ++k) {
        const double u = line[static_cast<size_t>(k)].value() / frame.lid, y = static_cast<double>(k) / kPoints;
        profile.emplace_back(y, u);
        measured.points.emplace_back(u, y);
        least = std::min(least, u);
    }
    double squares = 0, count = 0, lowest = 0;
    for (const glm::dvec2& at : referenceCurve(published)) {
        reference.points.emplace_back(at.y, at.x);
        lowest = std::min(lowest, at.y);
        // Particles are not nearer to a wall than half a spacing, and the means there are one-sided.
        if (at.x * height < double{p.spacing} || (1 - at.x) * height < double{p.spacing}) continue;
        squares += std::pow(valueAt(profile, at.x) - at.y, 2);
        count += 1;
    }
    const double rms = std::sqrt(squares / std::max(count, 1.0)), swirl = std::sqrt(moving / std::max(frames, 1.0)) / std::abs(frame.lid);
    return trial.outcome({{"lowest u over the speed of the lid", "", least, lowest, std::abs(least / lowest - 1), tolerance},
                          {"profile of u, rms error over the speed of the lid", "", rms, 0, rms, tolerance},
                          {"rms speed over the speed of the lid", "", swirl, 0, swirl, {}}},
                         {title, "u / U", "y / L", {measured, reference}});
}

}  // namespace

// Ten lengths of the box over the speed of the lid after the start the slowest mode has decayed to 0.5 %.
Result<Outcome> runCavity(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("cavity", settings);
    if (!trial) return trial.error();
    const Sliding lid(trial->scene().colliders[0]);
    const double left = trial->params().blocks[0].min.x;
    return measure(*trial, {[left](double) { return left; }, 0, lid.speed()}, "ghia_1982_cavity", "Cavity, Re = 100",
                   toleranceOf(settings));
}

// After twenty lengths the lowest u is 0.5 % from its final value (by finite differences on 64 x 64 cells).
Result<Outcome> runCavity400(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("cavity_400", settings);
    if (!trial) return trial.error();
    const Sliding walls(trial->scene().colliders[0]);
    const double left = trial->params().blocks[0].min.x;
    return measure(*trial, {[=](double time) { return left + walls.way(time); }, walls.speed(), -walls.speed()}, "ghia_1982_cavity_400",
                   "Cavity, Re = 400", toleranceOf(settings));
}

}  // namespace rivulet
