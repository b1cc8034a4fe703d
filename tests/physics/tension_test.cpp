// Water inside holds together (dfsph): against hydrostatics below the pressure of the air, and the conservation of momentum.
#include <gtest/gtest.h>

#include <algorithm>

#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::tension_test {
namespace {

// Water under a ceiling between walls has no air above it: it hangs, and its pressure is -rho g times the height over its lower surface.
TEST(Tension, WaterHangsFromACeiling) {
    FluidParams p;
    p.method = "dfsph";
    p.dfsph.negativePressure = true;
    p.spacing = 0.02F;
    p.box = {.min = vec3(0), .max = vec3(0.3F, 0.8F, 0.12F), .periodicZ = true};
    p.blocks = {{.min = vec3(0, 0.4F, 0), .max = vec3(0.3F, 0.8F, 0.12F)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    double sums[2] = {}, counts[2] = {}, height = 0, particles = 0;
    for (int frame = 0; frame < 24; ++frame) {
        world->step({}, 1.0 / 60);
        if (frame < 12) continue;
        const HostParticles all = readParticles(*world);
        const std::vector<float> pressures = world->pressures();
        ASSERT_EQ(all.position.size(), pressures.size());
        for (size_t k = 0; k < pressures.size(); ++k) {
            const double above = double{all.position[k].y} - 0.4;
            height += above;
            particles += 1;
            for (int layer = 0; layer < 2; ++layer)  // around 0.1 and 0.3 m
                if (std::abs(above - 0.1 - 0.2 * layer) < 0.03) {
                    sums[layer] += static_cast<double>(pressures[k]);
                    counts[layer] += 1;
                }
        }
    }
    EXPECT_NEAR(height / particles, 0.2, 0.1 * 0.02) << "m over the lower surface";
    EXPECT_NEAR(sums[0] / counts[0], -9.81e3 * 0.1, 0.2 * 9.81e3 * 0.1) << "Pa";
    EXPECT_NEAR(sums[1] / counts[1], -9.81e3 * 0.3, 0.2 * 9.81e3 * 0.3) << "Pa";
}

// A turning block, which only tension holds together, keeps its momentum and its angular momentum.
TEST(Tension, ShiftingKeepsMomentumAndAngularMomentum) {
    FluidParams p;
    p.method = "dfsph";
    p.dfsph.negativePressure = true;
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = vec3(0.3F), .max = vec3(0.6F), .velocity = vec3(0.1F, 0, 0), .spin = vec3(0, 0, 4)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    struct Sum {
        dvec3 linear{0.0}, angular{0.0};
        double speeds = 0, levers = 0;
    };
    const auto sum = [&] {
        Sum s;
        const HostParticles all = readParticles(*world);
        for (size_t k = 0; k < all.position.size(); ++k) {
            const dvec3 x = dvec3(all.position[k]) - 0.45, v(all.velocity[k]);
            s.linear += v;
            s.angular += glm::cross(x, v);
            s.speeds += glm::length(v);
            s.levers += glm::length(x) * glm::length(v);
        }
        return s;
    };
    const Sum before = sum();
    float lowest = 0;
    for (int frame = 0; frame < 20; ++frame) {
        world->step({}, 1.0 / 60);
        for (const float pascal : world->pressures()) lowest = std::min(lowest, pascal);
    }
    const Sum after = sum();
    EXPECT_LT(lowest, -100) << "Pa: without tension there is no shifting to test";
    EXPECT_LT(glm::length(after.linear - before.linear) / before.speeds, 1.0e-5);
    EXPECT_LT(glm::length(after.angular - before.angular) / before.levers, 1.0e-4);
}

}  // namespace
}  // namespace rivulet::tension_test
