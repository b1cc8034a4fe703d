// Emitters and sinks: emitted and drained volumes are exact, the flow stays stable, and volume is conserved.
#include "fluid/sim/sources/emitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::emitter_test {
namespace {

constexpr double kFrame = 1.0 / 60;

FluidParams boxWorld(float spacing, const char* method = "pbf") {
    FluidParams p;
    p.method = method;
    p.spacing = spacing;
    return p;
}

Emitter nozzle(float litresPerSecond, float speed, float radius, vec3 position = vec3(0.5F, 0.8F, 0.5F), vec3 direction = vec3(0, -1, 0)) {
    Emitter e;
    e.params.litresPerSecond = litresPerSecond;
    e.params.speed = speed;
    e.params.radius = radius;
    e.params.position = position;
    e.params.direction = direction;
    return e;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& params, const Sources& sources, const Solids& solids = {}) {
    auto world = FluidWorld::create(device, params, solids, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

void run(FluidWorld& world, double seconds, vec3 gravity = vec3(0, -9.81F, 0)) {
    const int frames = static_cast<int>(std::lround(seconds / kFrame));
    for (int k = 0; k < frames; ++k) world.step({.gravity = gravity}, kFrame);
}

struct Found {
    std::vector<vec3> position, velocity;
    std::vector<uint32_t> id;
    float fastest = 0;
};
Found found(const FluidWorld& world) {
    const ParticleView view = world.particles();
    Device& device = world.device();
    const auto x = device.readAll<vec4>(*view.position, view.count), v = device.readAll<vec4>(*view.velocity, view.count);
    const auto id = device.readAll<uint32_t>(*view.id, view.count);
    Found f;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        f.position.emplace_back(x[i]);
        f.velocity.emplace_back(v[i]);
        f.id.push_back(id[i]);
        f.fastest = std::max(f.fastest, glm::length(vec3(v[i])));
    }
    return f;
}

// Independent count: visible particles against litres per second times seconds.
TEST(Emitter, LitresASecondAreExactToAParticle) {
    for (const char* shape : {"nozzle", "box", "mesh"}) {
        auto device = makeTestCpu();
        Emitter e = nozzle(0.9F, 0.0F, 0.06F);
        e.params.shape = shape;
        e.params.size = vec3(0.3F, 0.1F, 0.3F);
        if (e.params.shape != "nozzle") e.params.speed = 0.6F;
        e.triangles = {vec3(0.3F, 0.8F, 0.3F), vec3(0.7F, 0.8F, 0.3F), vec3(0.3F, 0.8F, 0.7F)};
        auto world = make(*device, boxWorld(0.02F), {.emitters = {e}, .seconds = 3});
        run(*world, 2.0);
        const double due = 0.9e-3 * 2.0 / 8.0e-6;
        const Found f = found(*world);
        EXPECT_NEAR(static_cast<double>(f.position.size()), due, 1.0) << shape;
        EXPECT_EQ(std::set<uint32_t>(f.id.begin(), f.id.end()).size(), f.id.size()) << shape;
        EXPECT_NEAR(world->stats().emitted, due * 8.0e-6, 8.0e-6) << shape;
        EXPECT_EQ(world->stats().lost, 0U) << shape;
        EXPECT_EQ(world->stats().particles, f.position.size()) << shape;
    }
}

// A nozzle that was blocked emits its pending volume faster: the choice of the time step includes that speed.
TEST(Emitter, NoParticleIsFasterThanItsEmitter) {
    EmitterFeed feed(nozzle(0.5F, 0.0F, 0.05F), 0, 0.02F);
    std::vector<Candidate> out;
    float fastest = 0;
    const auto offer = [&](int k) {
        out.clear();
        feed.offer(k * kFrame, kFrame, vec3(0.0F), 1000, out);
        for (const Candidate& c : out) fastest = std::max(fastest, glm::length(vec3(c.velocity)));
        return out.size();
    };
    for (int k = 0; k < 30; ++k) feed.refuse(offer(k));
    const float regular = fastest;
    for (int k = 30; k < 60; ++k) offer(k);
    EXPECT_NEAR(fastest, 1.1F * 0.5e-3F / (kPi * 0.05F * 0.05F), 1.0e-4F);
    EXPECT_GE(fastest, regular);
    EXPECT_LE(fastest, feed.fastest());
}

TEST(Emitter, StartsAndStopsAtItsTimes) {
    auto device = makeTestCpu();
    Emitter e = nozzle(1.2F, 0.0F, 0.05F);
    e.params.start = 0.25F;
    e.params.stop = 0.75F;
    auto world = make(*device, boxWorld(0.02F), {.emitters = {e}});
    run(*world, 0.2);
    EXPECT_EQ(found(*world).position.size(), 0U);
    run(*world, 0.8);
    EXPECT_NEAR(static_cast<double>(found(*world).position.size()), 0.6e-3 / 8.0e-6, 1.0);
}

// Before forces act, a jet is filled with water at rest density, and no two particles are nearer than at rest.
TEST(Emitter, AJetIsContinuousAndAtRestDensity) {
    for (const float speed : {0.7F, 2.0F, 5.0F}) {
        auto device = makeTestCpu();
        const float s = 0.01F, rate = 2.0F;
        FluidParams p = boxWorld(s);
        p.box.max = vec3(2.0F, 1.0F, 1.0F);
        auto world = make(*device, p, {.emitters = {nozzle(rate, speed, 0.06F, vec3(0.05F, 0.5F, 0.5F), vec3(1, 0, 0))}, .seconds = 1});
        const int frames = static_cast<int>(std::min(1.8 / static_cast<double>(speed), 0.4) / kFrame);
        for (int k = 0; k < frames; ++k) world->step({.gravity = vec3(0.0F)}, kFrame);
        const Found f = found(*world);
        ASSERT_GT(f.position.size(), 300U);
        float nearest = 1, first = 1e9F, last = 0;
        for (size_t i = 0; i < f.position.size(); ++i) {
            first = std::min(first, f.position[i].x);
            last = std::max(last, f.position[i].x);
            for (size_t j = 0; j < i; ++j) nearest = std::min(nearest, glm::length(f.position[i] - f.position[j]));
        }
        EXPECT_GT(nearest, 0.8F * s) << speed;
        EXPECT_LT(f.fastest, 1.15F * speed) << speed;
        // Along the jet, the number of particles per length follows from rate and speed, without gaps or clusters.
        const double perMetre = 1.0e-3 * static_cast<double>(rate) / static_cast<double>(speed) / 1.0e-6;
        const int slabs = 6;
        const float from = first + 2 * s, length = (last - 4 * s - from) / slabs;
        for (int k = 0; k < slabs; ++k) {
            int held = 0;
            for (const vec3& x : f.position)
                held += x.x >= from + static_cast<float>(k) * length && x.x < from + static_cast<float>(k + 1) * length ? 1 : 0;
            EXPECT_NEAR(held / (perMetre * static_cast<double>(length)), 1.0, 0.25) << speed << " slab " << k;
        }
    }
}

TEST(Emitter, ALimitIsKeptAndReportedAndSinksFreeItsSlots) {
    auto device = makeTestCpu();
    FluidParams p = boxWorld(0.02F);
    p.maxParticles = 200;
    SinkParams sink;
    sink.position = vec3(0.5F, 0.0F, 0.5F);
    sink.size = vec3(1.0F, 0.3F, 1.0F);
    Sources none{.emitters = {nozzle(2.0F, 0.0F, 0.06F)}}, both = none;
    both.sinks = {sink};
    auto world = make(*device, p, none);
    run(*world, 1.0);
    EXPECT_EQ(found(*world).position.size(), 200U);
    ASSERT_EQ(world->stats().limited.size(), 1U);
    EXPECT_NE(world->stats().limited[0].find("200"), std::string::npos);
    EXPECT_NEAR(world->stats().backlog, 2.0e-3 - 200 * 8.0e-6, 2 * 8.0e-6);
    // With a sink the slots are reused.
    world = make(*device, p, both);
    run(*world, 3.0);
    const FluidStats& s = world->stats();
    const size_t there = found(*world).position.size();
    EXPECT_LE(there, 200U);
    EXPECT_GT(s.emitted, 3 * 200 * 8.0e-6);
    EXPECT_EQ(s.lost, 0U);
    EXPECT_LT(std::abs(s.emitted - s.drained - static_cast<double>(there) * 8.0e-6) / s.emitted, 1.0e-5);
}

TEST(Emitter, SinksRemoveParticlesInsideAndVolumesBalance) {
    auto device = makeTestCpu();
    FluidParams p = boxWorld(0.025F);
    p.blocks = {{vec3(0.0F), vec3(1.0F, 0.2F, 1.0F)}};
    SinkParams box, ball;
    box.position = vec3(0.1F, 0.1F, 0.5F);
    box.size = vec3(0.2F, 0.2F, 0.2F);
    ball.shape = "sphere";
    ball.position = vec3(0.8F, 0.1F, 0.5F);
    ball.radius = 0.12F;
    auto world = make(*device, p, {.emitters = {nozzle(1.5F, 2.0F, 0.05F)}, .sinks = {box, ball}});
    for (int k = 0; k < 5; ++k) {
        run(*world, 0.2);
        const Found f = found(*world);
        const double volume = std::pow(0.025, 3);
        const FluidStats& s = world->stats();
        EXPECT_LT(std::abs(s.emitted - s.drained - static_cast<double>(f.position.size()) * volume) / s.emitted, 1.0e-5);
        EXPECT_GT(s.drained, 0.0);
        for (const vec3& x : f.position) {
            EXPECT_FALSE(glm::all(glm::lessThan(glm::abs(x - box.position), 0.499F * box.size)));
            EXPECT_GT(glm::length(x - ball.position), 0.999F * ball.radius);
        }
    }
    // The same after a reset.
    world->reset();
    EXPECT_EQ(found(*world).position.size(), 40U * 8U * 40U);
    EXPECT_EQ(world->stats().drained, 0.0);
}

// A nozzle inside a solid emits nothing; if half of it is inside, only the outer half emits.
TEST(Emitter, NoParticleIsSpawnedInASolid) {
    const test::Mesh ball = test::makeSphere(vec3(0.0F), 0.2F);
    const MeshView view = ball.view();
    Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 64, .band = 0.08F, .padding = 0.08F});
    ASSERT_TRUE(field) << field.error().message;
    FluidParams p = boxWorld(0.02F);
    p.box.min = vec3(-0.5F);
    p.box.max = vec3(0.5F);
    auto device = makeTestCpu();
    auto world = make(*device, p, {.emitters = {nozzle(1.0F, 0.5F, 0.08F, vec3(0.0F))}}, {.field = &*field});
    run(*world, 0.5);
    EXPECT_EQ(found(*world).position.size(), 0U);
    EXPECT_NEAR(world->stats().backlog, 0.5e-3, 8.0e-6) << "it is still due";
    world = make(*device, p, {.emitters = {nozzle(1.0F, 0.5F, 0.08F, vec3(0.2F, 0.0F, 0.0F))}}, {.field = &*field});
    run(*world, 0.5);
    const Found f = found(*world);
    EXPECT_GT(f.position.size(), 15U);
    for (const vec3& x : f.position) EXPECT_GT(glm::length(x), 0.2F);
    EXPECT_LT(f.fastest, 0.5F + 9.81F * 0.5F);
    EXPECT_EQ(world->stats().lost, 0U);
}

// The same for a body at its current position.
TEST(Emitter, NoParticleIsSpawnedInABody) {
    FluidParams p = boxWorld(0.02F);
    p.box.min = vec3(-0.5F);
    p.box.max = vec3(0.5F);
    Body ball;
    ball.shape = sphereShape(0.2F, 1000, p.spacing);
    ball.shape.mass = 0;
    auto device = makeTestCpu();
    auto world = make(*device, p, {.emitters = {nozzle(1.0F, 0.5F, 0.08F, vec3(0.0F))}}, {.bodies = {ball}});
    run(*world, 0.5);
    EXPECT_EQ(found(*world).position.size(), 0U);
    EXPECT_NEAR(world->stats().backlog, 0.5e-3, 8.0e-6) << "it is still due";
    // A moving body frees the nozzle: after 0.2 m at 1 m/s its places lie outside the body.
    ball.shape = sphereShape(0.12F, 1.0e5, p.spacing);
    ball.state.velocity = vec3(1.0F, 0, 0);
    world = make(*device, p, {.emitters = {nozzle(1.0F, 0.5F, 0.03F, vec3(-0.1F, 0, 0))}}, {.bodies = {ball}});
    std::set<uint32_t> seen;
    for (int frame = 1; frame <= 24; ++frame) {
        world->step({.gravity = vec3(0.0F)}, kFrame);
        const Found f = found(*world);
        const vec3 middle = world->bodies()[0].pose.position;
        for (size_t i = 0; i < f.position.size(); ++i)
            if (seen.insert(f.id[i]).second) EXPECT_GT(glm::length(f.position[i] - middle), 0.12F + 0.49F * p.spacing) << frame;
    }
    EXPECT_GT(seen.size(), 20U);
    EXPECT_EQ(world->stats().lost, 0U);
}

// The solver state of a particle is removed with it: a new particle with the same id starts without it.
TEST(Emitter, AReusedIdStartsWithoutSolverState) {
    auto device = makeTestCpu();
    FluidParams p = boxWorld(0.03F, "dfsph");
    p.box.max = vec3(0.48F, 0.6F, 0.48F);
    p.blocks = {{vec3(0.0F), vec3(0.48F, 0.45F, 0.48F)}};
    SinkParams sink;
    sink.position = vec3(0.06F, 0.06F, 0.24F);
    sink.size = vec3(0.12F, 0.12F, 0.48F);
    auto world = make(*device, p, {.sinks = {sink}});
    const auto remembered = [&](WorldState& state) {
        world->save(state);
        auto pressure = state.take<float>("method.pressure", world->particles().slots);
        EXPECT_TRUE(pressure);
        return *pressure;
    };
    // Particles that were at the bottom of the pool at the start had pressure, and are drained later.
    SinkParams away = sink;
    away.position.y = -5;
    ASSERT_TRUE(world->setSources({.sinks = {away}}));
    run(*world, 0.1);
    WorldState before, after;
    const std::vector<float> pressed = remembered(before);
    ASSERT_TRUE(world->setSources({.sinks = {sink}}));
    run(*world, 0.1);
    const std::vector<float> left = remembered(after);
    const ParticleView view = world->particles();
    const auto x = device->readAll<vec4>(*view.position, view.count);
    const auto id = device->readAll<uint32_t>(*view.id, view.count);
    size_t gone = 0, pressedOnce = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w >= 0) continue;
        ++gone;
        pressedOnce += pressed[id[i]] > 0 ? 1 : 0;
        EXPECT_EQ(left[id[i]], 0.0F) << id[i];
    }
    EXPECT_GT(gone, 100U);
    EXPECT_GT(pressedOnce, 100U);
}

// Under water there is no room: refused particles stay in the backlog, and emitted ones cause no pressure peak.
TEST(Emitter, SpawningInsideWaterIsRefusedWithoutPressurePeaks) {
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        auto device = makeTestCpu();
        FluidParams p = boxWorld(0.03F, method);
        p.box.max = vec3(0.48F, 0.6F, 0.48F);
        p.blocks = {{vec3(0.0F), vec3(0.48F, 0.3F, 0.48F)}};
        Emitter rain = nozzle(2.0F, 0.0F, 0.05F, vec3(0.24F, 0.15F, 0.24F));
        rain.params.shape = "box";
        rain.params.size = vec3(0.4F, 0.2F, 0.4F);
        auto world = make(*device, p, {.emitters = {rain}});
        float fastest = 0;
        for (int k = 0; k < 12; ++k) {
            run(*world, 0.05);
            fastest = std::max(fastest, found(*world).fastest);
        }
        EXPECT_LT(fastest, 1.0F) << method;
        EXPECT_EQ(world->stats().lost, 0U) << method;
        EXPECT_LT(world->stats().avgCompression, 0.02) << method;
        const double placed = static_cast<double>(found(*world).position.size()) * 2.7e-5;
        EXPECT_NEAR(placed + world->stats().backlog, 16 * 10 * 16 * 2.7e-5 + 1.2e-3, 2.7e-5) << method;
    }
}

TEST(Emitter, InvalidParamsAreRefusedWithAMessage) {
    auto device = makeTestCpu();
    Emitter narrow = nozzle(10.0F, 0.5F, 0.01F), astray = nozzle(1.0F, 0.0F, 0.05F, vec3(0.5F), vec3(0.0F)), odd = nozzle(1, 0, 0.05F);
    odd.params.liquid = "lava";
    for (const auto& [emitter, words] : {std::pair(narrow, "lets out"), std::pair(astray, "direction"), std::pair(odd, "lava")}) {
        const auto world = FluidWorld::create(*device, boxWorld(0.02F), {}, {}, {.emitters = {emitter}});
        ASSERT_FALSE(world);
        EXPECT_NE(world.error().message.find(words), std::string::npos) << world.error().message;
    }
}

// The same bits for any threads and instruction set: the positions of new particles depend on no race.
TEST(Emitter, ARunIsBitwiseTheSameForAnyThreadsAndInstructionSet) {
    uint64_t first = 0;
    for (auto [threads, isa] :
         {std::pair(1, bestIsa()), std::pair(2, bestIsa()), std::pair(2, Isa::generic), std::pair(1, std::min(bestIsa(), Isa::avx2))}) {
        auto device = makeTestCpu(threads, isa);
        FluidParams p = boxWorld(0.025F);
        p.maxParticles = 900;
        Emitter rain = nozzle(1.0F, 1.0F, 0.05F, vec3(0.5F, 0.4F, 0.5F));
        rain.params.shape = "box";
        rain.params.liquid = "oil";
        SinkParams sink;
        sink.position = vec3(0.5F, 0.0F, 0.5F);
        sink.size = vec3(0.4F, 0.2F, 0.4F);
        auto world = make(*device, p, {.emitters = {nozzle(3.0F, 0.0F, 0.08F), rain}, .sinks = {sink}});
        run(*world, 1.0);
        uint64_t hash = 1469598103934665603ULL;
        for (const Buffer* b :
             {world->particles().position, world->particles().velocity, world->particles().id, world->particles().absorption})
            for (const uint32_t word : device->readAll<uint32_t>(*b, b->bytes() / 4)) hash = (hash ^ word) * 1099511628211ULL;
        if (first == 0) first = hash;
        EXPECT_EQ(hash, first) << threads;
    }
}

}  // namespace
}  // namespace rivulet::emitter_test
