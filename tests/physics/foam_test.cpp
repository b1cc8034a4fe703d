// Spray, foam and bubbles: breaking water creates them, calm water does not; each kind moves by its own law, and all are accounted for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "fluid/sim/world/fluid_world.h"
#include "fluid/voxel/voxel_field.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::foam_test {
namespace {

constexpr double kFrame = 1.0 / 60;

struct Fleck {
    vec3 position, velocity;
    float life = 0, kind = 0;
};

// A box of 1 x 1 x 0.5 m, water on its floor and, with `falls`, a column at one end.
FluidParams boxOf(float depth, bool falls, int most = 4096) {
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.025F;
    p.box.max = vec3(1.0F, 1.0F, 0.5F);
    p.blocks = {{vec3(0.0F), vec3(1.0F, depth, 0.5F), vec3(0.0F)}};
    if (falls) p.blocks.push_back({vec3(0.0F, depth, 0.0F), vec3(0.3F, 0.7F, 0.5F), vec3(0.0F)});
    p.foam.most = most;
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& params, const Solids& solids = {}) {
    auto world = FluidWorld::create(device, params, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

std::vector<Fleck> flecks(FluidWorld& world) {
    const ParticleView view = world.particles();
    std::vector<Fleck> all;
    const std::vector<vec4> at = world.device().readAll<vec4>(*view.foam, view.foamSlots);
    const std::vector<vec4> v = world.device().readAll<vec4>(*view.foamVelocity, view.foamSlots);
    for (size_t k = 0; k < view.foamSlots; ++k)
        if (at[k].w > 0) all.push_back({vec3(at[k]), vec3(v[k]), at[k].w, std::floor(v[k].w)});
    return all;
}

// Puts foam particles into a world by a saved state.
void put(FluidWorld& world, const std::vector<Fleck>& some) {
    WorldState saved, changed;
    world.save(saved);
    for (const auto& [name, bytes] : saved.sections()) {
        if (name != "foam.slots" && name != "foam.velocity") {
            changed.putBytes(name, bytes);
            continue;
        }
        std::vector<vec4> slots(bytes.size() / sizeof(vec4), vec4(0.0F));
        for (size_t k = 0; k < some.size(); ++k)
            slots[k] = name == "foam.slots" ? vec4(some[k].position, some[k].life) : vec4(some[k].velocity, 2.75F);
        changed.put<vec4>(name, slots);
    }
    const Status done = world.restore(changed);
    ASSERT_TRUE(done) << done.error().message;
}

TEST(Foam, CalmWaterMakesNone) {
    auto device = makeTestCpu();
    auto world = make(*device, boxOf(0.3F, false));
    for (int k = 0; k < 60; ++k) {
        world->step({}, kFrame);
        EXPECT_EQ(flecks(*world).size(), 0U) << k;
    }
    // Without the option there is no foam.
    EXPECT_EQ(make(*device, boxOf(0.3F, false, 0))->particles().foam, nullptr);
}

TEST(Foam, FallingWaterMakesFoamUpToItsLimit) {
    auto device = makeTestCpu();
    for (const int most : {4096, 300}) {
        auto world = make(*device, boxOf(0.1F, true, most));
        size_t largest = 0, sprayed = 0, lay = 0, under = 0;
        for (int k = 0; k < 90; ++k) {
            world->step({}, kFrame);
            const std::vector<Fleck> all = flecks(*world);
            largest = std::max(largest, all.size());
            for (const Fleck& f : all) {
                ASSERT_TRUE(isFinite(f.position) && isFinite(f.velocity));
                EXPECT_TRUE(glm::all(glm::greaterThanEqual(f.position, vec3(-0.06F))) &&
                            glm::all(glm::lessThanEqual(f.position, vec3(1.06F, 1.06F, 0.56F))));
                (f.kind == 1 ? sprayed : f.kind == 2 ? lay : under) += 1;
            }
        }
        EXPECT_GT(largest, 100U);
        EXPECT_LE(largest, static_cast<size_t>(most));
        EXPECT_GT(sprayed, 0U);
        EXPECT_GT(lay, 0U);
        EXPECT_GT(under, 0U);
        world->reset();
        EXPECT_EQ(flecks(*world).size(), 0U);
    }
}

// Spray flies on a parabola; the drag of a drop of 3 mm reduces its speed by one per cent.
TEST(Foam, SprayFlies) {
    auto device = makeTestCpu();
    auto world = make(*device, boxOf(0.1F, false));
    world->step({}, kFrame);
    put(*world, {{vec3(0.3F, 0.5F, 0.25F), vec3(1.0F, 1.0F, 0.0F), 2.0F, 0}});
    for (int k = 0; k < 12; ++k) world->step({}, kFrame);
    const std::vector<Fleck> all = flecks(*world);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].kind, 1.0F);
    EXPECT_EQ(all[0].life, 2.0F) << "in the air it does not age";
    const float t = 0.2F;
    EXPECT_NEAR(all[0].position.x, 0.3F + t, 0.02F * t);
    EXPECT_NEAR(all[0].position.y, 0.5F + t - 0.5F * 9.81F * t * t, 0.025F);
    EXPECT_NEAR(all[0].velocity.y, 1.0F - 9.81F * t, 0.05F);
}

TEST(Foam, ABubbleRisesAtTheSpeedOfBuoyancyAndDrag) {
    auto device = makeTestCpu();
    FluidParams p = boxOf(0.7F, false);
    p.foam.buoyancy = 1.0F;
    p.foam.drag = 30.0F;                          // 0.327 m/s
    p.foam.trappedAir = p.foam.waveCrest = 0.0F;  // deep water is not calm while it settles
    auto world = make(*device, p);
    for (int k = 0; k < 5; ++k) world->step({}, kFrame);
    put(*world, {{vec3(0.5F, 0.1F, 0.25F), vec3(0.0F), 2.0F, 0}});
    for (int k = 0; k < 30; ++k) world->step({}, kFrame);
    const float before = flecks(*world)[0].position.y;
    for (int k = 0; k < 30; ++k) world->step({}, kFrame);
    const std::vector<Fleck> all = flecks(*world);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].kind, 3.0F);
    EXPECT_NEAR((all[0].position.y - before) / 0.5F, 9.81F / 30.0F, 0.03F);
}

// Spray never enters the ball in its path, the sloping plane or the walls of the box.
TEST(Foam, SolidsStopSpray) {
    auto device = makeTestCpu();
    const vec3 middle(0.5F, 0.5F, 0.25F);
    const float radius = 0.12F;
    const test::Mesh ball = test::makeSphere(middle, radius);
    const MeshView view = ball.view();
    VoxelFieldOptions options;
    options.resolution = 64;
    options.band = 0.04F;
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), options);
    ASSERT_TRUE(field);
    Solids solids;
    solids.field = &*field;
    const vec3 slope = glm::normalize(vec3(-1.0F, 2.0F, 0.0F)), foot(0.8F, 0.2F, 0.0F);
    solids.planes = {{foot, slope, 0}};
    FluidParams p = boxOf(0.1F, false);
    p.foam.trappedAir = p.foam.waveCrest = 0.0F;
    auto world = make(*device, p, solids);
    world->step({}, kFrame);
    std::vector<Fleck> thrown;
    for (int k = 0; k < 200; ++k) {  // towards the ball from all sides except below, then to the plane and the walls
        const float a = 2.4F * static_cast<float>(k), y = static_cast<float>(k) / 200;
        const vec3 from = middle + 0.2F * vec3(std::cos(a) * std::sqrt(1 - y * y), y, std::sin(a) * std::sqrt(1 - y * y));
        thrown.push_back(
            {from, 3.0F * glm::normalize(middle + 0.05F * vec3(std::sin(3.0F * a), 0.0F, std::cos(5.0F * a)) - from), 2.0F, 0});
    }
    put(*world, thrown);
    for (int k = 0; k < 60; ++k) {
        world->step({}, kFrame);
        const std::vector<Fleck> all = flecks(*world);
        for (const Fleck& f : all) {
            ASSERT_GT(glm::distance(f.position, middle), 0.98F * radius) << k;
            ASSERT_GT(glm::dot(f.position - foot, slope), -1e-4F) << k;
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(f.position, vec3(-1e-5F))) &&
                        glm::all(glm::lessThanEqual(f.position, vec3(1.0F, 1.0F, 0.5F) + 1e-5F)))
                << k;
        }
        if (k == 5) EXPECT_EQ(all.size(), thrown.size());  // stopped, not removed
    }
}

// A box of 0.2 m sweeps through foam particles at rest, by far more than its own depth per frame and in many substeps: none is inside it or
// behind it, and those that it hits move at its speed.
TEST(Foam, AFastPaddleSweepsFoamAlong) {
    auto device = makeTestCpu();
    for (const float speed : {6.0F, 24.0F}) {
        const vec3 half(0.05F, 0.2F, 0.2F);
        const test::Mesh paddle = test::makeBox(-half, half);
        const MeshView view = paddle.view();
        const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 48, .band = 0.04F, .padding = 0.04F});
        ASSERT_TRUE(field);
        FluidParams p = boxOf(0.1F, false);
        p.box.max.x = 4.0F;
        p.gravity = vec3(0.0F);
        p.foam.trappedAir = p.foam.waveCrest = 0.0F;
        p.pbf.minSubsteps = 8;
        Pose pose{vec3(0.3F, 0.5F, 0.25F), quat(1, 0, 0, 0)};
        auto world = make(*device, p, {.rigid = {{&*field, pose}}});
        const auto step = [&] { world->step({.gravity = vec3(0.0F), .poses = std::span(&pose, 1)}, kFrame); };
        step();
        std::vector<Fleck> rest;
        for (int k = 0; k < 300; ++k)  // in its path, directly from its face on
            rest.push_back({vec3(0.38F + 0.004F * static_cast<float>(k), 0.5F + 0.1F * std::sin(static_cast<float>(k)),
                                 0.25F + 0.1F * std::cos(2.5F * static_cast<float>(k))),
                            vec3(0.0F), 2.0F, 0});
        put(*world, rest);
        while (pose.position.x < 1.8F) {
            pose.position.x += speed * static_cast<float>(kFrame);
            step();
            EXPECT_GT(world->lastSubsteps(), 4);
            const std::vector<Fleck> all = flecks(*world);
            ASSERT_EQ(all.size(), rest.size());
            for (const Fleck& f : all) {
                const vec3 own = pose.toOwn(f.position);
                ASSERT_GT(own.x, half.x) << speed << " m/s: in it or behind it";
                if (own.x < half.x + 0.01F) EXPECT_NEAR(f.velocity.x, speed, 0.1F * speed);
            }
        }
    }
}

// A block of water follows a wall that moves at the same speed. Foam from its edges is spawned where the wall was a moment ago, and stays
// on the water's side.
TEST(Foam, FoamSpawnedNearAMovingWallStaysOnItsSide) {
    auto device = makeTestCpu();
    const test::Mesh wall = test::makeSheet(vec3(0), vec3(1, 0, 0), 2.0F);
    const MeshView view = wall.view();
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 100, .band = 0.05F, .padding = 0.05F});
    ASSERT_TRUE(field);
    const float speed = 5.0F;
    FluidParams p = boxOf(0.1F, false);
    p.box.min.x = -3.0F;
    p.box.max = vec3(1.0F);
    p.gravity = vec3(0.0F);
    p.blocks = {{vec3(0.0F, 0.3F, 0.3F), vec3(0.3F, 0.7F, 0.7F), vec3(-speed, 0.0F, 0.0F)}};
    p.foam.most = 20000;
    p.foam.trappedAir = p.foam.waveCrest = 1000.0F;
    Pose pose{vec3(-0.02F, 0.5F, 0.5F), quat(1, 0, 0, 0)};
    auto world = make(*device, p, {.rigid = {{&*field, pose}}});
    size_t near = 0;
    for (int k = 0; k < 20; ++k) {
        const float was = pose.position.x;
        pose.position.x -= speed * static_cast<float>(kFrame);
        world->step({.gravity = vec3(0.0F), .poses = std::span(&pose, 1)}, kFrame);
        for (const Fleck& f : flecks(*world)) {
            ASSERT_GT(f.position.x, pose.position.x) << k;
            near += f.position.x < was ? 1 : 0;
        }
    }
    EXPECT_GT(near, 100U) << "where the wall has been";
}

// Spray that lands on a dry place disappears after some time.
TEST(Foam, SprayOnADryShelfAges) {
    auto device = makeTestCpu();
    const test::Mesh shelf = test::makeBox(vec3(0.3F, 0.4F, 0.1F), vec3(0.7F, 0.5F, 0.4F));
    const MeshView view = shelf.view();
    VoxelFieldOptions options;
    options.resolution = 32;
    options.band = 0.04F;
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), options);
    ASSERT_TRUE(field);
    Solids solids;
    solids.field = &*field;
    FluidParams p = boxOf(0.1F, false);
    p.foam.trappedAir = p.foam.waveCrest = 0.0F;
    auto world = make(*device, p, solids);
    world->step({}, kFrame);
    put(*world, {{vec3(0.5F, 0.6F, 0.25F), vec3(0.0F), 0.5F, 0}});
    for (int k = 0; k < 15; ++k) world->step({}, kFrame);
    ASSERT_EQ(flecks(*world).size(), 1U);
    EXPECT_GT(flecks(*world)[0].position.y, 0.49F);
    for (int k = 0; k < 60; ++k) world->step({}, kFrame);
    EXPECT_EQ(flecks(*world).size(), 0U);
}

// Foam on calm water rests, and disappears at the end of its life.
TEST(Foam, OnCalmWaterFoamRestsAndAges) {
    auto device = makeTestCpu();
    auto world = make(*device, boxOf(0.3F, false));
    for (int k = 0; k < 30; ++k) world->step({}, kFrame);
    put(*world, {{vec3(0.5F, 0.3F, 0.25F), vec3(0.0F), 0.5F, 0}});
    for (int k = 0; k < 24; ++k) world->step({}, kFrame);
    std::vector<Fleck> all = flecks(*world);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].kind, 2.0F);
    EXPECT_LT(glm::distance(all[0].position, vec3(0.5F, 0.3F, 0.25F)), 0.03F);
    EXPECT_NEAR(all[0].life, 0.1F, 0.02F);
    for (int k = 0; k < 9; ++k) world->step({}, kFrame);
    EXPECT_EQ(flecks(*world).size(), 0U);
}

// Number and positions of new foam do not depend on threads; a saved world continues with its foam.
TEST(Foam, RunsAreReproducible) {
    auto device = makeTestCpu();
    const auto sorted = [](FluidWorld& world) {
        std::vector<std::array<float, 4>> all;
        for (const Fleck& f : flecks(world)) all.push_back({f.position.x, f.position.y, f.position.z, f.life});
        std::sort(all.begin(), all.end());
        return all;
    };
    auto a = make(*device, boxOf(0.1F, true)), b = make(*device, boxOf(0.1F, true)), c = make(*device, boxOf(0.1F, true));
    for (int k = 0; k < 40; ++k) {
        a->step({}, kFrame);
        b->step({}, kFrame);
    }
    EXPECT_GT(sorted(*a).size(), 50U);
    EXPECT_EQ(sorted(*a), sorted(*b));
    WorldState state;
    a->save(state);
    const Status restored = c->restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
    for (int k = 0; k < 10; ++k) {
        a->step({}, kFrame);
        c->step({}, kFrame);
    }
    EXPECT_EQ(sorted(*a), sorted(*c));
}

// Four pictures a step: between steps a foam particle that flies beside the water is drawn at the water's position.
TEST(Foam, BetweenFixedStepsFoamIsDrawnBesideItsWater) {
    auto device = makeTestCpu();
    const float speed = 1.5F;
    FluidParams p = boxOf(0.1F, false);
    p.box.max.x = 4.0F;
    p.gravity = vec3(0.0F);
    p.foam.trappedAir = p.foam.waveCrest = 0.0F;
    p.fixedStep = 0.02F;
    const vec3 low(0.2F, 0.4F, 0.2F);
    p.blocks = {{low, low + p.spacing, vec3(speed, 0.0F, 0.0F)}};  // one particle
    auto world = make(*device, p);
    ASSERT_EQ(world->particles().count, 1U);
    put(*world, {{low + 0.5F * p.spacing + vec3(0.0F, 0.2F, 0.0F), vec3(speed, 0.0F, 0.0F), 2.0F, 0}});
    vec3 last(0.0F);
    for (int k = 0; k < 40; ++k) {
        world->step({.gravity = vec3(0.0F)}, 0.005);
        if (k < 8) continue;
        const ParticleView view = world->particles();
        const vec3 water(device->readAll<vec4>(*view.drawn, 1)[0]), fleck(device->readAll<vec4>(*view.foamDrawn, 1)[0]);
        EXPECT_NEAR(fleck.x, water.x, 0.02F) << k;  // the air slows it by a per cent or so
        if (k > 8) EXPECT_NEAR(fleck.x - last.x, 0.005F * speed, 0.0005F) << k;
        last = fleck;
    }
}

// A state with another number of slots, or with damaged slots, is refused with a message; the world continues unchanged.
TEST(Foam, AStateOfOtherSlotsIsRefusedAndNothingIsLost) {
    auto device = makeTestCpu();
    auto other = make(*device, boxOf(0.1F, true, 300)), world = make(*device, boxOf(0.1F, true));
    for (int k = 0; k < 20; ++k) {
        other->step({}, kFrame);
        world->step({}, kFrame);
    }
    WorldState few, before;
    other->save(few);
    world->save(before);
    const Status refused = world->restore(few);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("foam.most = 300"), std::string::npos) << refused.error().message;
    for (const char* damaged : {"foam.slots", "foam.velocity", "foam.numbers"}) {
        WorldState shorter;
        for (const auto& [name, bytes] : before.sections()) {
            WorldState::Bytes some = bytes;
            if (name == damaged) some.resize(some.size() - sizeof(uint32_t));
            shorter.putBytes(name, std::move(some));
        }
        const Status no = world->restore(shorter);
        ASSERT_FALSE(no) << damaged;
        EXPECT_NE(no.error().message.find(damaged), std::string::npos) << no.error().message;
    }
    WorldState after;
    world->save(after);
    EXPECT_EQ(before.sections(), after.sections());
    EXPECT_GT(flecks(*world).size(), 10U);
}

}  // namespace
}  // namespace rivulet::foam_test
