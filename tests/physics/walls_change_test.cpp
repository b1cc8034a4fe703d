// Walls, emitters and sinks that are added and removed while the water flows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/host_particles.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/worlds.h"

namespace rivulet::walls_change_test {
namespace {

constexpr float kSpacing = 0.025F;
constexpr double kFrame = 1.0 / 60;

FluidParams tank() {
    FluidParams p;
    p.spacing = kSpacing;
    p.box.max = vec3(1.0F, 0.6F, 0.25F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.4F, 0.25F)}};
    return p;
}

VoxelField box(const vec3& low, const vec3& high) { return test::baked(test::makeBox(low, high), 0.25F * kSpacing, kSpacing); }
// A wall across the tank, thicker than it needs to be.
VoxelField gate(float x) { return box(vec3(x, -0.1F, -0.1F), vec3(x + 0.05F, 0.7F, 0.35F)); }

void run(FluidWorld& world, int frames, std::span<const Pose> poses = {}) {
    for (int k = 0; k < frames; ++k) world.step({.poses = poses}, kFrame);
}

std::vector<vec4> waterOf(const FluidWorld& world) { return readParticles(world).position; }
dvec3 centre(const FluidWorld& world) {
    dvec3 sum(0.0);
    const std::vector<vec4> all = waterOf(world);
    for (const vec4& p : all) sum += dvec3(p);
    return sum / static_cast<double>(all.size());
}
float farthest(const FluidWorld& world) {
    float x = 0;
    for (const vec4& p : waterOf(world)) x = std::max(x, p.x);
    return x;
}

// The water behind a gate runs out as that of a world which has none and begins with the same particles.
TEST(WallsChange, WaterRunsOutWhereAWallWasRemoved) {
    auto device = cpu();
    const VoxelField wall = gate(0.3F + 0.5F * kSpacing);
    auto world = makeWorld(*device, tank(), {.rigid = {{&wall, {}}}});
    run(*world, 30);
    EXPECT_LT(farthest(*world), 0.35F);
    auto without = makeWorld(*device, tank());
    ASSERT_TRUE(without->continueFrom(*world, {}, {}));
    const Status removed = world->setWalls({});
    ASSERT_TRUE(removed) << removed.error().message;
    for (int k = 0; k < 4; ++k) {
        run(*world, 5);
        run(*without, 5);
        EXPECT_LT(glm::length(centre(*world) - centre(*without)), 0.05 * double{kSpacing}) << "after " << 5 * (k + 1) << " frames";
    }
    EXPECT_GT(farthest(*world), 0.8F);
}

TEST(WallsChange, AnAddedWallHoldsTheWater) {
    auto device = cpu();
    const VoxelField wall = gate(0.6F);
    for (const bool still : {false, true}) {
        auto world = makeWorld(*device, tank());
        run(*world, 6);
        ASSERT_LT(farthest(*world), 0.59F);
        const Solids solids = still ? Solids{.field = &wall} : Solids{.rigid = {{&wall, {}}}};
        const Status added = world->setWalls(solids);
        ASSERT_TRUE(added) << added.error().message;
        auto always = makeWorld(*device, tank(), solids);
        run(*world, 74);
        run(*always, 80);
        EXPECT_LT(farthest(*world), 0.6F);
        EXPECT_EQ(waterOf(*world).size(), waterOf(*always).size());
        // Both are at rest, and as high.
        EXPECT_NEAR(centre(*world).y, centre(*always).y, 0.1 * double{kSpacing});
        EXPECT_NEAR(centre(*world).x, centre(*always).x, 0.3 * double{kSpacing});
    }
}

TEST(WallsChange, TheSameWallsChangeNothing) {
    auto device = cpu();
    const VoxelField a = gate(0.45F), b = box(vec3(0.1F, 0.0F, 0.1F), vec3(0.2F, 0.1F, 0.2F));
    FluidParams p = tank();
    p.blocks[0].min.y = 0.15F;
    const Solids solids{
        .field = &a, .planes = {{.position = vec3(0.0F, 0.02F, 0.0F)}}, .rigid = {{&b, {}}}, .surfaces = {{.friction = 0.4F}}};
    auto world = makeWorld(*device, p, solids), other = makeWorld(*device, p, solids);
    for (int k = 0; k < 20; ++k) {
        run(*world, 1);
        run(*other, 1);
        ASSERT_TRUE(other->setWalls(solids, other->poses()));
    }
    EXPECT_TRUE(waterOf(*world) == waterOf(*other));
}

// A wall too far away to act is added while a paddle moves: the run is that of a world which has both from the start.
TEST(WallsChange, OtherWallsKeepTheirMotion) {
    auto device = cpu();
    const VoxelField paddle = box(vec3(-0.03F, -0.1F, -0.2F), vec3(0.03F, 0.5F, 0.2F)),
                     far = box(vec3(0.8F, 0.5F, 0.1F), vec3(0.9F, 0.55F, 0.2F));
    FluidParams p = tank();
    p.blocks[0] = {.min = vec3(0.2F, 0.0F, 0.0F), .max = vec3(0.8F, 0.15F, 0.25F)};
    const Pose start{vec3(0.1F, 0.1F, 0.125F), quat(1, 0, 0, 0)};
    auto both = makeWorld(*device, p, {.rigid = {{&paddle, start}, {&far, {}}}}),
         late = makeWorld(*device, p, {.rigid = {{&paddle, start}}});
    std::vector<Pose> poses = {start, {}};
    for (int k = 0; k < 40; ++k) {
        poses[0].position.x += static_cast<float>(0.3 * kFrame);
        run(*both, 1, poses);
        if (k == 20) {
            std::vector<Pose> now = late->poses();
            now.emplace_back();
            ASSERT_TRUE(late->setWalls({.rigid = {{&paddle, start}, {&far, {}}}}, now));
        }
        run(*late, 1, std::span(poses).first(k < 20 ? 1 : 2));
    }
    EXPECT_TRUE(waterOf(*both) == waterOf(*late));
    // And the paddle alone again, which the other order of removal must not confuse.
    ASSERT_TRUE(
        late->setWalls({.rigid = {{&paddle, start}}}, late->poses().size() == 2 ? std::span(late->poses()).first(1) : late->poses()));
    ASSERT_TRUE(both->setWalls({.rigid = {{&paddle, start}}}, std::vector<Pose>{both->poses()[0]}));
    for (int k = 0; k < 10; ++k) {
        poses[0].position.x += static_cast<float>(0.3 * kFrame);
        run(*both, 1, std::span(poses).first(1));
        run(*late, 1, std::span(poses).first(1));
    }
    EXPECT_TRUE(waterOf(*both) == waterOf(*late));
    late->reset();
    EXPECT_EQ(late->poses()[0].position, start.position);
}

TEST(WallsChange, WaterInsideAnAddedWallIsRemovedAndCounted) {
    auto device = cpu();
    FluidParams p = tank();
    p.blocks[0].max.x = 1.0F;
    const VoxelField block = box(vec3(0.4F, 0.05F, 0.05F), vec3(0.6F, 0.25F, 0.2F));
    for (const bool remove : {true, false}) {
        auto world = makeWorld(*device, p);
        run(*world, 10);
        const size_t before = waterOf(*world).size();
        ASSERT_TRUE(world->setWalls({.rigid = {{&block, {}}}}, {}, remove));
        run(*world, 30);
        const std::vector<vec4> after = waterOf(*world);
        size_t inside = 0;
        for (const vec4& at : after) inside += block.inside(vec3(at)) ? 1 : 0;
        const double particle = std::pow(double{kSpacing}, 3), volume = 0.2 * 0.2 * 0.15;
        if (remove) {
            EXPECT_EQ(inside, 0U);
            EXPECT_NEAR(static_cast<double>(before - after.size()) * particle, volume, 0.25 * volume);
        } else {
            EXPECT_EQ(after.size(), before);
        }
        EXPECT_NEAR(world->stats().drained, static_cast<double>(before - after.size()) * particle, 1.0e-9);
        EXPECT_LT(world->stats().maxSpeed, 3) << "nothing is thrown out";
    }
}

TEST(WallsChange, WhatDoesNotFitIsRefused) {
    auto device = cpu();
    const VoxelField wall = gate(0.5F);
    FluidParams p = tank();
    auto world = makeWorld(*device, p);
    run(*world, 2);
    const std::vector<vec4> before = waterOf(*world);
    const Pose nowhere{vec3(std::nanf("")), {}};
    EXPECT_FALSE(world->setWalls({.rigid = {{&wall, {}}}}, std::span(&nowhere, 1)));
    EXPECT_FALSE(world->setWalls({.rigid = {{&wall, {}}}}, std::vector<Pose>(2)));
    EXPECT_FALSE(world->setWalls({.planes = {{.normal = vec3(0.0F)}}}));
    device->limitMemory(device->bytesAllocated());
    EXPECT_FALSE(world->setWalls({.rigid = {{&wall, {}}}}));
    device->limitMemory(SIZE_MAX);
    EXPECT_TRUE(waterOf(*world) == before);
    auto plain = makeWorld(*device, p);
    run(*plain, 12);
    run(*world, 10);
    EXPECT_TRUE(waterOf(*world) == waterOf(*plain)) << "nothing was changed by what was refused";
    p.box.periodicX = p.box.periodicY = p.box.periodicZ = true;
    auto endless = makeWorld(*device, p);
    EXPECT_FALSE(endless->setWalls({.rigid = {{&wall, {}}}}));
}

TEST(SourcesChange, EmittersAndSinksComeAndGo) {
    auto device = cpu();
    FluidParams p = tank();
    p.blocks[0].max = vec3(1.0F, 0.1F, 0.25F);
    p.maxParticles = 20'000;
    auto world = makeWorld(*device, p);
    run(*world, 10);
    const double particle = std::pow(double{kSpacing}, 3);
    const auto volume = [&] { return static_cast<double>(waterOf(*world).size()) * particle; };
    const double start = volume();
    Sources sources;
    EmitterParams jet;
    jet.litresPerSecond = 2;
    jet.position = vec3(0.5F, 0.5F, 0.125F);
    sources.emitters = {{jet, {}}};
    Status set = world->setSources(sources);
    ASSERT_TRUE(set) << set.error().message;
    run(*world, 30);
    EXPECT_NEAR(volume() - start, 0.002 * 0.5, 0.05 * 0.001);
    sources.emitters.push_back(sources.emitters[0]);
    sources.emitters[1].params.position.x = 0.2F;
    sources.sinks = {{.position = vec3(0.9F, 0.0F, 0.125F), .size = vec3(0.2F, 0.2F, 0.3F)}};
    ASSERT_TRUE(world->setSources(sources));
    run(*world, 30);
    world->step({}, kFrame);
    const FluidStats with = world->stats();
    EXPECT_NEAR(with.emitted - start, 0.001 + 0.004 * 31 * kFrame, 0.1 * 0.003) << "what the first one let out before stays counted";
    EXPECT_GT(with.drained, 0.001);
    EXPECT_NEAR(volume(), with.emitted - with.drained, 1.0e-9) << "the ledger adds up";
    WorldState state;
    world->save(state);
    ASSERT_TRUE(world->setSources({}));
    const double then = volume();
    run(*world, 10);
    EXPECT_EQ(volume(), then);
    EXPECT_NEAR(world->stats().emitted - world->stats().drained, then, 1.0e-9);
    WorldState copy = state;
    EXPECT_FALSE(world->restore(copy)) << "it was saved with two emitters";
    ASSERT_TRUE(world->setSources(sources));
    const Status restored = world->restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
    run(*world, 1);
    EXPECT_NEAR(world->stats().emitted, with.emitted, 0.0003) << "the saved state has what was let out before";
    EmitterParams oil = jet;
    oil.liquid = "honey";
    Sources other;
    other.emitters = {{oil, {}}};
    EXPECT_FALSE(world->setSources(other));
}

}  // namespace
}  // namespace rivulet::walls_change_test
