// Exchange of water with other owners: withdrawal of particles, and deposit of volume.
#include "fluid/sim/sources/exchange_passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::exchange_test {
namespace {

constexpr float kSpacing = 0.03125F;  // m: a float, and so is its cube
constexpr double kOne = 0x1p-15;      // m^3, of a particle

// A pool 0.1875 m deep in a box of 0.5 m.
FluidParams pool() {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.box.min = vec3(0.0F);
    p.box.max = vec3(0.5F);
    p.blocks = {{vec3(0.0F), vec3(0.5F, 0.1875F, 0.5F), vec3(0.0F)}};
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& params, double poured = 100 * kOne) {
    auto world = FluidWorld::create(device, params, {}, {}, {.expectedDeposit = poured});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

TEST(Exchange, WithdrawRemovesOnlyTheChosenParticles) {
    auto device = makeTestCpu();
    auto world = make(*device, pool());
    for (const bool stepped : {false, true}) {
        if (stepped)
            for (int k = 0; k < 5; ++k) world->step({}, 1.0 / 60);
        const std::vector<vec3> before = positions(*world);
        const Bounds box{vec3(0.05F, 0.05F, 0.05F), vec3(0.4F, 0.5F, 0.4F)};
        const std::vector<WorldParticle> found = world->within(box);
        size_t expected = 0;
        for (const vec3& x : before)
            expected += glm::all(glm::greaterThanEqual(x, box.min)) && glm::all(glm::lessThanEqual(x, box.max)) ? 1 : 0;
        ASSERT_EQ(found.size(), expected);
        ASSERT_GT(expected, 100U);
        // Every third.
        std::vector<uint32_t> slots;
        std::set<std::tuple<float, float, float>> gone;
        for (size_t k = 0; k < found.size(); k += 3) {
            slots.push_back(found[k].slot);
            gone.insert({found[k].position.x, found[k].position.y, found[k].position.z});
        }
        world->withdraw(slots);
        const std::vector<vec3> after = positions(*world);
        EXPECT_EQ(after.size(), before.size() - slots.size());
        for (const vec3& x : after) EXPECT_EQ(gone.count({x.x, x.y, x.z}), 0U);
    }
    // The water closes the gap, and the statistics agree.
    for (int k = 0; k < 30; ++k) world->step({}, 1.0 / 60);
    EXPECT_NEAR(world->stats().emitted, static_cast<double>(positions(*world).size()) * kOne + world->stats().withdrawn, 1e-12);
    EXPECT_EQ(world->stats().lost, 0U);
}

TEST(Exchange, DepositsSpawnAParticleWhenTheirVolumeSuffices) {
    auto device = makeTestCpu();
    auto world = make(*device, pool());
    for (int k = 0; k < 5; ++k) world->step({}, 1.0 / 60);
    const size_t before = positions(*world).size();
    const vec3 place(0.31F, 0.2F, 0.18F);
    // A tear: less than a particle. It stays pending, and no particle appears.
    world->deposit(place, vec3(0, -2, 0), 8.0e-9);
    for (int k = 0; k < 5; ++k) world->step({}, 1.0 / 60);
    EXPECT_EQ(positions(*world).size(), before);
    EXPECT_NEAR(world->stats().pendingVolume, 8.0e-9, 1e-18);
    // Many tears: the first particle is spawned near the place, above the water.
    double poured = 8.0e-9;
    size_t now = before;
    for (int k = 0; k < 60; ++k, poured += 0.21 * kOne) {
        world->deposit(place, vec3(0, -2, 0), 0.21 * kOne);
        world->step({}, 1.0 / 60);
        if (const std::vector<vec3> all = positions(*world); all.size() > now) {
            if (now == before) {
                float nearest = 1;
                for (const vec3& x : all)
                    nearest = std::min(nearest, glm::distance(vec2(x.x, x.z), vec2(place.x, place.z)) + std::max(0.2F - x.y, 0.0F));
                EXPECT_LT(nearest, kSpacing);
            }
            now = all.size();
        }
        const FluidStats& s = world->stats();
        EXPECT_NEAR(s.deposited + s.pendingVolume, poured + 0.21 * kOne, 1e-15);
        EXPECT_NEAR(s.deposited, static_cast<double>(now - before) * kOne, 1e-15);
    }
    for (int k = 0; k < 30; ++k) world->step({}, 1.0 / 60);
    EXPECT_EQ(positions(*world).size(), before + static_cast<size_t>(poured / kOne));
    EXPECT_LT(world->stats().pendingVolume, kOne);
    EXPECT_LT(world->stats().maxCompression, 0.05);
    EXPECT_LT(world->stats().maxSpeed, 1.5);  // no particle was squeezed out
    world->reset();
    EXPECT_EQ(positions(*world).size(), before);
    EXPECT_EQ(world->stats().pendingVolume, 0.0);
    EXPECT_EQ(world->stats().withdrawn, 0.0);
}

// Pending volume is part of a saved world, and a restored world continues identically.
TEST(Exchange, ASavedWorldKeepsItsPendingVolume) {
    auto device = makeTestCpu();
    auto a = make(*device, pool()), b = make(*device, pool());
    for (int k = 0; k < 4; ++k) a->step({}, 1.0 / 60);
    const std::vector<WorldParticle> some = a->within({vec3(0.1F, 0.1F, 0.1F), vec3(0.3F, 0.3F, 0.3F)});
    std::vector<uint32_t> slots;
    for (const WorldParticle& p : some) slots.push_back(p.slot);
    ASSERT_FALSE(slots.empty());
    a->withdraw(slots);
    a->deposit(vec3(0.3F, 0.22F, 0.3F), vec3(0.1F, -1, 0), 2.6 * kOne);
    WorldState state;
    a->save(state);
    const Status restored = b->restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_EQ(b->stats().pendingVolume, a->stats().pendingVolume);
    EXPECT_EQ(b->stats().withdrawn, a->stats().withdrawn);
    for (int k = 0; k < 20; ++k) {
        a->step({}, 1.0 / 60);
        b->step({}, 1.0 / 60);
    }
    EXPECT_EQ(positions(*a), positions(*b));
    EXPECT_EQ(a->stats().deposited, 2 * kOne);
    // A world without a partner refuses the call.
    auto alone = make(*device, pool(), 0);
    WorldState again;
    a->save(again);
    EXPECT_FALSE(alone->restore(again));
}

}  // namespace
}  // namespace rivulet::exchange_test
