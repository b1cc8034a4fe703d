// A pool at rest: its pressure is the weight above, and it is still.
#include <cmath>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runHydrostatic(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("hydrostatic", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double g = glm::length(p.gravity), depth = double{p.blocks[0].max.y - p.blocks[0].min.y}, bottom = double{p.box.min.y};
    const double most = double{p.restDensity} * g * depth;
    if (!trial->run(1.0 / 60, [] {})) return trial->outcome({}, {});
    // Particle by particle, at the end.
    const ParticleView view = trial->world().particles();
    const std::vector<vec4> x = trial->world().device().readAll<vec4>(*view.position, view.count);
    const std::vector<float> pressure = trial->world().pressures();
    Curve measured{"measured", false, {}}, reference{"the weight above", true, {{0, depth}, {1, 0}}};
    double squares = 0, count = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        const double height = double{x[i].y} - bottom, error = double{pressure[i]} / most - (1 - height / depth);
        squares += error * error;
        count += 1;
        if (i % 7 == 0) measured.points.emplace_back(double{pressure[i]} / most, height);
    }
    const double rms = std::sqrt(squares / count);
    const FluidStats& s = trial->world().stats();
    const double speed = std::sqrt(2 * s.kinetic / (double{p.restDensity} * count * std::pow(double{p.spacing}, 3)));
    return trial->outcome({{"pressure, rms over rho g H", "", rms, 0, rms, 0.01},
                           {"speed left over sqrt(g H)", "", speed / std::sqrt(g * depth), 0, speed / std::sqrt(g * depth), 0.002}},
                          {"Hydrostatic pressure", "p / (rho g H)", "height above the floor, m", {measured, reference}});
}

}  // namespace rivulet
