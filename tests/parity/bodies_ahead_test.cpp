// Bodies that a GPU moves while they are free: they move as the host moves them, and nothing waits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "fluid/scene/solids_bullet.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"
#include "tests/parity/devices.h"

namespace rivulet::bodies_ahead_test {
namespace {

Result<TestGpu> deviceOf(const std::string& name) {
    if (name != "cpu") return makeTestGpu(name);
    TestGpu cpu;
    cpu.device = makeTestCpu();
    return cpu;
}

class BodiesAhead : public testing::TestWithParam<const char*> {};

// ---- the kernel ----

class AdvanceBodies : public testing::TestWithParam<const char*> {};

float distance(const quat& a, const quat& b) { return std::min(glm::length(a - b), glm::length(a + b)); }

// Loads of the same size as a body's weight and inertia, with and without added mass, in steps of up to a turn: 40 steps differ from those of
// FreeBodies and BodyLoads, which are in double, by rounding. A load that is not finite moves nothing; a body without mass does not move, and
// one that the water does not meet falls freely.
TEST_P(AdvanceBodies, MovesAsTheHostDoes) {
    Result<TestGpu> gpu = deviceOf(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Device& device = *gpu->device;
    const Result<Kernel> kernel = device.kernel("fluid/solids/advance_bodies");
    ASSERT_TRUE(kernel) << kernel.error().message;
    constexpr uint32_t kBodies = 200;  // 0: no mass; 1: meets no water; 2: its load is not finite
    std::mt19937 random(7);
    const auto any = [&random] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    FluidParams params;
    std::vector<Body> bodies(kBodies);
    std::vector<BodyState> states;
    for (uint32_t k = 0; k < kBodies; ++k) {
        Body& b = bodies[k];
        b.shape = boxShape(vec3(0.3F, 0.2F, 0.1F) * (1.5F + any()), 300, 0.05F);
        if (k == 0) b.shape.mass = 0;
        b.meetsWater = k != 1;
        b.state = {{vec3(any(), any(), any()), glm::normalize(quat(any(), any(), any(), any()))},
                   vec3(any(), any(), any()),
                   (k % 4 == 0 ? 300.0F : 3.0F) * vec3(any(), any(), any())};
        states.push_back(b.state);
    }
    FreeBodies host(bodies);
    BodyLoads loads(bodies, params);
    std::vector<DeviceBody> rows(kBodies);
    std::vector<BodyMotion> motions(kBodies);
    std::vector<LoadRow> partial(size_t{kBodies} * LOAD_THREADS);
    for (uint32_t k = 0; k < kBodies; ++k) {
        const BodyState& s = states[k];
        const BodyShape& shape = bodies[k].shape;
        const quat& q = s.pose.rotation;
        rows[k].position = vec4(s.pose.position, 0.0F);
        rows[k].rotation = vec4(q.x, q.y, q.z, q.w);
        rows[k].velocity = vec4(s.velocity, 0.0F);
        rows[k].spin = vec4(s.spin, 0.0F);
        motions[k] = {vec4(shape.inertia, shape.mass),
                      vec4(s.pose.position, k < 100 ? 100.0F : 1.0e-4F),
                      static_cast<float>(loads.added(k)),
                      bodies[k].meetsWater ? static_cast<float>(shape.samples.size()) : 0.0F,
                      kBodies,
                      0};
        for (uint32_t t = 0; t < LOAD_THREADS; ++t)
            partial[size_t{k} * LOAD_THREADS + t] = {
                vec4(0.5F * shape.mass * vec3(any(), any(), any()), 0.5F / LOAD_THREADS * static_cast<float>(shape.samples.size())),
                vec4(5.0F * shape.inertia.x * vec3(any(), any(), any()), 0.0F)};
    }
    partial[size_t{2} * LOAD_THREADS + 5].force.y = std::numeric_limits<float>::quiet_NaN();
    StepParams step{};
    step.dt = 2.0e-3F;
    step.gravity = vec4(1, -9.81F, 0.5F, 0);
    Result<Buffer> sums = device.allocate(partial.size() * sizeof(LoadRow)), moved = device.allocate(rows.size() * sizeof(DeviceBody)),
                   by = device.allocate(motions.size() * sizeof(BodyMotion));
    ASSERT_TRUE(sums && moved && by);
    device.writeAll<LoadRow>(*sums, partial);
    device.writeAll<DeviceBody>(*moved, rows);
    device.writeAll<BodyMotion>(*by, motions);
    double way = 0, speed = 0, spin = 0, turn = 0, fastTurn = 0, pending = 0;
    constexpr int kSteps = 40;
    for (int n = 0; n < kSteps; ++n) {
        device.run(*kernel, step, {&*sums, &*by, &*moved}, kBodies);
        std::vector<BodyLoad> now(kBodies);
        for (uint32_t k = 0; k < kBodies; ++k) {
            if (!bodies[k].meetsWater) continue;
            dvec3 force(0.0), torque(0.0);
            for (uint32_t t = 0; t < LOAD_THREADS && k != 2; ++t) {
                force += dvec3(partial[size_t{k} * LOAD_THREADS + t].force);
                torque += dvec3(partial[size_t{k} * LOAD_THREADS + t].torque);
            }
            now[k] = loads.transfer(k, force, torque, k == 2 ? 0.0 : 0.5, double{step.dt});
        }
        const BodyHost h = host.host();
        h.advance(h.self, now, vec3(step.gravity), double{step.dt}, states);
        const std::vector<DeviceBody> got = device.readAll<DeviceBody>(*moved, kBodies);
        for (uint32_t k = 0; k < kBodies; ++k) {
            const DeviceBody& d = got[k];
            const BodyState& s = states[k];
            way = std::max(way, double{glm::length(vec3(d.position) - s.pose.position)});
            speed = std::max(speed, double{glm::length(vec3(d.velocity) - s.velocity)});
            spin = std::max(spin, double{glm::length(vec3(d.spin) - s.spin) / (1 + glm::length(s.spin))});
            double& off = k % 4 == 0 ? fastTurn : turn;
            off = std::max(off, double{distance(quat(d.rotation.w, d.rotation.x, d.rotation.y, d.rotation.z), s.pose.rotation)});
            pending = std::max(pending, glm::length(dvec3(vec3(d.pendingImpulse)) - now[k].pendingImpulse) /
                                            (1.0e-3 + glm::length(now[k].pendingImpulse)));
            EXPECT_EQ((d.faults & BODY_MISLED), 0U);
            const bool strays = k >= 100;  // it moves at once
            if (n + 1 == kSteps) EXPECT_EQ((d.faults & BODY_STRAYED) != 0, strays) << k;
        }
    }
    std::printf("%s: place %.1e m, speed %.1e m/s, spin %.1e of it, rotation %.1e (fast %.1e), pending %.1e of it\n", GetParam(), way, speed, spin,
                turn, fastTurn, pending);
    EXPECT_LT(way, 2.0e-6);
    EXPECT_LT(speed, 2.0e-5);
    EXPECT_LT(spin, 2.0e-4);
    EXPECT_LT(turn, 1.0e-5);
    EXPECT_LT(fastTurn, 2.0e-3) << "four turns, about the unstable axis, too";
    EXPECT_LT(pending, 1.0e-4);
    EXPECT_EQ(states[0].pose.position, bodies[0].state.pose.position) << "without mass";
}
INSTANTIATE_TEST_SUITE_P(Devices, AdvanceBodies, testing::Values("cpu", "cl", "gl"), [](const auto& row) { return row.param; });

// ---- worlds ----

FluidParams pool(const char* method) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.04F;
    p.soundSpeed = 15;
    p.box.max = vec3(0.8F, 0.8F, 0.8F);
    p.blocks = {{vec3(0), vec3(0.8F, 0.4F, 0.8F), vec3(0.0F)}};
    return p;
}

Body ball(const vec3& place, float density = 400) {
    Body body;
    body.shape = sphereShape(0.1F, density, 0.04F);
    body.state.pose.position = place;
    return body;
}

// The same bodies, which the host moves in each substep.
struct Exact {
    explicit Exact(std::span<const Body> bodies) : free(bodies) {}
    FreeBodies free;
    BodyHost host() {
        BodyHost h = free.host();
        h.isFree = nullptr;
        h.passed = nullptr;
        return h;
    }
};

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& p, const Solids& solids) {
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

// A ball falls into a pool and bobs. Moved by the GPU it is where the host moves it, and the steps never wait.
TEST_P(BodiesAhead, ABobbingBallIsWhereTheHostMovesIt) {
    Result<TestGpu> gpu = deviceOf(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    for (const char* method : {"pbf", "dfsph"}) {
        const FluidParams p = pool(method);
        Solids solids{.bodies = {ball(vec3(0.4F, 0.52F, 0.4F))}};
        auto ahead = make(*gpu->device, p, solids);
        Exact host(solids.bodies);
        solids.bodyHost = host.host();
        auto exact = make(*gpu->device, p, solids);
        Solids beside = solids;
        beside.bodies[0].state.pose.position.x += 1.0e-6F;
        auto other = make(*gpu->device, p, beside);
        ASSERT_TRUE(ahead && exact);
        double apart = 0, late = 0, moved = 0;
        for (int frame = 0; frame < 100; ++frame) {
            ahead->step({.gravity = p.gravity}, 1.0 / 60);
            exact->step({.gravity = p.gravity}, 1.0 / 60);
            const vec3 expected = ahead->expectedBodies()[0].pose.position, there = exact->bodies()[0].pose.position;
            // Only now and then, so that the ball moves without being read between.
            if (frame % 10 == 9) apart = std::max(apart, double{glm::length(ahead->bodies()[0].pose.position - there)});
            other->step({.gravity = p.gravity}, 1.0 / 60);
            if (frame % 10 == 9) std::printf("%d: %.2e %.2e late %.2e speed %.3f\n", frame, double{glm::length(ahead->bodies()[0].pose.position - there)}, double{glm::length(other->bodies()[0].pose.position - there)}, double{glm::length(expected-there)}, double{glm::length(exact->bodies()[0].velocity)});
            if (frame % 10 == 8) late = std::max(late, double{glm::length(expected - there)});
            moved = std::max(moved, double{glm::length(there - solids.bodies[0].state.pose.position)});
        }
        gpu->device->finish();
        gpu->device->poll();
        std::printf("%s %s: moved %.3f m, apart %.2e m, expected %.2e m off, waits %llu of %llu, strays %llu\n", GetParam(), method, moved, apart,
                    late, static_cast<unsigned long long>(ahead->stats().bodyWaits),
                    static_cast<unsigned long long>(exact->stats().bodyWaits),
                    static_cast<unsigned long long>(ahead->stats().bodyStrays));
    }
}
INSTANTIATE_TEST_SUITE_P(Devices, BodiesAhead, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::bodies_ahead_test
