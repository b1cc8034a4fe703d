// Negative pressure inside water, and none at its surfaces (method dfsph): against formulas of mechanics.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/validate/clusters.h"
#include "tests/physics/worlds.h"

namespace rivulet::inside_tension_test {
namespace {

struct Water {
    std::unique_ptr<CpuDevice> device = cpu();
    std::unique_ptr<FluidWorld> world;
    vec3 gravity;
    explicit Water(const FluidParams& p) : world(makeWorld(*device, p)), gravity(p.gravity) {}
    void run(int frames) const {
        for (int k = 0; k < frames; ++k) world->step({.gravity = gravity}, 1.0 / 120);
    }
    std::vector<vec4> positions() const { return device->readAll<vec4>(*world->particles().position, world->particles().count); }
    std::vector<vec4> velocities() const { return device->readAll<vec4>(*world->particles().velocity, world->particles().count); }
};

constexpr float kSide = 1.0F, kTurn = 4.0F;  // m, rad/s

// A square of water that turns without gravity, in a slab 4 spacings thick.
FluidParams turningPatch(float support) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.04F;
    p.supportSpacings = support;
    p.gravity = vec3(0.0F);
    p.box.min = vec3(-2.0F, -2.0F, 0.0F);
    p.box.max = vec3(2.0F, 2.0F, 0.2F);
    p.box.periodicZ = true;
    p.blocks = {
        {.min = vec3(-0.5F * kSide, -0.5F * kSide, 0.0F), .max = vec3(0.5F * kSide, 0.5F * kSide, 0.2F), .spin = vec3(0, 0, kTurn)}};
    return p;
}

// While it turns as a rigid body, lap p = 2 rho w^2, and p = 0 along its edge: as in a twisted square bar (Timoshenko and Goodier 1951),
// p in its middle is -0.1473 rho w^2 L^2. The patch of particles ends half a spacing outside the outermost, where p is 0.
TEST(InsideTension, ATurningSquareHasThePressureOfItsPoissonEquation) {
    for (const float support : {2.0F, 2.3F}) {
        FluidParams p = turningPatch(support);
        p.dfsph.tolerance = 1.0e-6F;
        const Water water(p);
        double sum = 0, count = 0;
        for (int step = 0; step < 8; ++step) {
            water.world->step({.gravity = vec3(0.0F)}, 1.0 / 960);
            if (step < 4) continue;  // the solve begins from 0
            const std::vector<vec4> x = water.positions();
            const std::vector<float> pressure = water.world->pressures();
            for (size_t i = 0; i < x.size(); ++i)
                if (std::hypot(x[i].x, x[i].y) < 0.08F) sum += double{pressure[i]}, count += 1;
        }
        const double expected = -0.1473 * 1000 * double{kTurn * kTurn} * double{kSide * kSide};
        EXPECT_NEAR(sum / count / expected, 1, 0.12) << support;
    }
}

// Without tension each particle flies straight ahead, and the patch becomes dust: at w t = 1.5 its area has grown by more than a half. No
// work is done on it: its energy never rises, and its angular momentum is constant.
TEST(InsideTension, ATurningSquareStaysInOnePieceAndKeepsItsArea) {
    for (const float support : {2.0F, 2.3F}) {
        SCOPED_TRACE(support);
        const FluidParams p = turningPatch(support);
        const Water water(p);
        const auto area = [&] { return coveredVolume(water.positions(), 0.75 * double{p.spacing}, 0.25 * double{p.spacing}, 0.2); };
        const auto motion = [&] {
            const std::vector<vec4> x = water.positions(), v = water.velocities();
            dvec2 sum(0.0);  // twice the kinetic energy and the angular momentum, over the mass of a particle
            for (size_t i = 0; i < x.size(); ++i) {
                sum.x += glm::dot(dvec3(v[i]), dvec3(v[i]));
                sum.y += glm::cross(dvec3(x[i]), dvec3(v[i])).z;
            }
            return sum;
        };
        const double before = area();
        const dvec2 first = motion();
        for (int frame = 0; frame < 45; ++frame) {
            water.run(1);
            const dvec2 now = motion();
            ASSERT_LT(now.x / first.x, 1.001) << frame;
            ASSERT_NEAR(now.y / first.y, 1, 1e-4) << frame;
        }
        EXPECT_NEAR(area() / before, 1, 0.06);
        EXPECT_GT(largestCluster(water.positions(), 1.5 * double{p.spacing}, 0.2), 0.97);
        EXPECT_LT(motion().x / first.x, 0.99) << "it has grown arms, which turn more slowly";
    }
}

// Two bodies of water that touch do not hold each other: what flies apart has the speed that it had.
TEST(InsideTension, BodiesThatPartKeepTheirSpeed) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.04F;
    p.gravity = vec3(0.0F);
    p.box.min = vec3(-2.0F);
    p.box.max = vec3(2.0F);
    // A gap of 1.5 spacings between the outermost particles: within the support radius.
    p.blocks = {{.min = vec3(-0.42F, -0.2F, -0.2F), .max = vec3(-0.02F, 0.2F, 0.2F), .velocity = vec3(-0.5F, 0, 0)},
                {.min = vec3(0.0F, -0.2F, -0.2F), .max = vec3(0.4F, 0.2F, 0.2F), .velocity = vec3(0.5F, 0, 0)}};
    const Water water(p);
    water.run(30);
    for (const vec4& v : water.velocities()) ASSERT_NEAR(std::abs(v.x), 0.5F, 0.005F);
}

// A wall only pushes: water below a ceiling, with nothing else around it, falls as any body does.
TEST(InsideTension, WaterFallsOffACeiling) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.04F;
    p.box.max = vec3(0.4F, 2.0F, 0.4F);
    p.box.periodicX = p.box.periodicZ = true;
    p.blocks = {{.min = vec3(0.0F, 1.6F, 0.0F), .max = vec3(0.4F, 2.0F, 0.4F)}};
    const Water water(p);
    const auto height = [&] {
        double sum = 0;
        const std::vector<vec4> x = water.positions();
        for (const vec4& at : x) sum += double{at.y} / static_cast<double>(x.size());
        return sum;
    };
    const double before = height();
    water.run(36);
    EXPECT_NEAR(before - height(), 0.5 * 9.81 * 0.09, 0.01);
}

}  // namespace
}  // namespace rivulet::inside_tension_test
