// Flow between plates from rest, against the series solution (Morris, Fox and Zhu 1997).
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// u(y, t), m/s, between plates at rest at 0 and `length`, pulled along by `force` (m/s^2) from t = 0.
double poiseuille(double y, double t, double length, double nu, double force) {
    constexpr double pi = std::numbers::pi;
    double u = force / (2 * nu) * y * (length - y);
    for (int n = 1; n < 60; n += 2)
        u -= 4 * force * length * length / (nu * std::pow(pi * n, 3)) * std::sin(pi * n * y / length) *
             std::exp(-n * n * pi * pi * nu * t / (length * length));
    return u;
}

}  // namespace

Result<Outcome> runPoiseuille(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("poiseuille", settings);
    if (!trial) return trial.error();
    const FluidParams p = trial->params();
    const double length = double{p.box.max.y - p.box.min.y}, nu = p.viscosity, force = p.gravity.x;
    const double fastest = force * length * length / (8 * nu);
    std::vector<Finding> findings;
    Plot plot{"Poiseuille flow from rest", "u / u max", "y / L", {}};
    const double times[] = {0.1, 1.0};
    size_t next = 0;
    const bool done = trial->run(1.0 / 60, [&] {
        if (next >= std::size(times) || trial->time() < times[next] - 1e-6) return;
        const HostParticles all = trial->particles();
        const double t = trial->time();
        Curve measured{fmt::format("measured, {:.1f} s", t), false, {}}, reference{fmt::format("series, {:.1f} s", t), true, {}};
        double error = 0, whole = 0;
        for (size_t i = 0; i < all.position.size(); ++i) {
            const double y = double{all.position[i].y - p.box.min.y}, v = all.velocity[i].x, u = poiseuille(y, t, length, nu, force);
            error += (v - u) * (v - u);
            whole += u * u;
            if (i % 5 == 0) measured.points.emplace_back(v / fastest, y / length);
        }
        for (int k = 0; k <= 100; ++k)
            reference.points.emplace_back(poiseuille(k * length / 100, t, length, nu, force) / fastest, k / 100.0);
        plot.curves.insert(plot.curves.end(), {measured, reference});
        const double l2 = std::sqrt(error / whole);
        findings.push_back({fmt::format("profile at {} s, relative L2", times[next]), "", l2, 0, l2, 0.02});
        ++next;
    });
    if (!done) findings.clear();
    return trial->outcome(findings, plot);
}

}  // namespace rivulet
