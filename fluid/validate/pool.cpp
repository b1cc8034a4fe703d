// A pool at rest: the speed that is left after seconds, with numerical parameters at their defaults.
#include <cmath>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runPool(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("pool", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double depth = double{p.blocks[0].max.y - p.blocks[0].min.y}, scale = std::sqrt(glm::length(p.gravity) * depth);
    const double late = 0.875 * double{trial->scene().duration};
    double sum = 0, frames = 0;
    Curve measured{"measured", true, {}};
    const bool done = trial->run(1.0 / 60, [&] {
        const HostParticles all = trial->particles();
        double squares = 0;
        for (const vec4& v : all.velocity) squares += glm::dot(dvec3(v), dvec3(v)) / static_cast<double>(all.velocity.size());
        measured.points.emplace_back(trial->time(), std::sqrt(squares) / scale);
        if (trial->time() < late) return;
        sum += squares;
        frames += 1;
    });
    if (!done) return trial->outcome({}, {});
    const double speed = std::sqrt(sum / std::max(frames, 1.0)) / scale;
    return trial->outcome({{"rms speed over sqrt(g H), last 0.5 s", "", speed, 0, speed, 0.002}},
                          {"Pool at rest", "time, s", "rms speed / sqrt(g H)", {measured}});
}

}  // namespace rivulet
