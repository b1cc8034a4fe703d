// Vortices in a periodic box decay by viscosity (Taylor and Green 1937): u = -U e^(bt) cos(2 pi x) sin(2 pi y), b = -8 pi^2 nu / L^2.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runTaylorGreen(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("taylor_green", settings);
    if (!trial) return trial.error();
    const double length = double{trial->params().box.max.x}, k = 2 * std::numbers::pi / length, fastest = 1;
    const double b = -2 * double{trial->params().viscosity} * k * k;
    const auto flow = [&](const dvec3& x, double t) {
        return fastest * std::exp(b * t) * dvec3(-std::cos(k * x.x) * std::sin(k * x.y), std::sin(k * x.x) * std::cos(k * x.y), 0.0);
    };
    if (Status set = trial->setVelocities([&](const dvec3& x) { return flow(x, 0); }); !set) return set.error();
    Curve measured{"measured", true, {}}, reference{"e^(bt)", true, {}};
    // Root mean square speed; its decay rate from a line through the logarithm.
    double n = 0, st = 0, sy = 0, stt = 0, sty = 0;
    const bool done = trial->run(1.0 / 120, [&] {
        const HostParticles all = trial->particles();
        double sum = 0;
        for (const vec4& v : all.velocity) sum += glm::dot(dvec3(v), dvec3(v));
        const double t = trial->time(), speed = std::sqrt(2 * sum / static_cast<double>(all.velocity.size())) / fastest;
        measured.points.emplace_back(t, speed);
        reference.points.emplace_back(t, std::exp(b * t));
        n += 1;
        st += t;
        sy += std::log(speed);
        stt += t * t;
        sty += t * std::log(speed);
    });
    if (!done) return trial->outcome({}, {});
    const double rate = (n * sty - st * sy) / (n * stt - st * st);
    const HostParticles all = trial->particles();
    double off = 0, whole = 0;
    for (size_t i = 0; i < all.position.size(); ++i) {
        const double expected = glm::length(flow(dvec3(all.position[i]), trial->time()));
        off += std::abs(glm::length(dvec3(all.velocity[i])) - expected);
        whole += expected;
    }
    return trial->outcome({{"decay rate", "1/s", rate, b, std::abs(rate / b - 1), 0.05},
                           {fmt::format("speed at {:.1f} s, relative L1", trial->time()), "", off / whole, 0, off / whole, {}}},
                          {"Taylor-Green vortices, Re = 100", "time, s", "speed over that at the start", {measured, reference}});
}

}  // namespace rivulet
