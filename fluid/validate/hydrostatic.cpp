// A pool at rest: pressure equals the weight above, and nothing moves.
#include <cmath>
#include <map>
#include <tuple>

#include "fluid/validate/trial.h"
#include "fluid/validate/virial.h"

namespace rivulet {

Result<Outcome> runHydrostatic(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("hydrostatic", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const BoxParams& box = p.box;
    const double g = glm::length(p.gravity), depth = double{p.blocks[0].max.y - p.blocks[0].min.y};
    const double most = double{p.restDensity} * g * depth;
    if (!trial->run(1.0 / 60, [] {})) return trial->outcome({}, {});

    const ParticleView view = trial->world().particles();
    const std::vector<vec4> x = trial->world().device().readAll<vec4>(*view.position, view.count);
    const std::vector<float> own = trial->world().pressures();
    const std::vector<double> virial = virialPressures(x, own, p);
    // Gauges: cubes as wide as a support radius, at least a support radius from walls and surface.
    const float h = p.spacing * p.supportSpacings;
    struct Gauge {
        double pressure = 0, height = 0, count = 0;
    };
    std::map<std::tuple<int, int, int>, Gauge> gauges;
    double squares = 0, count = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        const vec3 in = vec3(x[i]) - box.min, out = box.max - vec3(x[i]);
        const double height = in.y, error = double{own[i]} / most - (1 - height / depth);
        squares += error * error;
        count += 1;
        if (std::min({in.x, in.y, in.z, out.x, out.z}) < h || height > depth - double{h}) continue;
        const ivec3 cell(glm::floor(in / h));
        Gauge& gauge = gauges[{cell.x, cell.y, cell.z}];
        gauge.pressure += virial[i] / most;
        gauge.height += height;
        gauge.count += 1;
    }
    Curve measured{"gauges", false, {}}, reference{"the weight above", true, {{0, depth}, {1, 0}}};
    double gaugeSquares = 0, gaugeCount = 0;
    for (const auto& [cell, gauge] : gauges) {
        if (gauge.count < 4) continue;  // cut by the margin
        const double pressure = gauge.pressure / gauge.count, height = gauge.height / gauge.count;
        gaugeSquares += std::pow(pressure - (1 - height / depth), 2);
        gaugeCount += 1;
        measured.points.emplace_back(pressure, height);
    }
    const double gauged = gaugeCount > 0 ? std::sqrt(gaugeSquares / gaugeCount) : 1, rms = std::sqrt(squares / count);
    const FluidStats& s = trial->world().stats();
    const double speed = std::sqrt(2 * s.kinetic / (double{p.restDensity} * count * std::pow(double{p.spacing}, 3))) / std::sqrt(g * depth);
    return trial->outcome({{"pressure at gauges, rms over rho g H", "", gauged, 0, gauged, 0.01},
                           {"pressures of single particles, rms over rho g H", "", rms, 0, rms, {}},
                           {"speed left over sqrt(g H)", "", speed, 0, speed, 0.002}},
                          {"Hydrostatic pressure", "p / (rho g H)", "height above the floor, m", {measured, reference}});
}

}  // namespace rivulet
