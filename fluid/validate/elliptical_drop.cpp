// A cylinder of water with the velocity (-A x, A y) becomes an ellipse without gravity (Monaghan 1994, J. Comput. Phys. 110:399-406,
// doi:10.1006/jcph.1994.1034). Its pressure is positive and parabolic, so that the semi-axes a and b along x and y follow
//     da/dt = -A a,  db/dt = A b,  dA/dt = A^2 (a^2 - b^2) / (a^2 + b^2),
// and its kinetic energy is constant.
#include <cmath>

#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// a and b over the radius, and A over its start, at a time in units of 1 / A at the start. Runge and Kutta's fourth order.
dvec3 ellipse(double time) {
    const auto rate = [](const dvec3& s) {
        const double aa = s.x * s.x, bb = s.y * s.y;
        return dvec3(-s.z * s.x, s.z * s.y, s.z * s.z * (aa - bb) / (aa + bb));
    };
    constexpr int kSteps = 200;
    const double h = time / kSteps;
    dvec3 s(1.0);
    for (int n = 0; n < kSteps; ++n) {
        const dvec3 a = rate(s), b = rate(s + 0.5 * h * a), c = rate(s + 0.5 * h * b), d = rate(s + h * c);
        s += h / 6 * (a + 2.0 * b + 2.0 * c + d);
    }
    return s;
}

}  // namespace

Result<Outcome> runEllipticalDrop(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("elliptical_drop", settings);
    if (!trial) return trial.error();
    const BlockParams block = trial->params().blocks[0];
    const double stretch = block.gradientY.y;
    const auto energy = [&] {
        double sum = 0;
        for (const vec4& v : trial->particles().velocity) sum += glm::dot(dvec3(v), dvec3(v));
        return sum;
    };
    // The second moment of an ellipse along an axis is a quarter of its square. The lattice's own at the start stands for the radius.
    const auto axes = [&] {
        dvec3 sum(0.0);
        double count = 0;
        for (const vec4& x : trial->particles().position) {
            sum += dvec3(x) * dvec3(x);
            count += 1;
        }
        return glm::sqrt(4.0 * sum / std::max(count, 1.0));
    };
    const double energyBefore = energy();
    const dvec3 before = axes();
    double most = 1, last = 1;
    Curve across{"a", false, {}}, along{"b", false, {}}, a{"Monaghan, a", true, {}}, b{"Monaghan, b", true, {}};
    const bool done = trial->run(0.004, [&] {
        const double tau = stretch * trial->time();
        last = energy() / energyBefore;
        most = std::max(most, last);
        const dvec3 now = axes() / before, expected = ellipse(tau);
        across.points.emplace_back(tau, now.x);
        along.points.emplace_back(tau, now.y);
        a.points.emplace_back(tau, expected.x);
        b.points.emplace_back(tau, expected.y);
    });
    if (!done) return trial->outcome({}, {});
    const dvec3 now = axes() / before, expected = ellipse(stretch * trial->time());
    return trial->outcome(
        {{"short axis over the radius, tau = 0.76", "", now.x, expected.x, std::abs(now.x / expected.x - 1), toleranceOf(settings)},
         {"long axis over the radius, tau = 0.76", "", now.y, expected.y, std::abs(now.y / expected.y - 1), toleranceOf(settings)},
         {"kinetic energy, highest over that at the start", "", most, 1, most - 1, 0.001},
         {"kinetic energy at the end over that at the start", "", last, 1, std::abs(last - 1), {}}},
        {"Elliptical drop", "A t", "semi-axis over the radius", {across, along, a, b}});
}

}  // namespace rivulet
