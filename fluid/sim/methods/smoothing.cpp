#include "fluid/sim/methods/smoothing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rivulet {

namespace {

double wendlandShape(double q) {
    const double a = std::max(1.0 - q, 0.0);
    return a * a * a * a * (4.0 * q + 1.0);
}

double cubicShape(double q) {
    const double a = std::max(1.0 - q, 0.0), b = std::max(0.5 - q, 0.0);
    return 2.0 * a * a * a - 8.0 * b * b * b;
}

// Sum over lattice planes from..to along one axis, without the kernel's factor.
double latticeSum(double (*shape)(double), double support, int from, int to) {
    const int n = static_cast<int>(std::ceil(support));
    double sum = 0;
    for (int z = from; z <= to; ++z)
        for (int y = -n; y <= n; ++y)
            for (int x = -n; x <= n; ++x) sum += shape(std::sqrt(double(x * x + y * y + z * z)) / support);
    return sum;
}

}  // namespace

double wendlandLatticeSum(double support) {
    const int n = static_cast<int>(std::ceil(support));
    return 21.0 / (2.0 * kPiD * support * support * support) * latticeSum(wendlandShape, support, -n, n);
}

double cubicLatticeSum(double support) {
    const int n = static_cast<int>(std::ceil(support));
    return 8.0 / (kPiD * support * support * support) * latticeSum(cubicShape, support, -n, n);
}

// By Fourier: a wave k of pressures comes back |sum_r g(r) sin(k r)|^2 / sum_r |g(r)|^2 times as large. The largest is looked for along the
// lattice's axes and diagonals.
double wendlandCoupling(double support) {
    const int n = static_cast<int>(std::ceil(support));
    constexpr int kWaves = 64;
    const dvec3 ways[] = {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
    std::vector<dvec3> sums(std::size(ways) * kWaves, dvec3(0.0));
    double squares = 0;
    for (int z = -n; z <= n; ++z)
        for (int y = -n; y <= n; ++y)
            for (int x = -n; x <= n; ++x) {
                const dvec3 r(x, y, z);
                const dvec3 g = r * std::pow(std::max(1 - glm::length(r) / support, 0.0), 3);  // the slope of Wendland C2
                squares += glm::dot(g, g);
                for (size_t k = 0; k < sums.size(); ++k) {
                    const double wave = kPiD * static_cast<double>(k % kWaves + 1) / kWaves;
                    sums[k] += g * std::sin(wave * glm::dot(ways[k / kWaves], r));
                }
            }
    double most = 0;
    for (const dvec3& sum : sums) most = std::max(most, glm::dot(sum, sum));
    return most / squares;
}

void fillSmoothing(const FluidParams& p, StepParams& s) {
    const double h = s.h;
    if (p.kernel == "cubic_spline") {
        const double lattice = cubicLatticeSum(p.supportSpacings);
        s.kernelK = static_cast<float>(8.0 / (kPiD * h * h * h) / lattice);
        s.gradientK = static_cast<float>(-8.0 / (kPiD * std::pow(h, 5)) / lattice);
        return;
    }
    const double lattice = wendlandLatticeSum(p.supportSpacings);
    s.kernelK = static_cast<float>(21.0 / (2.0 * kPiD * h * h * h) / lattice);
    s.gradientK = static_cast<float>(-210.0 / (kPiD * std::pow(h, 8)) / lattice);
}

}  // namespace rivulet
