// Poiseuille and Couette flow started from rest, against the series solutions (Morris, Fox and Zhu 1997).
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// u(y, t) in m/s between plates at rest at 0 and `length`, accelerated by `force` (m/s^2) from t = 0.
double poiseuille(double y, double t, double length, double nu, double force) {
    constexpr double pi = std::numbers::pi;
    double u = force / (2 * nu) * y * (length - y);
    for (int n = 1; n < 60; n += 2)
        u -= 4 * force * length * length / (nu * std::pow(pi * n, 3)) * std::sin(pi * n * y / length) *
             std::exp(-n * n * pi * pi * nu * t / (length * length));
    return u;
}

// u(y, t) in m/s between a plate at rest at 0 and one at `length` that moves at `speed` (m/s) from t = 0.
double couette(double y, double t, double length, double nu, double speed) {
    constexpr double pi = std::numbers::pi;
    double u = speed * y / length;
    for (int n = 1; n < 60; ++n)
        u += 2 * speed / (n * pi) * (n % 2 != 0 ? -1 : 1) * std::exp(-n * n * pi * pi * nu * t / (length * length)) *
             std::sin(n * pi * y / length);
    return u;
}

// Compares the velocity along x of a scene at 0.1 and 1 s with exact(y, t) in m/s; y from the lower plate.
Outcome channel(Trial& trial, const char* title, double length, double fastest, const std::function<double(double, double)>& exact) {
    const double floor = trial.params().box.min.y;
    std::vector<Finding> findings;
    Plot plot{title, "u / u max", "y / L", {}};
    const double times[] = {0.1, 1.0};
    size_t next = 0;
    const bool done = trial.run(1.0 / 60, [&] {
        if (next >= std::size(times) || trial.time() < times[next] - 1e-6) return;
        const HostParticles all = trial.particles();
        const double t = trial.time();
        Curve measured{fmt::format("measured, {:.1f} s", t), false, {}}, reference{fmt::format("series, {:.1f} s", t), true, {}};
        double error = 0, whole = 0;
        for (size_t i = 0; i < all.position.size(); ++i) {
            const double y = double{all.position[i].y} - floor, v = all.velocity[i].x, u = exact(y, t);
            error += (v - u) * (v - u);
            whole += u * u;
            if (i % 5 == 0) measured.points.emplace_back(v / fastest, y / length);
        }
        for (int k = 0; k <= 100; ++k) reference.points.emplace_back(exact(k * length / 100, t) / fastest, k / 100.0);
        plot.curves.insert(plot.curves.end(), {measured, reference});
        const double l2 = std::sqrt(error / whole);
        findings.push_back({fmt::format("profile at {} s, relative L2", times[next]), "", l2, 0, l2, 0.02});
        ++next;
    });
    if (!done) findings.clear();
    return trial.outcome(findings, plot);
}

}  // namespace

Result<Outcome> runPoiseuille(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("poiseuille", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double length = double{p.box.max.y - p.box.min.y}, nu = p.viscosity, force = p.gravity.x;
    return channel(*trial, "Poiseuille flow from rest", length, force * length * length / (8 * nu),
                   [=](double y, double t) { return poiseuille(y, t, length, nu, force); });
}

Result<Outcome> runCouette(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("couette", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const ColliderParams& plate = trial->scene().colliders[0];
    // The plate oscillates so slowly that its speed is nearly constant: it falls by 2e-5 in a second.
    const double speed = double{plate.motion.shake.x} * 2 * std::numbers::pi * double{plate.motion.shakeFrequency};
    const double length = double{p.blocks[0].max.y - p.blocks[0].min.y}, nu = p.viscosity;
    return channel(*trial, "Couette flow from rest", length, speed, [=](double y, double t) { return couette(y, t, length, nu, speed); });
}

}  // namespace rivulet
