// Skins in water on cl and gl, where the world answers some frames late: no volume is lost or counted twice, in any frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/flow/flow_mesh.h"
#include "fluid/flow/surface_flow.h"
#include "fluid/session/session.h"
#include "tests/parity/devices.h"

namespace rivulet::skin_exchange_parity_test {
namespace {

class SkinExchangeParity : public testing::TestWithParam<const char*> {};

// A square of 0.2 m and two triangles.
const std::vector<vec3> kCorners = {vec3(0), vec3(0.2F, 0, 0), vec3(0.2F, 0, 0.2F), vec3(0, 0, 0.2F)};
const std::vector<uint32_t> kIndices = {0, 2, 1, 0, 3, 2};
Result<SurfaceFlow> square(Device& device) {
    Result<FlowMesh> mesh = makeFlowMesh({kCorners, kIndices, {}, {}});
    if (!mesh) return mesh.error();
    return SurfaceFlow::create(device, std::move(*mesh), {.capacity = 64});
}

// A jet falls on a cow: its particles become drops, run down, drip, and become particles of the basin.
TEST_P(SkinExchangeParity, ItIsTheSameWaterInEveryFrame) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    constexpr double kSpacing = 0.008, kOne = kSpacing * kSpacing * kSpacing;
    Result<SceneFile> scene =
        loadScene("shower", std::vector<std::string>{"flow.0.mapSize=64", "fluid.spacing=0.008", "emitters.0.litresPerSecond=0.06",
                                                     "emitters.0.start=0", "emitters.0.stop=0.25", "flow.0.sources.0.rate=0"});
    ASSERT_TRUE(scene) << scene.error().message;
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *gpu->device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    SkinFlows& flows = (*session)->flows();
    size_t pending = 0;  // frames in which a particle waits to become drops
    for (int k = 0; k < 30; ++k) {
        (*session)->step(1.0 / 60, false);
        pending += flows.airDrops().size() / 2 > flows.inAir() ? 1 : 0;
        if (k % 3 != 2) continue;
        const SkinFlows::Ledger l = flows.ledger();  // then all reports have arrived
        const auto particles = static_cast<double>(positions(world).size());
        const FluidStats& f = world.stats();
        EXPECT_EQ(l.error, 0.0) << k;
        EXPECT_NEAR(l.taken, f.withdrawn, 1e-15) << k;
        EXPECT_NEAR(l.poured, f.deposited + f.pendingVolume, 1e-15) << k;
        EXPECT_NEAR(particles * kOne, f.emitted - f.drained - f.withdrawn, 0.1 * kOne) << k;
    }
    EXPECT_GT(pending, 0U);
    // The jet comes down on the cow; what is spawned above the water beside it may land on it again.
    const double jet = 0.25 * 0.06e-3;  // m^3
    EXPECT_GT(world.stats().withdrawn, 0.75 * jet);
    EXPECT_LT(world.stats().withdrawn, 1.25 * jet + world.stats().deposited);
    EXPECT_LT(flows.ledger().drained, 0.03 * jet);  // a few drops jump over the edge
}

// A skin that is nearly full: what is asked for by room() finds a slot, although the number in use is known some steps late.
TEST_P(SkinExchangeParity, NoDropIsRefusedThatFoundRoom) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Result<SurfaceFlow> flow = square(*gpu->device);
    ASSERT_TRUE(flow) << flow.error().message;
    uint32_t added = 0;
    for (int k = 0; k < 60; ++k) {
        if (k % 3 == 0) gpu->device->finish();  // it is no more than three steps behind
        const uint32_t some = std::min(flow->room(), 5U);
        for (uint32_t i = 0; i < some; ++i, ++added)  // apart: none merges
            flow->add({added % 2, 0.08F + 0.1F * static_cast<float>(added / 2 % 8), 0.04F + 0.015F * static_cast<float>(added / 16)},
                      20000);
        EXPECT_TRUE(flow->step({}, 1.0 / 60));
    }
    const SurfaceFlow::Ledger l = flow->ledger();
    EXPECT_EQ(l.refused, 0U);
    EXPECT_GE(added, 64U);
    EXPECT_EQ(l.drops + l.film, l.added);
    EXPECT_EQ(flow->room(), 64 - flow->drops().size());
}

// A skin that its device bends: the host knows its places some steps late, and where a motion with constant velocity has them by then.
TEST_P(SkinExchangeParity, ABendingSkinIsWhereItsMotionHasIt) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Device& device = *gpu->device;
    Result<SurfaceFlow> flow = square(device);
    Result<Buffer> moved = device.allocate(kCorners.size() * sizeof(vec4));
    ASSERT_TRUE(flow && moved);
    const auto places = [&](double time, double speed, double acceleration) {
        std::vector<vec4> all;
        for (size_t k = 0; k < kCorners.size(); ++k)
            all.emplace_back(
                kCorners[k] + vec3(0, static_cast<float>((speed * time + 0.5 * acceleration * time * time) * (k < 2 ? 1 : 0.5)), 0), 0.0F);
        return all;
    };
    constexpr double kFrame = 1.0 / 60, kAcceleration = 2;
    for (const double acceleration : {0.0, kAcceleration})
        for (int k = 1; k <= 20; ++k) {
            const std::vector<vec4> now = places(k * kFrame, 0.5, acceleration);
            device.writeAll<vec4>(*moved, now);
            if (k % 3 == 0) device.finish();
            EXPECT_TRUE(flow->step({.moved = &*moved}, kFrame));
            const SurfaceFlow::Shape shape = flow->shape();
            ASSERT_EQ(shape.places.size(), now.size());
            if (k < 8) continue;  // after the jump back to the beginning
            // Extrapolated over n frames from two reports one frame apart: a (n^2 + n) / 2 frames^2. Each third step all reports before it
            // have arrived, so n is 3 at most.
            constexpr double kLate = 3;
            const double error = 1e-6 + 0.5 * acceleration * (kLate * kLate + kLate) * kFrame * kFrame;
            for (size_t p = 0; p < now.size(); ++p) {
                const vec3 given(now[flow->mesh().given[p]]);
                EXPECT_LT(glm::distance(vec3(shape.places[p]), given), error) << k;
            }
        }
    // Positions of the host are known at once.
    std::vector<vec3> own = kCorners;
    for (vec3& p : own) p.y += 0.3F;
    EXPECT_TRUE(flow->step({.positions = own}, kFrame));
    for (const vec4& p : flow->shape().places) EXPECT_EQ(p.y, 0.3F);
    // Who asks for the first time sees the places of now, whatever was known before.
    Result<SurfaceFlow> unseen = square(device);
    ASSERT_TRUE(unseen) << unseen.error().message;
    EXPECT_TRUE(unseen->step({.positions = own}, kFrame));
    for (int k = 1; k <= 8; ++k) {
        device.writeAll<vec4>(*moved, places(k * kFrame, 0.5, 0));
        EXPECT_TRUE(unseen->step({.moved = &*moved}, kFrame));
    }
    const std::vector<vec4> now = places(8 * kFrame, 0.5, 0);
    const SurfaceFlow::Shape seen = unseen->shape();
    ASSERT_EQ(seen.places.size(), now.size());
    for (size_t p = 0; p < now.size(); ++p) EXPECT_EQ(vec3(seen.places[p]), vec3(now[unseen->mesh().given[p]]));
}

INSTANTIATE_TEST_SUITE_P(Devices, SkinExchangeParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::skin_exchange_parity_test
