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
    // Gauges: cubes as wide as a support radius, at least a support radius from walls and surface. An instrument has a band, too: they show
    // the mean over the last half second, in which the column swings up and down several times.
    constexpr double kMean = 0.5;  // s
    const float h = p.spacing * p.supportSpacings;
    struct Gauge {
        double pressure = 0, height = 0, count = 0;
        double frames = 0, mean = 0, squares = 0;  // of single frames' means
    };
    std::map<std::tuple<int, int, int>, Gauge> gauges;
    double squares = 0, count = 0;
    const double late = double{trial->scene().duration} - kMean;
    const bool done = trial->run(1.0 / 60, [&] {
        if (trial->time() < late) return;
        const ParticleView view = trial->world().particles();
        const std::vector<vec4> x = trial->world().device().readAll<vec4>(*view.position, view.count);
        const std::vector<float> own = trial->world().pressures();
        const std::vector<double> virial = virialPressures(x, own, p);
        std::map<std::tuple<int, int, int>, Gauge> now;
        squares = count = 0;
        for (size_t i = 0; i < x.size(); ++i) {
            if (x[i].w < 0) continue;
            const vec3 in = vec3(x[i]) - box.min, out = box.max - vec3(x[i]);
            const double height = in.y, error = double{own[i]} / most - (1 - height / depth);
            squares += error * error;
            count += 1;
            if (std::min({in.x, in.y, in.z, out.x, out.z}) < h || height > depth - double{h}) continue;
            const ivec3 cell(glm::floor(in / h));
            Gauge& gauge = now[{cell.x, cell.y, cell.z}];
            gauge.pressure += virial[i] / most;
            gauge.height += height;
            gauge.count += 1;
        }
        for (const auto& [cell, one] : now) {
            if (one.count < 4) continue;  // cut by the margin
            Gauge& gauge = gauges[cell];
            gauge.pressure += one.pressure;
            gauge.height += one.height;
            gauge.count += one.count;
            const double error = one.pressure / one.count - (1 - one.height / one.count / depth);
            gauge.frames += 1;
            gauge.mean += error;
            gauge.squares += error * error;
        }
    });
    if (!done) return trial->outcome({}, {});

    Curve measured{"gauges", false, {}}, reference{"the weight above", true, {{0, depth}, {1, 0}}};
    double gaugeSquares = 0, gaugeCount = 0, swings = 0;
    for (const auto& [cell, gauge] : gauges) {
        const double pressure = gauge.pressure / gauge.count, height = gauge.height / gauge.count;
        gaugeSquares += std::pow(pressure - (1 - height / depth), 2);
        gaugeCount += 1;
        swings += std::max(gauge.squares / gauge.frames - std::pow(gauge.mean / gauge.frames, 2), 0.0);
        measured.points.emplace_back(pressure, height);
    }
    const double gauged = gaugeCount > 0 ? std::sqrt(gaugeSquares / gaugeCount) : 1, rms = std::sqrt(squares / count);
    const double swing = gaugeCount > 0 ? std::sqrt(swings / gaugeCount) : 1;
    const FluidStats& s = trial->world().stats();
    const double speed = std::sqrt(2 * s.kinetic / (double{p.restDensity} * count * std::pow(double{p.spacing}, 3))) / std::sqrt(g * depth);
    return trial->outcome({{"pressure at gauges, mean of 0.5 s, rms over rho g H", "", gauged, 0, gauged, 0.01},
                           {"pressure at gauges, rms of its changes in time over rho g H", "", swing, 0, swing, {}},
                           {"pressures of single particles, rms over rho g H", "", rms, 0, rms, {}},
                           {"speed left over sqrt(g H)", "", speed, 0, speed, 0.002}},
                          {"Hydrostatic pressure", "p / (rho g H)", "height above the floor, m", {measured, reference}});
}

}  // namespace rivulet
