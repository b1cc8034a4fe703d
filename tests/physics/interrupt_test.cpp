// A stop in the middle of a step, of a start and of a pass: no further kernel runs, the world refuses to go on from values that are neither
// of before nor of after, and a reset or restore makes it whole. Counted in passes and chunks, not in seconds.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>

#include "fluid/session/session.h"
#include "fluid/sim/world/host_particles.h"
#include "tests/physics/worlds.h"

namespace rivulet::interrupt_test {
namespace {

// Water, a jet, a floating body, foam and volumes: what a step has passes for.
FluidParams params(const std::string& method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.04F;
    p.box.max = vec3(0.8F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.4F)}};
    p.foam.most = 1000;
    p.ellipsoids = true;
    p.maxParticles = 4000;
    return p;
}

Solids withBody(int& advanced) {
    Solids solids;
    Body body;
    body.shape.samples = {vec3(-0.02F, 0, 0), vec3(0.02F, 0, 0)};
    body.shape.mass = 0.1F;
    body.shape.inertia = vec3(1.0e-3F);
    body.shape.volume = 1.0e-4F;
    body.state.pose.position = vec3(0.6F, 0.3F, 0.6F);
    solids.bodies = {body};
    solids.bodyHost.self = &advanced;
    solids.bodyHost.advance = [](void* self, std::span<const BodyLoad>, const vec3&, double, std::span<BodyState>) {
        ++*static_cast<int*>(self);
    };
    solids.bodyHost.reset = [](void*, std::span<const BodyState>) {};
    solids.bodyHost.remembersNothing = true;
    return solids;
}

Sources withJet() {
    Emitter jet;
    jet.params.position = vec3(0.6F, 0.6F, 0.3F);
    jet.params.direction = vec3(0, -1, 0);
    jet.params.litresPerSecond = 5;
    return {.emitters = {jet}};
}

bool same(const FluidWorld& a, const FluidWorld& b) {
    const HostParticles x = readParticles(a), y = readParticles(b);
    return x.position == y.position && x.velocity == y.velocity && x.id == y.id && a.time() == b.time();
}

// Sets the flag once `left` passes have run. Counts them all.
struct StopAfter {
    Device& device;
    std::atomic<bool> flag = false;
    int passes = 0, left = INT32_MAX;
    explicit StopAfter(Device& d) : device(d) {
        device.stopOn(&flag);
        device.onSpan([this](const PassSpan&) {
            ++passes;
            if (--left == 0) flag = true;
        });
    }
    ~StopAfter() {
        device.onSpan({});
        device.stopOn(nullptr);
    }
};

TEST(Interrupt, AStepRunsNoPassAfterTheFlagIsSet) {
    for (const char* method : {"wcsph", "dfsph", "pbf"}) {
        auto device = cpu(), other = cpu();
        int advanced = 0, ignored = 0;
        auto made = FluidWorld::create(*device, params(method), withBody(advanced), {}, withJet());
        auto reference = FluidWorld::create(*other, params(method), withBody(ignored), {}, withJet());
        ASSERT_TRUE(made && reference) << made.error().message;
        FluidWorld& world = **made;
        StopAfter stop(*device);
        world.step({}, 1.0 / 60);
        ASSERT_FALSE(world.interrupted());
        (*reference)->step({}, 1.0 / 60);
        ASSERT_TRUE(same(world, **reference)) << "a flag that is not set changes nothing";
        WorldState saved;
        world.save(saved);
        const auto bytes = saved.sections();
        const auto back = [&] {
            WorldState state;
            for (const auto& [name, content] : bytes) state.putBytes(name, content);
            return world.restore(state);
        };
        stop.passes = 0;
        world.step({}, 1.0 / 60);
        const int whole = stop.passes;
        ASSERT_GT(whole, 20);
        ASSERT_TRUE(back());
        // After the first pass, within each substep's passes, and after the last but one.
        for (const int after : {1, 2, 3, 5, 8, 13, whole / 2, whole - 2, whole - 1}) {
            const double before = world.time();
            stop.passes = 0;
            stop.left = after;
            const int moved = advanced;
            world.step({}, 1.0 / 60);
            EXPECT_EQ(stop.passes, after) << method;
            EXPECT_TRUE(world.interrupted()) << method << ", after " << after;
            if (after < 10) EXPECT_EQ(advanced, moved) << "the host's engine moves no body in an interrupted substep";
            // It refuses while the flag is set, and when it no longer is.
            for (const bool asked : {true, false}) {
                stop.flag = asked;
                const double then = world.time();
                world.step({}, 1.0 / 60);
                EXPECT_EQ(world.time(), then);
                EXPECT_EQ(stop.passes, after);
                EXPECT_FALSE(world.savable());
                EXPECT_FALSE(world.sample(std::vector<vec3>{vec3(0.2F)}));
                EXPECT_TRUE(world.interrupted());
            }
            ASSERT_TRUE(back());
            EXPECT_FALSE(world.interrupted());
            EXPECT_TRUE(same(world, **reference)) << method << ": restored after " << after;
            EXPECT_EQ(world.time(), before);
        }
        stop.left = INT32_MAX;
        world.step({}, 1.0 / 60);
        (*reference)->step({}, 1.0 / 60);
        EXPECT_TRUE(same(world, **reference)) << method << ": goes on as if nothing had been";
        stop.left = 4;
        world.step({}, 1.0 / 60);
        stop.flag = false;
        world.reset();
        EXPECT_FALSE(world.interrupted());
        (*reference)->reset();
        EXPECT_TRUE(same(world, **reference)) << method << ": reset";
        stop.left = INT32_MAX;
        world.step({}, 1.0 / 60);
        (*reference)->step({}, 1.0 / 60);
        EXPECT_TRUE(same(world, **reference)) << method << ": a step after the reset";
    }
}

TEST(Interrupt, AStepThatBeginsWhileAStopIsAskedDoesNothing) {
    auto device = cpu();
    auto world = makeWorld(*device, params("wcsph"));
    world->step({}, 1.0 / 60);
    const HostParticles before = readParticles(*world);
    std::atomic<bool> flag = true;
    device->stopOn(&flag);
    const double time = world->time();
    world->step({}, 1.0 / 60);
    EXPECT_FALSE(world->interrupted());
    EXPECT_EQ(world->time(), time);
    EXPECT_EQ(readParticles(*world).position, before.position);
    flag = false;
    world->step({}, 1.0 / 60);
    EXPECT_GT(world->time(), time);
}

// Of a pass that runs, only the chunks that have begun are completed: at most one a thread.
TEST(Interrupt, EndsWithinAPass) {
    for (const int threads : {1, 2}) {
        const std::vector<CpuKernelRow> rows = cpuKernels();
        auto device = makeCpuDevice(rows, {.threads = threads});
        std::atomic<bool> flag = false;
        device->stopOn(&flag);
        std::atomic<int> chunks = 0;
        device->parallelFor(1U << 20U, 64, [&](size_t, size_t) {
            ++chunks;
            flag = true;
        });
        EXPECT_LE(chunks.load(), threads);
        EXPECT_TRUE(device->interrupted());
        device->goOn();
        EXPECT_TRUE(device->interrupted()) << "no effect while a stop is asked";
        flag = false;
        EXPECT_TRUE(device->interrupted()) << "what was skipped is not forgotten";
        device->parallelFor(1000, 64, [&](size_t, size_t) { chunks = 1000; });
        EXPECT_LE(chunks.load(), threads) << "nothing runs on a mixture";
        device->goOn();
        EXPECT_FALSE(device->interrupted());
        std::atomic<size_t> done = 0;
        device->parallelFor(1000, 64, [&](size_t begin, size_t end) { done += end - begin; });
        EXPECT_EQ(done.load(), 1000U);
    }
}

// The start relaxes its particles: a long piece of work too.
TEST(Interrupt, AStartEndsToo) {
    auto device = cpu();
    std::atomic<bool> flag = true;
    device->stopOn(&flag);
    const auto refused = FluidWorld::create(*device, params("dfsph"), {}, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::failed);
    EXPECT_NE(refused.error().message.find("interrupted"), std::string::npos) << refused.error().message;
    flag = false;
    EXPECT_TRUE(FluidWorld::create(*device, params("dfsph"), {}, {}));
}

// A session passes it on, skins are not stepped on, and a reset starts again.
TEST(Interrupt, ASessionStopsAndStartsAgain) {
    SceneFile scene;
    scene.name = "stopped";
    scene.fluid = params("wcsph");
    auto device = cpu();
    auto session = Session::create(scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    StopAfter stop(*device);
    stop.left = 5;
    (*session)->step(1.0 / 60, true);
    EXPECT_TRUE((*session)->interrupted());
    EXPECT_EQ(stop.passes, 5);
    stop.flag = false;
    (*session)->step(1.0 / 60, true);
    EXPECT_EQ(stop.passes, 5);
    EXPECT_EQ((*session)->time(), 0);
    (*session)->reset();
    EXPECT_FALSE((*session)->interrupted());
    (*session)->step(1.0 / 60, true);
    EXPECT_GT((*session)->time(), 0);
}

}  // namespace
}  // namespace rivulet::interrupt_test
