// Weakly compressible SPH (Monaghan 1994; Mueller et al. 2003).
#include "fluid/sim/method_wcsph.h"

#include <array>
#include <cmath>

namespace rivulet {

namespace {

constexpr double kPiD = 3.14159265358979323846;

double wendlandShape(double q) {
    const double a = std::max(1.0 - q, 0.0);
    return a * a * a * a * (4.0 * q + 1.0);
}

// Sum over lattice planes from..to along one axis, without the kernel's factor.
double latticeSum(double support, int from, int to) {
    const int n = static_cast<int>(std::ceil(support));
    double sum = 0;
    for (int z = from; z <= to; ++z)
        for (int y = -n; y <= n; ++y)
            for (int x = -n; x <= n; ++x) sum += wendlandShape(std::sqrt(double(x * x + y * y + z * z)) / support);
    return sum;
}

double wallShare(double distanceOverH) {
    const double s = std::clamp(1.0 - distanceOverH, 0.0, 1.0);
    return std::pow(s, 6) * (3.5 - 4.5 * s + 1.5 * s * s);
}

class Wcsph final : public Method {
  public:
    Wcsph(Kernel density, Kernel forces, bool thesis) : density_(density), forces_(forces), thesis_(thesis) {}

    bool wallsInDensity() const override { return !thesis_; }

    float soundSpeed(const FluidParams& p, float fastest) const override {
        if (thesis_) return std::sqrt(p.stiffness);  // dp/drho of (4)
        // Ten times the fastest flow keeps compression near 1 % (Monaghan 1994).
        return p.soundSpeed > 0 ? p.soundSpeed : 10.0F * fastest;
    }

    void fill(const FluidParams& p, float soundSpeed, StepParams& s) const override {
        const double h = s.h;
        if (thesis_) {
            s.kernelK = static_cast<float>(315.0 / (64.0 * kPiD * std::pow(h, 9)));
            s.gradientK = static_cast<float>(-45.0 / (kPiD * std::pow(h, 6)));
            s.stiffness = p.stiffness;
            s.restitution = 1.0F;  // the thesis's box turns the velocity round
            return;
        }
        const double lattice = wendlandLatticeSum(p.supportSpacings);
        s.kernelK = static_cast<float>(21.0 / (2.0 * kPiD * h * h * h) / lattice);
        s.gradientK = static_cast<float>(-210.0 / (kPiD * std::pow(h, 5)) / lattice);
        s.stiffness = soundSpeed * soundSpeed * p.restDensity / 7.0F;
        s.artificial = p.artificialViscosity * soundSpeed * 0.5F * s.h;
        s.wallOffset = static_cast<float>(wendlandWallOffset(p.supportSpacings)) * p.spacing;
    }

    void step(StepContext& c) override {
        Particles& p = c.particles;
        const uint32_t threads = c.grid.pairThreads();
        const Buffer& neighbors = c.grid.neighbors();
        if (thesis_) {
            c.device.run(density_, c.params, {&neighbors, &p.position, &p.density, &p.pressure}, threads);
            c.device.run(forces_, c.params, {&neighbors, &p.position, &p.velocity, &p.pressure, &p.acceleration, &p.density}, threads);
        } else {
            c.device.run(density_, c.params, {&neighbors, &p.position, &p.density, &p.pressure, &p.boundary}, threads);
            c.device.run(forces_, c.params, {&neighbors, &p.position, &p.velocity, &p.pressure, &p.acceleration, &p.boundary}, threads);
        }
    }

  private:
    Kernel density_, forces_;
    bool thesis_;
};

Result<std::unique_ptr<Method>> make(Device& device, bool thesis) {
    std::vector<Define> defines;
    if (thesis) defines.push_back({"THESIS", "1"});
    Result<Kernel> density = device.kernel("fluid/wcsph_density", defines);
    if (!density) return density.error();
    Result<Kernel> forces = device.kernel("fluid/wcsph_forces", defines);
    if (!forces) return forces.error();
    return std::unique_ptr<Method>(std::make_unique<Wcsph>(*density, *forces, thesis));
}

}  // namespace

Result<std::unique_ptr<Method>> makeWcsph(Device& device) { return make(device, false); }
Result<std::unique_ptr<Method>> makeWcsphThesis(Device& device) { return make(device, true); }

double wendlandLatticeSum(double support) {
    const int n = static_cast<int>(std::ceil(support));
    return 21.0 / (2.0 * kPiD * support * support * support) * latticeSum(support, -n, n);
}

double wendlandWallOffset(double support) {
    const int n = static_cast<int>(std::ceil(support));
    const double missing = latticeSum(support, -n, -1) / latticeSum(support, -n, n);
    // wallShare falls monotonically with distance: bisection.
    double near = 0, far = 1;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (near + far);
        (wallShare(middle) > missing ? near : far) = middle;
    }
    return near * support - 0.5;
}

}  // namespace rivulet
