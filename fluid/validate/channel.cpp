// Flow between plates and in a pipe, started from rest, against the series solutions (Morris, Fox and Zhu 1997; in a pipe: Szymanski 1932).
#include <fmt/format.h>

#include <algorithm>
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

// u(r, t) in m/s in a pipe of that radius, accelerated by `force` (m/s^2) from t = 0.
double pipe(double r, double t, double radius, double nu, double force) {
    double u = force / (4 * nu) * (radius * radius - r * r);
    for (int n = 1; n <= 20; ++n) {
        double zero = std::numbers::pi * (n - 0.25);  // McMahon's first term; Newton does the rest
        for (int k = 0; k < 8; ++k) zero += std::cyl_bessel_j(0, zero) / std::cyl_bessel_j(1, zero);
        u -= 2 * force * radius * radius / nu * std::cyl_bessel_j(0, zero * std::min(r / radius, 1.0)) /
             (std::pow(zero, 3) * std::cyl_bessel_j(1, zero)) * std::exp(-zero * zero * nu * t / (radius * radius));
    }
    return u;
}

// Compares the velocity along x of a scene at 0.1 and 1 s with exact(s, t) in m/s; s = where(position), 0 to length, m.
Result<Outcome> channel(Trial& trial, const char* title, double length, double fastest, const std::function<double(const vec3&)>& where,
                        const std::function<double(double, double)>& exact) {
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
            const double s = where(vec3(all.position[i])), v = all.velocity[i].x, u = exact(s, t);
            error += (v - u) * (v - u);
            whole += u * u;
            if (i % 5 == 0) measured.points.emplace_back(v / fastest, s / length);
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

// The distance from the lower end of the water at the start.
std::function<double(const vec3&)> height(const Trial& trial) {
    return [floor = double{trial.params().blocks[0].min.y}](const vec3& x) { return double{x.y} - floor; };
}

Result<Outcome> betweenPlates(const char* name, const char* title, const CaseSettings& settings) {
    Result<Trial> trial = Trial::open(name, settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double length = double{p.blocks[0].max.y - p.blocks[0].min.y}, nu = p.viscosity, force = p.gravity.x;
    return channel(*trial, title, length, force * length * length / (8 * nu), height(*trial),
                   [=](double y, double t) { return poiseuille(y, t, length, nu, force); });
}

}  // namespace

Result<Outcome> runPoiseuille(const CaseSettings& settings) { return betweenPlates("poiseuille", "Poiseuille flow from rest", settings); }

Result<Outcome> runPoiseuilleMesh(const CaseSettings& settings) {
    return betweenPlates("poiseuille_mesh", "Poiseuille flow from rest between meshes", settings);
}

Result<Outcome> runPipe(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("pipe", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const double radius = 0.5 * double{p.blocks[0].max.y - p.blocks[0].min.y}, nu = p.viscosity, force = p.gravity.x;
    return channel(
        *trial, "Flow in a pipe from rest", radius, force * radius * radius / (4 * nu),
        [](const vec3& x) { return std::hypot(double{x.y}, double{x.z}); },
        [=](double r, double t) { return pipe(r, t, radius, nu, force); });
}

Result<Outcome> runCouette(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("couette", settings);
    if (!trial) return trial.error();
    const FluidParams& p = trial->params();
    const ColliderParams& plate = trial->scene().colliders[0];
    // The plate oscillates so slowly that its speed is nearly constant: it falls by 2e-5 in a second.
    const double speed = double{plate.motion.shake.x} * 2 * std::numbers::pi * double{plate.motion.shakeFrequency};
    const double length = double{p.blocks[0].max.y - p.blocks[0].min.y}, nu = p.viscosity;
    return channel(*trial, "Couette flow from rest", length, speed, height(*trial),
                   [=](double y, double t) { return couette(y, t, length, nu, speed); });
}

}  // namespace rivulet
