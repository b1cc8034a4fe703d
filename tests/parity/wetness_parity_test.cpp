// Wet surfaces on cl and gl: as on the cpu, and of bodies that the GPU moves by the poses that only it knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"
#include "tests/physics/baked_mesh.h"

namespace rivulet::wetness_parity_test {
namespace {

FluidParams pool() {
    FluidParams p;
    p.spacing = 0.025F;
    p.pbf.minSubsteps = 4;
    p.box.max = vec3(0.4F, 0.8F, 0.4F);
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.2F, 0.4F), vec3(0.0F)}};
    p.wetness.on = true;
    p.wetness.dries = 1;
    return p;
}

std::vector<float> wetnessOf(FluidWorld& world) {
    const WetnessView wet = world.wetness();
    return world.device().readAll<float>(*wet.values, wet.surface->points.size());
}

// A pillar in a pool, half of it under water, and lifted out of it.
std::vector<float> wetPillar(Device& device) {
    const FluidParams p = pool();
    const VoxelField pillar = test::baked(test::makeBox(vec3(-0.06F, -0.12F, -0.06F), vec3(0.06F, 0.12F, 0.06F)), 0.01F, p.spacing);
    Pose pose{vec3(0.2F)};
    auto world = FluidWorld::create(device, p, {.rigid = {{&pillar, pose}}}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return {};
    for (int k = 0; k < 24; ++k) {
        if (k >= 12) pose.position.y += 0.02F;
        (*world)->step({.poses = std::span(&pose, 1)}, 1.0 / 60);
        device.finish();
        device.poll();
    }
    return wetnessOf(**world);
}

// A light box that rises out of the pool and turns, and one that falls into it. They touch nothing else.
std::vector<Body> boxes(const FluidParams& p) {
    std::vector<Body> two(2);
    two[0].shape = boxShape(vec3(0.1F, 0.12F, 0.08F), 150, p.spacing);
    two[0].state = {{vec3(0.12F, 0.14F, 0.2F), glm::angleAxis(0.5F, vec3(0, 0, 1))}, vec3(0, 1.5F, 0), vec3(0, 3, 0)};
    two[1].shape = boxShape(vec3(0.1F, 0.15F, 0.08F), 600, p.spacing);
    two[1].state = {{vec3(0.28F, 0.38F, 0.2F), glm::angleAxis(0.7F, glm::normalize(vec3(1, 2, 3)))}, vec3(0, -1, 0), vec3(5, 0, 3)};
    return two;
}

std::vector<float> wetBoxes(Device& device, const std::function<void()>& frameEnds) {
    FluidParams p = pool();
    p.fixedStep = 1.0F / 240;
    p.limits = false;  // steps do not depend on when the host learns how fast particles are
    auto world = FluidWorld::create(device, p, {.bodies = boxes(p)}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return {};
    for (int k = 0; k < 10; ++k) {
        (*world)->step({}, 1.0 / 60);
        frameEnds();
    }
    EXPECT_EQ((*world)->stats().bodyWaits, 0U);
    EXPECT_EQ((*world)->bodyRows().current, device.backend() != Backend::cpu);
    return wetnessOf(**world);
}

class WetnessParity : public testing::TestWithParam<const char*> {};

void expectAlike(const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    double sum = 0, off = 0;
    size_t dry = 0;
    for (size_t k = 0; k < a.size(); ++k) {
        sum += double{a[k]};
        off += std::abs(double{a[k]} - double{b[k]});
        if (a[k] < 0.05F) ++dry;
    }
    EXPECT_GT(sum, 0.2 * static_cast<double>(a.size()));
    EXPECT_GT(dry, a.size() / 10);
    EXPECT_LT(off / sum, 0.03);
}

TEST_P(WetnessParity, TheSamePlacesAreWet) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    expectAlike(wetPillar(*cpu), wetPillar(*gpu->device));
}

// Of bodies, too, and not a bit of it depends on when the host learns where they are.
TEST_P(WetnessParity, TheSamePlacesOfBodiesAreWetHoweverLateTheirStates) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const std::vector<float> prompt = wetBoxes(*gpu->device, [&] {
        gpu->device->finish();
        gpu->device->poll();
    });
    expectAlike(wetBoxes(*cpu, [] {}), prompt);
    LateDevice late(*gpu->device, 2);
    EXPECT_EQ(wetBoxes(late, [&] { late.frameEnds(); }), prompt);
}

// The wetness of each point by the law, from its wetness a frame earlier, the exact pose of its body and all particles.
TEST_P(WetnessParity, ABodyIsWetWhereTheGpuHasIt) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    LateDevice late(*gpu->device, 2);
    FluidParams p = pool();
    p.wetness.runs = 0.3F;
    auto world = FluidWorld::create(late, p, {.bodies = boxes(p)}, {});
    ASSERT_TRUE(world) << world.error().message;
    const WetSurface& surface = *(*world)->wetness().surface;
    ASSERT_EQ(surface.solids.size(), 2U);
    double off = 0;
    size_t ran = 0, touchedNow = 0;
    for (int frame = 0; frame < 12; ++frame) {
        const std::vector<float> before = wetnessOf(**world);
        const size_t reads = late.reads;
        (*world)->step({}, 1.0 / 60);
        EXPECT_EQ(late.reads, reads) << "nothing waits";
        late.frameEnds();
        if (frame % 3 != 2) continue;
        EXPECT_TRUE((*world)->bodyRows().current);
        const std::vector<float> now = wetnessOf(**world);
        const std::vector<vec3> particles = positions(**world);
        const std::vector<BodyState> states = (*world)->bodies();
        for (size_t s = 0; s < surface.solids.size(); ++s) {
            const WetSolid& solid = surface.solids[s];
            const Pose& pose = states[solid.solid.index].pose;
            const double kept = std::exp(-1.0 / 60 / double{p.wetness.dries}), falls = 1 / (1 + double{solid.cell / p.wetness.runs});
            const double runs = 1 - std::exp(-0.06 / 60 / double{solid.cell});
            for (size_t k = solid.firstPoint; k < solid.firstPoint + solid.points; ++k) {
                const vec3 own(surface.points[k].place), outward(surface.points[k].normal);
                const vec3 down = glm::conjugate(pose.rotation) * vec3(0, -1, 0), up = outward * glm::dot(outward, down) - down;
                const float slope = glm::length(up);
                double wet = double{before[k]} * kept;
                if (slope > 0.1F) {
                    const double above = double{surface.at(before, s, own + up * (solid.cell / slope))};
                    const double flows = runs * double{slope} * std::max(falls * above - wet, 0.0);
                    if (flows > 1.0e-3) ++ran;
                    wet += flows;
                }
                const vec3 at = pose.toWorld(own), n = pose.rotation * outward;
                float nearest = std::numeric_limits<float>::max();
                for (const vec3& x : particles)
                    if (glm::dot(x - at, n) >= 0) nearest = std::min(nearest, glm::length(x - at));
                const double touched = std::clamp((1.4 - double{nearest / p.spacing}) / 0.4, 0.0, 1.0);
                if (touched > wet) ++touchedNow;
                off = std::max(off, std::abs(double{now[k]} - std::max(wet, touched)));
            }
        }
    }
    EXPECT_GT(ran, 50U);
    EXPECT_GT(touchedNow, 500U);
    EXPECT_LT(off, 5.0e-5);
    std::printf("%s: %zu points ran, %zu were touched, off by %.1e at most\n", GetParam(), ran, touchedNow, off);
}

INSTANTIATE_TEST_SUITE_P(Devices, WetnessParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::wetness_parity_test
