// Steady flow in a closed square box under a lid that moves, Re = 100: the velocity on the vertical line through the centre (Ghia, Ghia and
// Shin 1982). Ten lengths of the box over the speed of the lid after the start the slowest mode has decayed to 0.5 %.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid/session/reference_data.h"
#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runCavity(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("cavity", settings);
    if (!trial) return trial.error();
    const FluidParams p = trial->params();
    const BlockParams& water = p.blocks[0];
    const ColliderParams lid = trial->scene().colliders[0];
    // The lid oscillates so slowly that its speed is nearly constant: it falls by 2e-4 in 2.5 s.
    const double speed = double{lid.motion.shake.x} * 2 * std::numbers::pi * double{lid.motion.shakeFrequency};
    const double width = double{water.max.x - water.min.x}, height = double{water.max.y - water.min.y};
    const double reach = 1.5 * double{p.spacing}, late = 0.9 * double{trial->scene().duration};
    // Weighted means around points of the line, over the last tenth of the run.
    constexpr int kPoints = 64;
    struct Mean {
        double velocity = 0, weight = 0;
        double value() const { return velocity / std::max(weight, 1e-30); }
    };
    std::vector<Mean> line(kPoints + 1);
    double moving = 0, frames = 0;
    const bool done = trial->run(1.0 / 60, [&] {
        if (trial->time() < late) return;
        const HostParticles all = trial->particles();
        for (size_t i = 0; i < all.position.size(); ++i) {
            const double x = double{all.position[i].x - water.min.x} - 0.5 * width, y = double{all.position[i].y - water.min.y};
            const glm::dvec3 v(all.velocity[i]);
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
    if (!done) return trial->outcome({}, {});
    Curve measured{"measured", false, {}}, reference{"Ghia, Ghia and Shin 1982", true, {}};
    std::vector<glm::dvec2> profile;
    double least = 0;
    for (int k = 0; k <= kPoints; ++k) {
        const double u = line[static_cast<size_t>(k)].value() / speed, y = static_cast<double>(k) / kPoints;
        profile.emplace_back(y, u);
        measured.points.emplace_back(u, y);
        least = std::min(least, u);
    }
    const std::vector<glm::dvec2> published = referenceCurve("ghia_1982_cavity");
    double squares = 0, count = 0, lowest = 0;
    for (const glm::dvec2& at : published) {
        reference.points.emplace_back(at.y, at.x);
        lowest = std::min(lowest, at.y);
        // Particles are not nearer to a wall than half a spacing, and the means there are one-sided.
        if (at.x * height < double{p.spacing} || (1 - at.x) * height < double{p.spacing}) continue;
        squares += std::pow(valueAt(profile, at.x) - at.y, 2);
        count += 1;
    }
    const double rms = std::sqrt(squares / std::max(count, 1.0)), swirl = std::sqrt(moving / std::max(frames, 1.0)) / speed;
    return trial->outcome({{"lowest u over the speed of the lid", "", least, lowest, std::abs(least / lowest - 1), toleranceOf(settings)},
                           {"profile of u, rms error over the speed of the lid", "", rms, 0, rms, toleranceOf(settings)},
                           {"rms speed over the speed of the lid", "", swirl, 0, swirl, {}}},
                          {"Cavity, Re = 100", "u / U", "y / L", {measured, reference}});
}

}  // namespace rivulet
