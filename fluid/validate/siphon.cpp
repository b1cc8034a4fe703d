// Water flows over a weir that is higher than both levels, through a hood that is full of it, until the levels are equal. The water in the
// hood is under tension: its pressure is below that of the air over the tanks by rho g times its height over them. Without tension it falls
// out.
#include <cmath>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runSiphon(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("siphon", settings);
    if (!trial) return trial.error();
    const FluidParams p = trial->params();
    // The tanks outside the hood, and the part of the hood over the weir, see meshes/siphon.obj.
    const BlockParams &left = p.blocks.front(), &right = p.blocks.back(), &over = p.blocks[3];
    const double particle = std::pow(double{p.spacing}, 3);
    const auto filled = [&](const HostParticles& all, const vec3& low, const vec3& high) {  // m^3
        double count = 0;
        for (const vec4& x : all.position) count += x.x > low.x && x.x < high.x && x.y > low.y && x.y < high.y ? 1 : 0;
        return count * particle;
    };
    const double depth = double{p.box.max.z - p.box.min.z};
    const auto level = [&](const HostParticles& all, const BlockParams& tank) {
        return filled(all, tank.min, vec3(tank.max.x, p.box.max.y, 0)) / (double{tank.max.x - tank.min.x} * depth);
    };
    const HostParticles before = trial->particles();
    const double difference = level(before, left) - level(before, right), full = filled(before, over.min, over.max);
    Curve first{"left tank", true, {}}, second{"right tank", true, {}};
    double sum = 0, held = 0, frames = 0;
    const double late = double{trial->scene().duration} - 1;
    const bool done = trial->run(1.0 / 60, [&] {
        const HostParticles all = trial->particles();
        const double a = level(all, left), b = level(all, right);
        first.points.emplace_back(trial->time(), a);
        second.points.emplace_back(trial->time(), b);
        if (trial->time() < late) return;
        sum += a - b;
        held += filled(all, over.min, over.max) / full;
        frames += 1;
    });
    if (!done) return trial->outcome({}, {});
    const double apart = sum / frames, share = held / frames;
    return trial->outcome({{"difference of the levels, mean of the last second, over that at the start", "", apart / difference, 0,
                            std::abs(apart / difference), toleranceOf(settings)},
                           {"water over the weir, share of that at the start", "", share, 1, std::abs(share - 1), toleranceOf(settings)}},
                          {"Siphon", "time, s", "level, m", {first, second}});
}

}  // namespace rivulet
