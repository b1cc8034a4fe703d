// A saved state with any number in any section: it is refused with a sentence that names the section, and nothing changes; or the world
// that continues from it steps on and loses no particle.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "fluid/session/session.h"
#include "tests/physics/worlds.h"

namespace rivulet::state_values_test {
namespace {

using Sections = std::map<std::string, WorldState::Bytes>;

WorldState stateOf(const Sections& sections) {
    WorldState state;
    for (const auto& [name, bytes] : sections) state.putBytes(name, bytes);
    return state;
}

// What is written at a place, as four or eight bytes.
std::vector<std::vector<std::byte>> hostile() {
    std::vector<std::vector<std::byte>> all;
    const auto add = [&](const auto& value) {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        all.emplace_back(bytes.begin(), bytes.end());
    };
    for (const float value : {NAN, INFINITY, -INFINITY, 1.0e30F, -1.0F}) {
        add(value);
        add(static_cast<double>(value));
    }
    add(uint32_t{0xffffffff});
    add(uint64_t{0xffffffffffffffff});
    return all;
}

// A world, or a session, by what a state needs of it.
struct Subject {
    std::function<Sections()> save;
    std::function<Status(WorldState&)> restore;
    std::function<const FluidWorld&()> world;
    std::function<void()> step;
};

// Returns how many of the forged states were refused, of how many.
std::pair<int, int> forgeAll(const Subject& subject) {
    const Sections good = subject.save();
    int refused = 0, all = 0;
    const auto tryOut = [&](const std::string& name, const WorldState::Bytes& bytes, const std::string& what) {
        ++all;
        Sections forged = good;
        forged[name] = bytes;
        WorldState state = stateOf(forged);
        const Sections before = subject.save();
        const Status done = subject.restore(state);
        if (!done) {
            ++refused;
            const std::string& sentence = done.error().message;
            EXPECT_EQ(done.error().fault, Fault::badInput) << sentence;
            // Texts name the parameter, counts what there is another number of.
            const bool named = name.ends_with(".params") || name == "sources.numbers" || name == "solids.numbers";
            EXPECT_TRUE(named || sentence.find(name.substr(0, name.find('.'))) != std::string::npos)
                << name << ", " << what << ": " << sentence;
            EXPECT_TRUE(subject.save() == before) << name << ", " << what << ": a refused state changes nothing";
            return;
        }
        for (int frame = 0; frame < 2; ++frame) subject.step();
        const FluidWorld& world = subject.world();
        EXPECT_TRUE(world.lastStep()) << name << ", " << what;
        EXPECT_EQ(world.stats().lost + world.stats().nan, 0U) << name << ", " << what;
        EXPECT_TRUE(std::isfinite(world.stats().kinetic) && std::isfinite(world.time())) << name << ", " << what;
    };
    for (const auto& [name, bytes] : good) {
        if (bytes.empty()) continue;
        for (const std::vector<std::byte>& value : hostile()) {
            if (value.size() > bytes.size()) continue;
            const size_t last = (bytes.size() - value.size()) / value.size() * value.size();
            for (const size_t at : {size_t{0}, last / 2 / value.size() * value.size(), last}) {
                WorldState::Bytes forged = bytes;
                std::memcpy(forged.data() + at, value.data(), value.size());
                if (forged != bytes) tryOut(name, forged, fmt::format("byte {} of {}, {} bytes", at, bytes.size(), value.size()));
            }
        }
        for (const size_t cut : {size_t{1}, bytes.size() / 2, bytes.size()}) {
            if (name == "world.limited") continue;  // any text will do
            WorldState::Bytes shorter(bytes.begin(), bytes.end() - static_cast<std::ptrdiff_t>(std::max<size_t>(cut, 1)));
            tryOut(name, shorter, fmt::format("{} bytes less", cut));
        }
    }
    WorldState state = stateOf(good);
    EXPECT_TRUE(subject.restore(state)) << "what was saved is valid";
    EXPECT_TRUE(subject.save() == good);
    return {refused, all};
}

SceneFile scene(const std::string& method) {
    SceneFile s;
    s.name = "forged";
    s.fluid.method = method;
    s.fluid.spacing = 0.05F;
    s.fluid.maxSubsteps = 12;
    s.fluid.maxParticles = 500;
    s.fluid.foam.most = 60;
    s.fluid.box.max = vec3(0.6F, 0.6F, 0.4F);
    s.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.3F, 0.4F), .dye = vec3(1.0F, 0.2F, 0.1F)}};
    s.bodies = {BodyParams{}};
    s.bodies[0].size = vec3(0.1F);
    s.bodies[0].position = vec3(0.45F, 0.3F, 0.2F);
    ColliderParams paddle;
    paddle.mesh = "meshes/paddle_wheel.obj";
    paddle.fitSize = 0.2F;
    paddle.resolution = 12;
    paddle.position = vec3(0.3F, 0.2F, 0.2F);
    paddle.motion.spin = 200;
    s.colliders = {paddle};
    EmitterParams emitter;
    emitter.litresPerSecond = 5;
    emitter.position = vec3(0.45F, 0.5F, 0.2F);
    emitter.liquid = "oil";
    s.emitters = {emitter};
    SinkParams sink;
    sink.position = vec3(0.5F, 0.05F, 0.3F);
    s.sinks = {sink};
    return s;
}

class ForgedStates : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, ForgedStates, testing::Values("wcsph", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

TEST_P(ForgedStates, OfAScene) {
    auto device = cpu();
    auto made = Session::create(scene(GetParam()), *device, {});
    ASSERT_TRUE(made) << made.error().message;
    Session& session = **made;
    ASSERT_TRUE(session.world().setVolumes(std::vector<Volume>{{.id = 3, .position = vec3(0.1F), .size = vec3(0.2F)}}));
    for (int k = 0; k < 5; ++k) session.step(1.0 / 60, true);
    const Subject subject{.save =
                              [&] {
                                  WorldState state;
                                  session.save(state);
                                  return state.sections();
                              },
                          .restore = [&](WorldState& state) { return session.restore(state); },
                          .world = [&]() -> const FluidWorld& { return session.world(); },
                          .step = [&] { session.step(1.0 / 60, true); }};
    EXPECT_GE(subject.save().size(), 27U) << "sections of particles, sources, solids, bodies, foam and volumes";
    const auto [refused, all] = forgeAll(subject);
    EXPECT_GT(refused, all / 2) << all;
}

Subject subjectOf(FluidWorld& world) {
    return {.save =
                [&world] {
                    WorldState state;
                    world.save(state);
                    return state.sections();
                },
            .restore = [&world](WorldState& state) { return world.restore(state); },
            .world = [&world]() -> const FluidWorld& { return world; },
            .step = [&world] { world.step({}, 1.0 / 60); }};
}

// Sleeping water, drawn as ellipsoids between fixed steps.
TEST_P(ForgedStates, OfSleepingWater) {
    FluidParams p;
    p.method = GetParam();
    p.spacing = 0.05F;
    p.maxSubsteps = 12;
    p.sleep.on = true;
    p.ellipsoids = true;
    p.box.max = vec3(0.4F);
    p.blocks = {{.max = vec3(0.4F, 0.2F, 0.4F), .jitter = 0}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    for (int k = 0; k < 400 && world->stats().asleep < world->stats().particles / 2; ++k) world->step({}, 1.0 / 60);
    EXPECT_GT(world->stats().asleep, 0U);
    const Subject subject = subjectOf(*world);
    EXPECT_TRUE(subject.save().contains("sleep.ellipsoids2"));
    const auto [refused, all] = forgeAll(subject);
    EXPECT_GT(refused, all / 2) << all;
}

// Water that a host deposits and takes.
TEST_P(ForgedStates, OfDeposits) {
    FluidParams p;
    p.method = GetParam();
    p.spacing = 0.05F;
    p.maxSubsteps = 12;
    p.blocks = {{.max = vec3(0.3F)}};
    auto device = cpu();
    auto made = FluidWorld::create(*device, p, {}, {}, {.expectedDeposit = 0.01});
    ASSERT_TRUE(made);
    FluidWorld& world = **made;
    for (int k = 0; k < 6; ++k) {
        world.deposit(vec3(0.6F, 0.3F, 0.6F), vec3(0.0F), 3.0e-4);
        world.step({}, 1.0 / 60);
    }
    const Subject subject = subjectOf(world);
    EXPECT_TRUE(subject.save().contains("sources.poured") && subject.save().contains("world.taken"));
    const auto [refused, all] = forgeAll(subject);
    EXPECT_GT(refused, all / 2) << all;
}

// A lost particle is part of a state: the state names it, and continues with it. Without its name it is refused.
TEST(SavedParticles, WhatIsLostIsNamed) {
    FluidParams p;
    p.spacing = 0.05F;
    p.blocks = {{.min = vec3(0.2F), .max = vec3(0.5F)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    world->step({}, 1.0 / 60);
    WorldState whole;
    world->save(whole);
    EXPECT_FALSE(whole.sections().contains("particles.lost"));
    Sections spoiled = whole.sections();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(spoiled["particles.position"].data() + 5 * sizeof(vec4), &nan, sizeof nan);
    WorldState unnamed = stateOf(spoiled);
    const Status refused = world->restore(unnamed);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("particles.position"), std::string::npos) << refused.error().message;
    uint32_t id = 0;
    std::memcpy(&id, spoiled["particles.id"].data() + 5 * sizeof id, sizeof id);
    const auto bytes = std::as_bytes(std::span(&id, 1));
    spoiled["particles.lost"].assign(bytes.begin(), bytes.end());
    WorldState named = stateOf(spoiled);
    const Status restored = world->restore(named);
    ASSERT_TRUE(restored) << restored.error().message;
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->stats().lost, 1U);
    WorldState again;
    world->save(again);
    EXPECT_EQ(again.sections().at("particles.lost"), spoiled["particles.lost"]);
    EXPECT_TRUE(world->restore(again));
}

}  // namespace
}  // namespace rivulet::state_values_test
