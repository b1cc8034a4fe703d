// Bodies that a GPU moves while they are free: they move as the host moves them, and nothing waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include "fluid/scene/solids_bullet.h"
#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"

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

class AdvanceBodies : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        Result<TestGpu> gpu = deviceOf(GetParam());
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        gpu_ = std::move(*gpu);
        const Result<Kernel> kernel = device().kernel("fluid/solids/advance_bodies");
        ASSERT_TRUE(kernel) << kernel.error().message;
        kernel_ = *kernel;
    }
    Device& device() { return *gpu_.device; }
    void write(std::span<const LoadRow> loads, std::span<const BodyMotion> motions, std::span<const DeviceBody> bodies) {
        Result<Buffer> sums = device().allocate(loads.size_bytes()), by = device().allocate(motions.size_bytes()),
                       moved = device().allocate(bodies.size_bytes());
        ASSERT_TRUE(sums && by && moved);
        buffers_ = {std::move(*sums), std::move(*by), std::move(*moved)};
        device().writeAll<LoadRow>(buffers_[0], loads);
        device().writeAll<BodyMotion>(buffers_[1], motions);
        device().writeAll<DeviceBody>(buffers_[2], bodies);
        count_ = bodies.size();
    }
    std::vector<DeviceBody> advanced(const StepParams& step) {
        device().run(kernel_, step, {&buffers_[0], &buffers_[1], &buffers_[2]}, static_cast<uint32_t>(count_));
        return device().readAll<DeviceBody>(buffers_[2], count_);
    }

  private:
    TestGpu gpu_;
    Kernel kernel_;
    std::array<Buffer, 3> buffers_;  // loads, motions, bodies
    size_t count_ = 0;
};

float distance(const quat& a, const quat& b) { return std::min(glm::length(a - b), glm::length(a + b)); }

// Loads of the same size as a body's weight and inertia, with and without added mass, in steps of up to a turn: 40 steps differ from those
// of FreeBodies and BodyLoads, which are in double, by rounding. A load that is not finite moves nothing; a body without mass does not
// move, and one that the water does not meet falls freely.
TEST_P(AdvanceBodies, MovesAsTheHostDoes) {
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
                      0,
                      vec4(0),
                      vec4(0)};
        for (uint32_t t = 0; t < LOAD_THREADS; ++t)
            partial[size_t{k} * LOAD_THREADS + t] = {
                vec4(0.5F * shape.mass * vec3(any(), any(), any()), 0.5F / LOAD_THREADS * static_cast<float>(shape.samples.size())),
                vec4(5.0F * shape.inertia.x * vec3(any(), any(), any()), 0.0F)};
    }
    partial[size_t{2} * LOAD_THREADS + 5].force.y = std::numeric_limits<float>::quiet_NaN();
    StepParams step{};
    step.dt = 2.0e-3F;
    step.gravity = vec4(1, -9.81F, 0.5F, 0);
    ASSERT_NO_FATAL_FAILURE(write(partial, motions, rows));
    double way = 0, speed = 0, spin = 0, turn = 0, fastTurn = 0, pending = 0;
    constexpr int kSteps = 40;
    std::vector<DeviceBody> got;
    for (int n = 0; n < kSteps; ++n) {
        got = advanced(step);
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
        for (uint32_t k = 0; k < kBodies; ++k) {
            const DeviceBody& d = got[k];
            const BodyState& s = states[k];
            EXPECT_TRUE(isFinite(vec3(d.position)) && isFinite(vec3(d.velocity)) && isFinite(vec3(d.spin))) << k;
            EXPECT_NEAR(glm::length(d.rotation), 1, 1.0e-5F) << k;  // false for NaN, too
            EXPECT_TRUE(isFinite(vec3(d.pendingImpulse)) && isFinite(vec3(d.pendingAngularImpulse))) << k;
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
    std::printf("%s: place %.1e m, speed %.1e m/s, spin %.1e of it, rotation %.1e (fast %.1e), pending %.1e of it\n", GetParam(), way,
                speed, spin, turn, fastTurn, pending);
    EXPECT_LT(way, 2.0e-6);
    EXPECT_LT(speed, 2.0e-5);
    EXPECT_LT(spin, 2.0e-4);
    EXPECT_LT(turn, 1.0e-5);
    EXPECT_LT(fastTurn, 2.0e-3) << "four turns, about the unstable axis, too";
    EXPECT_LT(pending, 1.0e-4);
    EXPECT_EQ(vec3(got[0].position), bodies[0].state.pose.position) << "without mass";
    EXPECT_EQ(got[0].rotation, rows[0].rotation);
}
// A finite load that would make a body impossibly fast: it keeps its state, and that is noted.
TEST_P(AdvanceBodies, KeepsTheStateOfABodyWhoseNextOneIsImpossible) {
    std::vector<LoadRow> partial(LOAD_THREADS);
    partial[3].force.x = 1.0e16F;
    DeviceBody row{};
    row.position = vec4(1, 2, 3, 0);
    row.rotation = vec4(0, 0, 0, 1);
    const BodyMotion motion{vec4(1, 1, 1, 1), vec4(1, 2, 3, 1), 0.0F, 10.0F, 1, 0, vec4(0), vec4(0)};
    ASSERT_NO_FATAL_FAILURE(write(partial, std::span(&motion, 1), std::span(&row, 1)));
    StepParams step{};
    step.dt = 1.0e-3F;
    const DeviceBody got = advanced(step)[0];
    EXPECT_EQ(vec3(got.position), vec3(1, 2, 3));
    EXPECT_EQ(vec3(got.velocity), vec3(0.0F));
    EXPECT_EQ(got.faults, BODY_MISLED);
}
INSTANTIATE_TEST_SUITE_P(Devices, AdvanceBodies, testing::Values("cpu", "cl", "gl"), [](const auto& row) { return row.param; });

// ---- worlds ----

constexpr double kFrame = 1.0 / 60;  // s

FluidParams pool(const char* method, float depth) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.05F;
    p.box.max = vec3(0.5F, 0.8F, 0.5F);
    p.blocks = {{vec3(0), vec3(0.5F, depth, 0.5F), vec3(0.0F)}};
    return p;
}

Body ball(const vec3& place, double density = 400) {
    Body body;
    body.shape = sphereShape(0.1F, density, 0.05F);
    body.state.pose.position = place;
    return body;
}

// A host that moves the bodies in each substep, as FreeBodies.
struct Exact {
    explicit Exact(std::span<const Body> bodies) : free(bodies) {}
    FreeBodies free;
    BodyHost host() {
        BodyHost h = free.host();
        h.contacts = nullptr;
        h.passed = nullptr;
        return h;
    }
};

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& p, const Solids& solids) {
    auto world = FluidWorld::create(device, p, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

// The counts of all frames until now.
FluidStats statsOf(FluidWorld& world) {
    world.device().finish();
    world.device().poll();
    return world.stats();
}

double apart(const BodyState& a, const BodyState& b) { return double{glm::length(a.pose.position - b.pose.position)}; }

// A ball falls into a pool and bobs. Before it touches water the GPU moves it as the host does, but for rounding; then it stays within what
// rounding makes of splashing water. The host waits in each substep, the GPU hardly ever.
TEST_P(BodiesAhead, ABobbingBallIsWhereTheHostMovesIt) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const FluidParams p = pool("pbf", 0.25F);
    Solids solids{.bodies = {ball(vec3(0.25F, 0.5F, 0.25F))}};
    auto ahead = make(*gpu->device, p, solids);
    Exact host(solids.bodies);
    solids.bodyHost = host.host();
    auto exact = make(*gpu->device, p, solids);
    ASSERT_TRUE(ahead && exact);
    uint64_t substeps = 0;
    double falling = 0, late = 0;
    for (int frame = 0; frame < 50; ++frame) {
        ahead->step({.gravity = p.gravity}, kFrame);
        exact->step({.gravity = p.gravity}, kFrame);
        substeps += static_cast<uint64_t>(exact->lastSubsteps());
        const double off = apart(ahead->expectedBodies()[0], exact->bodies()[0]);
        if (frame < 7) falling = std::max(falling, off);  // 6 cm
        late = std::max(late, off);
    }
    EXPECT_EQ(statsOf(*ahead).bodyWaits, 0U);
    EXPECT_EQ(ahead->stats().bodyStrays, 0U);
    EXPECT_EQ(statsOf(*exact).bodyWaits, substeps);
    const double swimming = apart(ahead->bodies()[0], exact->bodies()[0]);
    std::printf("%s: falling %.1e m, at most %.1e m, at the end %.1e m, speed there %.2f m/s\n", GetParam(), falling, late, swimming,
                double{glm::length(exact->bodies()[0].velocity)});
    EXPECT_LT(falling, 5.0e-4) << "as expected from earlier frames";
    EXPECT_LT(late, 0.3 * double{p.spacing});
    EXPECT_LT(swimming, 0.3 * double{p.spacing});
    EXPECT_GT(apart(exact->bodies()[0], solids.bodies[0].state), 0.1);
}

// Water hits a box off its centre, without gravity: the momentum of both stays. The blow, which nothing announced, throws the box further
// than was foreseen: that is counted, and the box is where the host has it.
TEST_P(BodiesAhead, MomentumStaysAndABlowIsNoticed) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    for (const float speed : {2.0F, 5.0F}) {
        FluidParams p = pool("dfsph", 0);
        p.gravity = vec3(0.0F);
        p.box.max = vec3(3.0F, 2.0F, 2.0F);
        p.blocks = {{vec3(0.5F, 0.9F, 0.9F), vec3(0.75F, 1.15F, 1.15F), vec3(speed, 0, 0)}};
        Solids solids{.bodies = {Body{}}};
        Body& body = solids.bodies[0];
        body.shape = boxShape(vec3(0.2F), speed > 4 ? 100 : 1000, p.spacing);
        body.state.pose.position = vec3(0.9F, 1.05F, 1.0F);
        auto ahead = make(*gpu->device, p, solids);
        Exact host(solids.bodies);
        solids.bodyHost = host.host();
        auto exact = make(*gpu->device, p, solids);
        ASSERT_TRUE(ahead && exact);
        const double mass = ahead->particles().mass;
        const dvec3 before(mass * ahead->particles().count * double{speed}, 0, 0);
        for (int frame = 0; frame < 10; ++frame)
            for (FluidWorld* world : {ahead.get(), exact.get()}) world->step({.gravity = p.gravity}, kFrame);
        const ParticleView view = ahead->particles();
        dvec3 after(0.0);
        const std::vector<vec4> x = gpu->device->readAll<vec4>(*view.position, view.slots),
                                v = gpu->device->readAll<vec4>(*view.velocity, view.slots);
        for (size_t i = 0; i < x.size(); ++i)
            if (x[i].w >= 0) after += mass * dvec3(v[i]);
        const dvec3 own = double{body.shape.mass} * dvec3(ahead->bodies()[0].velocity);
        after += own + ahead->bodyLoads()[0].pendingImpulse;
        std::printf("%s, %g m/s: momentum %.1e of the impulse, strays %llu, %.1e m from the host's after %.2f m\n", GetParam(),
                    double{speed}, glm::length(after - before) / glm::length(own),
                    static_cast<unsigned long long>(statsOf(*ahead).bodyStrays), apart(ahead->bodies()[0], exact->bodies()[0]),
                    apart(exact->bodies()[0], body.state));
        EXPECT_LT(glm::length(after - before), 1.0e-4 * glm::length(own));
        EXPECT_GT(glm::length(own), 0.03 * glm::length(before)) << "it is hit";
        EXPECT_LT(apart(ahead->bodies()[0], exact->bodies()[0]), 0.1 * double{p.spacing});
        EXPECT_GT(statsOf(*ahead).bodyStrays, 0U);
    }
}

// A ball is thrown at a wall, which Bullet knows. Its path is that of the law of impact, and nothing waits. (Bullet's own bounce begins up
// to 20 mm before a wall, with a speed that depends on where a step ends.)
TEST_P(BodiesAhead, ABallComesBackFromAWall) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p = pool("pbf", 0.1F);
    p.box.max = vec3(2.0F, 2.0F, 0.6F);
    p.blocks = {{vec3(1.8F, 0.0F, 0.0F), vec3(2.0F, 0.1F, 0.2F), vec3(0.0F)}};
    p.gravity = vec3(0, -1, 0);
    p.fixedStep = static_cast<float>(kFrame / 4);
    // It meets the wall a third of a substep's way after the begin: at the end a rounding would decide in which.
    constexpr float kStart = 1.2042F;
    Solids solids{.bodies = {ball(vec3(kStart, 1.2F, 0.3F), 1000)}};
    solids.bodies[0].state.velocity = vec3(-3, 0, 0);
    BodyForm form;
    form.kind = BodyForm::Kind::sphere;
    form.radius = 0.1F;
    form.restitution = 0.5F;
    BulletSolids contacts(BulletSolids::Scene{.box = p.box, .planes = {}, .still = {}, .moving = {}, .poses = {}}, solids.bodies,
                          std::span(&form, 1));
    solids.bodyHost = contacts.host();
    auto ahead = make(*gpu->device, p, solids);
    ASSERT_TRUE(ahead);
    // It ends the substep in which it meets the wall at the wall, and parts then with half its speed. Friction makes it roll there from
    // that substep on: of its speed along the wall it keeps 1 / (1 + 2/5), since the angular momentum about the point of contact stays.
    const double step = p.fixedStep, meets = std::ceil((double{kStart} - 0.1) / 3 / step) * step, last = meets - step;
    const auto placeAt = [&](double t) {
        const auto fallen = [step](double s) { return 0.5 * s * (s + step); };  // symplectic Euler
        if (t < meets - 0.5 * step) return dvec2(double{kStart} - 3 * t, 1.2 - fallen(t));
        return dvec2(0.1 + 1.5 * (t - meets), 1.2 - fallen(last) - meets / 1.4 * (t - last) - fallen(t - meets));
    };
    double expected = 0;
    uint64_t waits = 0;
    int frames = 0;  // of which no frame waits
    for (int frame = 0; frame < 45; ++frame) {
        ahead->step({.gravity = p.gravity}, kFrame);
        const uint64_t now = statsOf(*ahead).bodyWaits;
        if (now == waits) ++frames;
        waits = now;
        // The states arrive at once here, since statsOf() lets the GPU finish; so this reads no more than a frame's.
        expected = std::max(expected, glm::length(dvec2(vec2(ahead->expectedBodies()[0].pose.position)) - placeAt(ahead->time())));
    }
    const double off = glm::length(dvec2(vec2(ahead->bodies()[0].pose.position)) - placeAt(ahead->time()));
    std::printf("%s: %.1e m from the law at the end, expected within %.1e m, %d of 45 frames without a wait\n", GetParam(), off, expected,
                frames);
    EXPECT_LT(off, 1.0e-5);
    EXPECT_LT(expected, 0.01) << "states of a frame earlier, continued through the bounce";
    EXPECT_EQ(frames, 45);
    EXPECT_EQ(waits, 0U);
}

// An emitter fills a box in which a ball bobs, on a GPU that is two frames behind: no frame waits to know where the ball is. As many
// particles are spawned as on the cpu, about, and none so near to the ball that it is shot away, or inside it.
TEST_P(BodiesAhead, EmittersPourBesideThem) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p = pool("pbf", 0.25F);
    p.fixedStep = static_cast<float>(kFrame / 4);
    const Solids solids{.bodies = {ball(vec3(0.25F, 0.4F, 0.25F))}};
    Sources sources;
    sources.seconds = 1;
    sources.emitters.resize(1);
    sources.emitters[0].params = {.shape = "box", .litresPerSecond = 40, .position = vec3(0.25F, 0.4F, 0.25F), .size = vec3(0.3F)};
    LateDevice late(*gpu->device, 1);
    const std::unique_ptr<Device> cpu = makeTestCpu();
    auto made = FluidWorld::create(late, p, solids, {}, sources), host = FluidWorld::create(*cpu, p, solids, {}, sources);
    ASSERT_TRUE(made && host);
    double deepest = 0, deepestOfHost = 0, fastest = 0, fastestOfHost = 0;
    const auto depthIn = [](const vec3& at, FluidWorld& world) {
        double most = 0;
        for (const vec3& x : positions(world)) most = std::max(most, 0.1 - double{glm::length(x - at)});
        return most;
    };
    const auto speedOf = [](FluidWorld& world) {
        double most = 0;
        const ParticleView view = world.particles();
        const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.slots),
                                v = world.device().readAll<vec4>(*view.velocity, view.slots);
        for (size_t i = 0; i < x.size(); ++i)
            if (x[i].w >= 0) most = std::max(most, double{glm::length(vec3(v[i]))});
        return most;
    };
    for (int frame = 0; frame < 30; ++frame) {
        (*made)->step({.gravity = p.gravity}, kFrame);
        (*host)->step({.gravity = p.gravity}, kFrame);
        late.frameEnds();
        deepest = std::max(deepest, depthIn(vec3(late.rows.back()[0].position), **made));
        deepestOfHost = std::max(deepestOfHost, depthIn((*host)->bodies()[0].pose.position, **host));
        fastest = std::max(fastest, speedOf(**made));
        fastestOfHost = std::max(fastestOfHost, speedOf(**host));
    }
    const double particle = std::pow(double{p.spacing}, 3), a = (*host)->stats().emitted / particle,
                 b = (*made)->stats().emitted / particle;
    std::printf("%s: %.0f spawned, %.0f on the cpu; at most %.4f m inside the ball (%.4f m); fastest %.2f m/s, %.2f on the cpu\n",
                GetParam(), b, a, deepest, deepestOfHost, fastest, fastestOfHost);
    EXPECT_EQ((*made)->stats().bodyWaits, 0U);
    EXPECT_GT(a, 50);
    EXPECT_NEAR(b, a, 0.1 * a);
    EXPECT_LT(deepest, deepestOfHost + 0.3 * double{p.spacing});
    EXPECT_LT(fastest, 1.5 * fastestOfHost);
}

// Two meshes: one stands, one moves to and fro. Contacts are found as soon as the ball may meet one of them on its way.
TEST(Contacts, KnowMeshesTheirMotionAndOtherBodies) {
    const std::vector<vec3> corners = {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}};
    const std::vector<uint32_t> faces = {0, 1, 2, 0, 2, 3};
    const MeshView plate{corners, faces, {}, {}};
    BoxParams box;
    box.min = vec3(-4);
    box.max = vec3(4);
    std::vector<Body> bodies = {ball(vec3(0)), ball(vec3(0, 0, 2))};
    std::vector<BodyForm> forms(2);
    for (BodyForm& form : forms) {
        form.kind = BodyForm::Kind::sphere;
        form.radius = 0.1F;
    }
    const Pose start{vec3(1, 0, 0)};
    BulletSolids contacts({.box = box, .planes = {}, .still = {}, .moving = std::span(&plate, 1), .poses = std::span(&start, 1)}, bodies,
                          forms);
    const BodyHost host = contacts.host();
    std::vector<BodyContact> found;
    // Each ball is in the middle of where it may be.
    const auto count = [&](const vec4& first, const vec4& second = vec4(0, 0, 2, 0.01F)) {
        const std::array<vec4, 2> balls = {first, second};
        std::array<BodyState, 2> states;
        for (size_t k = 0; k < 2; ++k) states[k].pose.position = vec3(balls[k]);
        found.clear();
        EXPECT_TRUE(host.contacts(host.self, states, balls, kFrame, found));
        return found.size();
    };
    EXPECT_EQ(count(vec4(0, 0, 0, 0.1F)), 0U);
    ASSERT_EQ(count(vec4(0, 0, 0, 0.95F)), 1U) << "the plate is 1 m away";
    EXPECT_NEAR(found[0].normal.x, -1, 1.0e-5F);
    EXPECT_NEAR(found[0].onB.x, 1, 1.0e-5F);
    EXPECT_EQ(found[0].radiusA, 0.1F);
    EXPECT_EQ(found[0].b, BodyContact::kSolid);
    EXPECT_EQ(count(vec4(1, 1.3F, 0, 0.1F)), 0U) << "above it";
    ASSERT_EQ(count(vec4(-3.85F, 0, 0, 0.1F)), 1U) << "the wall of the box";
    EXPECT_EQ(found[0].normal, vec3(1, 0, 0));
    ASSERT_EQ(count(vec4(0, 0, 1.7F, 0.15F)), 1U) << "the other ball";
    EXPECT_EQ(found[0].b, 1U);
    EXPECT_NEAR(found[0].normal.z, -1, 1.0e-5F);
    const Pose end{vec3(-1, 0, 0)};
    contacts.moveTo(std::span(&end, 1), kFrame);
    EXPECT_GE(count(vec4(0, 0, 0, 0.1F)), 1U) << "the plate passes here";
    ASSERT_EQ(std::ranges::count(found, 0U, &BodyContact::a), 1);
    EXPECT_NEAR(found[0].velocityB.x, -2 / kFrame, 1.0e-3 / kFrame);
    host.passed(host.self, kFrame);
    EXPECT_EQ(count(vec4(0, 0, 0, 0.1F)), 0U) << "it has passed";
    EXPECT_EQ(count(vec4(-1.05F, 0, 0, 0.1F)), 1U);
    const Pose turned{vec3(-1, 0, 0), glm::angleAxis(1.5F, vec3(0, 0, 1))};
    contacts.moveTo(std::span(&turned, 1), kFrame);
    EXPECT_GE(count(vec4(-1.6F, 0.6F, 0, 0.05F)), 1U);
    // One triangle of the plate sweeps over the ball, the other passes by: the plane to that lies along the way, and bars nothing.
    const auto facing = [&](float low, float high) {
        return std::ranges::count_if(
            found, [&](const BodyContact& c) { return c.a == 0 && std::abs(c.normal.x) >= low && std::abs(c.normal.x) <= high; });
    };
    EXPECT_EQ(facing(0.99F, 1.01F), 1);
    EXPECT_EQ(facing(0.01F, 0.99F), 0);
}

// A world is saved, continued by another, reset, and bodies come and go, while the GPU moves them: nothing of their motion is lost.
TEST_P(BodiesAhead, SavedResetAddedRemoved) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p = pool("pbf", 0.1F);
    p.maxBodySamples = 600;
    const Solids solids{.bodies = {ball(vec3(0.25F, 0.7F, 0.25F))}};
    auto world = make(*gpu->device, p, solids), second = make(*gpu->device, p, solids);
    ASSERT_TRUE(world && second);
    const auto fallen = [&](double seconds) {
        const double n = seconds / kFrame * world->lastSubsteps();  // symplectic Euler: n steps fall g t^2 / 2 (1 + 1 / n)
        return 0.5 * 9.81 * seconds * seconds * (1 + 1 / n);
    };
    for (int frame = 0; frame < 4; ++frame) world->step({.gravity = p.gravity}, kFrame);
    WorldState state;
    world->save(state);
    ASSERT_TRUE(second->restore(state));
    EXPECT_EQ(second->bodies()[0].pose.position, world->bodies()[0].pose.position);
    EXPECT_NEAR(0.7 - double{world->bodies()[0].pose.position.y}, fallen(4 * kFrame), 1.0e-3);
    const Result<uint32_t> id = world->addBody(ball(vec3(0.25F, 0.5F, 0.25F)));
    ASSERT_TRUE(id) << id.error().message;
    for (FluidWorld* w : {world.get(), second.get()})
        for (int frame = 0; frame < 3; ++frame) w->step({.gravity = p.gravity}, kFrame);
    EXPECT_LT(apart(world->bodies()[0], second->bodies()[0]), 2.0e-6);
    EXPECT_NEAR(0.5 - double{world->bodies()[1].pose.position.y}, fallen(3 * kFrame), 1.0e-3);
    const float after = world->bodies()[1].pose.position.y;
    world->step({.gravity = p.gravity}, kFrame);
    ASSERT_TRUE(world->removeBody(0));
    ASSERT_EQ(world->bodies().size(), 1U);
    EXPECT_LT(world->bodies()[0].pose.position.y, after - 0.001F);
    world->step({.gravity = p.gravity}, kFrame);
    world->reset();
    EXPECT_TRUE(world->lastStep());
    ASSERT_EQ(world->bodies().size(), 1U);
    EXPECT_EQ(world->bodies()[0].pose.position, vec3(0.25F, 0.5F, 0.25F));
    EXPECT_EQ(world->bodies()[0].velocity, vec3(0.0F));
    world->step({.gravity = p.gravity}, kFrame);
    EXPECT_NEAR(0.5 - double{world->bodies()[0].pose.position.y}, fallen(kFrame), 1.0e-4);
}

// A host that refuses one body by an exception, after memory has grown: those that are there move on as if nothing had been.
TEST_P(BodiesAhead, GoOnWhereTheHostThrows) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p = pool("pbf", 0.1F);
    p.maxBodySamples = 600;
    Solids solids{.bodies = {ball(vec3(0.25F, 0.7F, 0.25F))}};
    FreeBodies own(solids.bodies), others(solids.bodies);
    solids.bodyHost = own.host();
    solids.bodyHost.added = [](void*, uint32_t, const Body&) { throw std::runtime_error("no"); };
    auto world = make(*gpu->device, p, solids);
    solids.bodyHost = others.host();
    auto exact = make(*gpu->device, p, solids);
    ASSERT_TRUE(world && exact);
    for (int frame = 0; frame < 5; ++frame) {
        if (frame == 3) EXPECT_THROW((void)world->addBody(ball(vec3(0.25F, 0.45F, 0.25F))), std::runtime_error);
        for (FluidWorld* w : {world.get(), exact.get()}) w->step({.gravity = p.gravity}, kFrame);
    }
    EXPECT_LT(apart(world->bodies()[0], exact->bodies()[0]), 2.0e-6);
    EXPECT_LT(world->bodies()[0].pose.position.y, 0.68F);
}

INSTANTIATE_TEST_SUITE_P(Devices, BodiesAhead, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::bodies_ahead_test
