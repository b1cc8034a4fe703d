// A world continues from another one after solids have moved: particles are removed only where a solid now is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fluid/session/session.h"
#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::go_on_test {
namespace {

// A column of water beside a ball on the floor.
SceneFile scene() {
    SceneFile s;
    s.name = "go_on";
    s.fluid.spacing = 0.04F;
    s.fluid.box.max = vec3(1.0F, 0.8F, 0.6F);
    s.fluid.blocks = {{vec3(0.0F), vec3(0.4F, 0.6F, 0.6F), vec3(0.0F)}};
    ColliderParams ball;
    ball.mesh = "meshes/sphere.obj";
    ball.fitSize = 0.2F;
    ball.resolution = 20;
    ball.position = vec3(0.8F, 0.1F, 0.3F);
    s.colliders = {ball};
    return s;
}

std::unique_ptr<Session> open(Device& device, const SceneFile& scene, const Log& log = {}) {
    auto session = Session::create(scene, device, log);
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}

void run(Session& session, int frames) {
    for (int k = 0; k < frames; ++k) session.step(1.0 / 60, true);
}

TEST(GoOn, OnlyParticlesInTheMovedBallAreRemoved) {
    auto device = cpu();
    SceneFile before = scene();
    auto one = open(*device, before);
    run(*one, 20);
    SceneFile after = before;
    after.colliders[0].position = vec3(0.2F, 0.15F, 0.3F);
    after.room = one->world().particles().count;
    std::vector<std::string> said;
    auto two = open(*device, after, Log{[&](LogLevel, std::string_view text) { said.emplace_back(text); }});
    ASSERT_TRUE(two->continueFrom(*one));
    EXPECT_EQ(two->time(), one->time());
    const HostParticles had = readParticles(one->world()), has = readParticles(two->world());
    // The ball is closed: all particles outside it and its voxels remain, with the same position and velocity.
    size_t inside = 0, same = 0;
    std::map<std::array<float, 3>, vec3> there;
    for (size_t k = 0; k < has.position.size(); ++k)
        there[{has.position[k].x, has.position[k].y, has.position[k].z}] = vec3(has.velocity[k]);
    for (size_t k = 0; k < had.position.size(); ++k) {
        const vec3 p(had.position[k]);
        const float off = glm::distance(p, after.colliders[0].position) - 0.1F;
        const auto found = there.find({p.x, p.y, p.z});
        if (off < -0.001F) ++inside;
        if (off < -0.001F) EXPECT_EQ(found, there.end());
        if (off > 0.0175F) {  // a voxel's diagonal
            ASSERT_NE(found, there.end()) << off;
            EXPECT_EQ(found->second, vec3(had.velocity[k]));
            ++same;
        }
    }
    EXPECT_GT(inside, 20U);
    EXPECT_GT(same, 1000U);
    const double volume = std::pow(0.04, 3);
    EXPECT_NEAR(two->world().stats().emitted / volume, static_cast<double>(has.position.size()), 0.01);
    EXPECT_FALSE(said.empty()) << "how many were taken away";

    run(*two, 30);
    const HostParticles later = readParticles(two->world());
    EXPECT_EQ(later.position.size(), has.position.size());
    for (const vec4& p : later.position)
        EXPECT_GT(glm::distance(vec3(p), after.colliders[0].position), 0.115F) << "half a spacing off the ball, but for a quarter";
    EXPECT_LT(two->world().stats().maxCompression, 0.3);
    EXPECT_NEAR(two->world().stats().emitted / volume, static_cast<double>(has.position.size()), 0.01);
    two->reset();
    EXPECT_EQ(two->time(), 0);
    run(*two, 1);
    EXPECT_EQ(two->world().stats().particles, open(*device, after)->world().stats().particles) << "the scene's own beginning";
}

// A state that is saved after it can be resumed by another session.
TEST(GoOn, FoamStaysOnTheWater) {
    auto device = cpu();
    SceneFile before = scene();
    before.fluid.foam.most = 2000;
    before.fluid.foam.speedFrom = 0.2F;
    before.fluid.foam.speedTo = 1;
    before.fluid.foam.airFrom = 0.5F;
    before.fluid.foam.airTo = 2;
    auto one = open(*device, before);
    run(*one, 40);
    const auto flecks = [&](Session& session) {
        device->finish();
        const ParticleView view = session.world().particles();
        std::vector<vec4> alive;
        for (const vec4& fleck : device->readAll<vec4>(*view.foam, view.foamSlots))
            if (fleck.w > 0) alive.push_back(fleck);
        return alive;
    };
    const std::vector<vec4> had = flecks(*one);
    ASSERT_GT(had.size(), 20U);
    SceneFile after = before;
    after.colliders[0].position = vec3(0.6F, 0.15F, 0.3F);
    after.room = one->world().particles().count;
    auto two = open(*device, after);
    ASSERT_TRUE(two->continueFrom(*one));
    EXPECT_EQ(flecks(*two), had);
    run(*two, 1);
    EXPECT_GT(flecks(*two).size(), had.size() / 2) << "they live on";

    after.fluid.foam.most = 1000;
    auto three = open(*device, after);
    ASSERT_TRUE(three->continueFrom(*one));
    EXPECT_TRUE(flecks(*three).empty()) << "another number of them begins anew";
}

TEST(GoOn, ASavedStateBringsItsNumberOfSlots) {
    auto device = cpu();
    SceneFile inTheWater = scene();
    inTheWater.colliders[0].position = vec3(0.2F, 0.15F, 0.3F);
    auto one = open(*device, scene());
    run(*one, 5);
    SceneFile after = inTheWater;
    after.room = one->world().particles().count;
    auto two = open(*device, after);
    ASSERT_TRUE(two->continueFrom(*one));
    run(*two, 3);
    auto three = open(*device, inTheWater);
    ASSERT_LT(three->world().particles().count, two->world().particles().count) << "this is what is tested";
    WorldState state;
    two->save(state);
    const Status resumed = three->restore(state);
    ASSERT_TRUE(resumed) << resumed.error().message;
    {  // Other errors leave a session and its number of slots unchanged.
        auto four = open(*device, inTheWater);
        run(*four, 2);
        const HostParticles was = readParticles(four->world());
        WorldState less, sound;
        two->save(sound);
        for (const auto& [name, bytes] : sound.sections())
            if (name != "world.numbers") less.putBytes(name, bytes);
        ASSERT_FALSE(four->restore(less));
        EXPECT_EQ(readParticles(four->world()).position, was.position);
        EXPECT_EQ(four->world().particles().count, open(*device, inTheWater)->world().particles().count);
        EXPECT_NEAR(four->time(), 2.0 / 60, 1.0e-9);
    }
    run(*two, 5);
    run(*three, 5);
    EXPECT_EQ(readParticles(two->world()).position, readParticles(three->world()).position);
    EXPECT_EQ(two->world().stats().emitted, three->world().stats().emitted);
}

// Dyes and liquids stay with their particles, emitters continue at the current time, and a wheel keeps its angle.
TEST(GoOn, KeepsMatterTimeAndPoses) {
    auto device = cpu();
    SceneFile before = scene();
    before.fluid.blocks[0].liquid = "honey";
    before.fluid.blocks.push_back({vec3(0.4F, 0, 0), vec3(0.6F, 0.4F, 0.6F), vec3(0.0F)});
    before.emitters.push_back({.litresPerSecond = 2, .position = vec3(0.7F, 0.6F, 0.3F), .radius = 0.06F, .stop = 0.2F});
    ColliderParams wheel;
    wheel.mesh = "meshes/paddle_wheel.obj";
    wheel.fitSize = 0.2F;
    wheel.resolution = 16;
    wheel.position = vec3(0.5F, 0.6F, 0.3F);
    wheel.motion.spin = 90;
    before.colliders.push_back(wheel);
    auto one = open(*device, before);
    run(*one, 15);
    const auto honey = [](Session& s) {
        const ParticleView view = s.world().particles();
        const auto matter = s.world().device().readAll<vec4>(*view.matterOf, view.slots);
        const HostParticles p = readParticles(s.world());
        return std::count_if(p.id.begin(), p.id.end(), [&](uint32_t id) { return matter[id].w > 0; });
    };
    SceneFile after = before;
    after.room = one->world().particles().count;
    after.colliders[0].position.x = 0.9F;
    auto two = open(*device, after);
    ASSERT_TRUE(two->continueFrom(*one));
    EXPECT_EQ(honey(*one), honey(*two));
    EXPECT_GT(honey(*two), 100);
    EXPECT_NEAR(glm::dot(two->world().poses()[0].rotation, one->world().poses()[0].rotation), 1, 1.0e-5);
    const double there = two->world().stats().emitted;
    run(*two, 20);
    // The emitter stops at 0.25 s.
    EXPECT_NEAR(two->world().stats().emitted, there, 2 * std::pow(0.04, 3)) << "0.05 s too late it would have let out nothing";
}

// An edit that moves no solid removes no water, even next to a solid.
TEST(GoOn, WithoutMovedSolidsNothingIsRemoved) {
    auto device = cpu();
    SceneFile before = scene();
    before.colliders[0].position = vec3(0.5F, 0.1F, 0.3F);
    auto one = open(*device, before);
    run(*one, 40);
    SceneFile after = before;
    after.sinks.push_back({.position = vec3(5)});
    after.room = one->world().particles().count;
    auto two = open(*device, after);
    ASSERT_TRUE(two->continueFrom(*one));
    EXPECT_EQ(readParticles(two->world()).position.size(), readParticles(one->world()).position.size());
}

TEST(GoOn, AnotherSpacingStartsFromTheBeginning) {
    auto device = cpu();
    auto one = open(*device, scene());
    run(*one, 5);
    SceneFile finer = scene();
    finer.fluid.spacing = 0.05F;
    EXPECT_FALSE(Session::sameWater(scene(), finer));
    auto two = open(*device, finer);
    const Status gone = two->continueFrom(*one);
    ASSERT_FALSE(gone);
    EXPECT_EQ(two->time(), 0);
    EXPECT_GT(two->world().stats().particles, 0U);
}

}  // namespace
}  // namespace rivulet::go_on_test
