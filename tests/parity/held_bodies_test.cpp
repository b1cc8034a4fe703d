// Bodies that a hand holds: a GPU pulls them as Bullet does on the cpu, and nothing waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/scene/solids_bullet.h"
#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"
#include "tests/parity/body_rig.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"
#include "tests/parity/touching.h"

namespace rivulet::held_bodies_test {
namespace {

using body_rig::kFrame;
using body_rig::Scenario;

BodyState stateOf(const DeviceBody& d) {
    return {{vec3(d.position), quat(d.rotation.w, d.rotation.x, d.rotation.y, d.rotation.z)}, vec3(d.velocity), vec3(d.spin)};
}
double apart(const BodyState& a, const BodyState& b) { return double{glm::length(a.pose.position - b.pose.position)}; }
double turnedBetween(const BodyState& a, const BodyState& b) {  // rad
    return 2 * std::acos(std::min(1.0F, std::abs(glm::dot(a.pose.rotation, b.pose.rotation))));
}

// The spring's pull, N over the mass, in double: critically damped, softer in long steps and at points that are light, limited.
dvec3 springOf(const BodyPull& pull, const BodyShape& shape, const BodyState& s, double seconds) {
    const dvec3 arm = dquat(s.pose.rotation) * dvec3(pull.at), inertia(shape.inertia);
    const double least = std::min({inertia.x, inertia.y, inertia.z}), light = 1 + double{shape.mass} * glm::dot(arm, arm) / least;
    const double rate = std::min(double{pull.rate}, 0.1 / seconds) * std::min(1.0, 8 / light);
    const dvec3 velocity = dvec3(s.velocity) + glm::cross(dvec3(s.spin), arm);
    const dvec3 wanted = rate * rate * (dvec3(pull.to) - dvec3(s.pose.position) - arm) - 2 * rate * velocity;
    return wanted * std::min(1.0, double{pull.most} / std::max(glm::length(wanted), 1.0e-30));
}

// ---- the kernels ----

class Pulls : public testing::TestWithParam<const char*> {};

// A substep of bodies of any inertia that are pulled at any point, at rates and with limits that differ, by both kernels: those that touch
// nothing and those that may touch something. Velocities and spins are those of the law in double; the weight is carried at the centre of
// mass, so that it turns nothing, and a body that is not held falls.
TEST_P(Pulls, AreThoseOfTheLaw) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    std::mt19937 random(3);
    const auto any = [&random] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    const auto anyVector = [&any](float size) { return size * vec3(any(), any(), any()); };
    for (const double seconds : {1.0 / 1000, 1.0 / 120, 1.0 / 30}) {
        Touching t;
        t.step.dt = static_cast<float>(seconds);
        t.step.gravity = vec4(0.5F, -9.81F, 1, 0);
        constexpr uint32_t kBodies = 120;
        for (uint32_t k = 0; k < kBodies; ++k) {
            Body b;
            b.shape = boxShape(vec3(0.3F, 0.2F, 0.1F) * (1.5F + any()), 300, 0.05F);
            b.state = {{anyVector(1), glm::normalize(quat(any(), any(), any(), any()))}, anyVector(2), anyVector(5)};
            t.bodies.push_back(b);
            if (k % 3 == 0) {  // a wall far away: the body may touch something, and does not
                BodyContact c;
                c.a = k;
                c.onB = vec3(0, -50, 0);
                c.normal = vec3(0, 1, 0);
                t.contacts.push_back(c);
            }
            if (k % 4 == 0) continue;
            BodyPull pull{.body = k, .at = anyVector(0.1F), .to = b.state.pose.position + anyVector(k % 2 == 0 ? 0.1F : 3.0F)};
            if (k % 4 == 1) pull.rate = 5;
            if (k % 8 == 1) pull.most = 20;
            t.pulls.push_back(pull);
        }
        const std::vector<DeviceBody> got = t.run(*gpu->device);
        double speed = 0, turn = 0;
        int limited = 0;
        for (uint32_t k = 0; k < kBodies; ++k) {
            const BodyState &was = t.bodies[k].state, is = stateOf(got[k]);
            const auto pull = std::ranges::find(t.pulls, k, &BodyPull::body);
            const bool held = pull != t.pulls.end();
            const dvec3 spring = held ? springOf(*pull, t.bodies[k].shape, was, seconds) : dvec3(0.0);
            if (held && std::abs(glm::length(spring) - double{pull->most}) < 1.0e-6) ++limited;
            const dvec3 fast = dvec3(was.velocity) + seconds * (held ? spring : dvec3(vec3(t.step.gravity)));
            speed = std::max(speed, glm::length(dvec3(is.velocity) - fast));
            const auto momentum = [&](const BodyState& s) {
                const dmat3 r = glm::mat3_cast(dquat(s.pose.rotation));
                return r * (dvec3(t.bodies[k].shape.inertia) * (glm::transpose(r) * dvec3(s.spin)));
            };
            const double mass = t.bodies[k].shape.mass, least = t.bodies[k].shape.inertia.x;
            dvec3 wanted = momentum(was) * (held ? std::exp(-6 * seconds) : 1.0);
            if (held) wanted += mass * seconds * glm::cross(dquat(was.pose.rotation) * dvec3(pull->at), spring);
            turn = std::max(turn, glm::length(momentum(is) - wanted) / least);
        }
        std::printf("%s, %.4f s: speeds to %.1e m/s, angular momentum to %.1e rad/s; %d limited\n", GetParam(), seconds, speed, turn,
                    limited);
        EXPECT_LT(speed, 1.0e-5);
        EXPECT_LT(turn, 1.0e-3);
        EXPECT_GT(limited, 10);
    }
}
INSTANTIATE_TEST_SUITE_P(Devices, Pulls, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });

// ---- worlds ----

// The same bodies and the same hand twice: on a GPU that is two frames behind, and on the cpu, where Bullet moves them.
class Twice {
  public:
    Twice(const char* device, const Scenario& setup, const FluidParams& params) : setup_(setup), cpu_(makeTestCpu()) {
        Result<TestGpu> gpu = makeTestGpu(device);
        if (!gpu) {
            absent = gpu.error().message;
            return;
        }
        gpu_ = std::move(*gpu);
        late_ = std::make_unique<LateDevice>(*gpu_.device, setup.bodies.size());
        for (const bool onGpu : {true, false}) {
            hosts_.push_back(std::make_unique<BulletSolids>(
                BulletSolids::Scene{
                    .box = params.box, .planes = setup_.planes, .still = setup_.still, .moving = setup_.moving, .poses = setup_.poses},
                setup_.bodies, setup_.forms));
            auto made = FluidWorld::create(onGpu ? static_cast<Device&>(*late_) : *cpu_, params,
                                           {.bodies = setup_.bodies, .bodyHost = hosts_.back()->host()}, {});
            EXPECT_TRUE(made) << (made ? "" : made.error().message);
            if (made) worlds_.push_back(std::move(*made));
        }
    }
    ~Twice() {
        if (worlds_.size() < 2) return;
        EXPECT_EQ(worlds_[0]->stats().bodyWaits, 0U);
        EXPECT_EQ(late_->reads, 0U) << "nothing waits";
    }
    Twice(const Twice&) = delete;
    Twice& operator=(const Twice&) = delete;
    void frame(const std::optional<BodyPull>& hand) {
        for (const auto& host : hosts_) host->hold(hand);
        for (const auto& world : worlds_) world->step({.gravity = setup_.gravity}, length);
        late_->frameEnds();
        const BodyState there = onGpu();
        off = std::max(off, apart(there, onCpu()));
        turnedOff = std::max(turnedOff, turnedBetween(there, onCpu()));
        fastOff = std::max(fastOff, double{glm::length(there.velocity - onCpu().velocity)});
        misjudged = std::max(misjudged, apart(there, worlds_[0]->expectedBodies()[0]));
    }
    BodyState onGpu(size_t body = 0) const { return stateOf(late_->rows.back()[body]); }
    const BodyState& onCpu(size_t body = 0) const { return worlds_[1]->bodies()[body]; }
    int substeps() const { return worlds_[0]->lastSubsteps(); }
    dvec3 force() const { return dvec3(vec3(late_->rows.back()[0].force)); }  // N, the water's on body 0, in the last step
    const FluidStats& stats() const { return worlds_[0]->stats(); }
    std::string absent;
    double length = kFrame;  // s, of a frame
    // The largest so far, of body 0: between the two, m, rad, m/s; between the GPU's and what its host expects, m.
    double off = 0, turnedOff = 0, fastOff = 0, misjudged = 0;

  private:
    Scenario setup_;
    TestGpu gpu_;
    std::unique_ptr<LateDevice> late_;
    std::unique_ptr<Device> cpu_;
    std::vector<std::unique_ptr<BulletSolids>> hosts_;
    std::vector<std::unique_ptr<FluidWorld>> worlds_;
};

class Held : public testing::TestWithParam<const char*> {};

// A heavy box is lifted by a corner, swings about it and comes to rest. It moves as on the cpu. In the end its corner is where the hand is,
// and it stays as it has turned, not hanging down: the hand carries the weight at its middle.
TEST_P(Held, ABoxHangsFromItsCorner) {
    Scenario s;
    s.addBox(vec3(0.3F, 0.2F, 0.25F), vec3(0, 0.5F, 0), 0.5F);
    s.bodies[0].shape = boxShape(vec3(0.3F, 0.2F, 0.25F), 4000, 0.05F);
    Twice t(GetParam(), s, body_rig::paramsOf(s));
    if (!t.absent.empty()) GTEST_SKIP() << t.absent;
    const vec3 corner(0.15F, 0.1F, 0.125F);
    vec3 to = s.bodies[0].state.pose.toWorld(corner);
    double fastest = 0;  // rad/s
    for (int frame = 0; frame < 90; ++frame) {
        if (frame < 30) to += vec3(0.02F, 0.025F, -0.01F);  // 2 m/s
        t.frame(BodyPull{.body = 0, .at = corner, .to = to});
        fastest = std::max(fastest, double{glm::length(t.onGpu().spin)});
    }
    const BodyState end = t.onGpu();
    std::printf("%s: %.1e m and %.1e rad off the cpu's, expected to %.1e m; the corner ends %.1e m off, %.1e rad/s\n", GetParam(), t.off,
                t.turnedOff, t.misjudged, double{glm::length(end.pose.toWorld(corner) - to)}, double{glm::length(end.spin)});
    EXPECT_LT(t.off, 2.0e-3);
    EXPECT_LT(t.turnedOff, 0.02);
    EXPECT_LT(t.misjudged, 5.0e-3);
    EXPECT_GT(fastest, 4) << "it swings";
    EXPECT_LT(double{glm::length(end.spin)}, 0.6 * fastest) << "and calms down";
    EXPECT_LT(glm::length(end.pose.toWorld(corner) - to), 0.01F);
    EXPECT_EQ(t.stats().bodyStrays, 0U);
}

// A light ball is held under water, drawn through it at 1.5 m/s, lifted out at 2 m/s and let go. It moves as on the cpu; the spring holds
// it above the hand as far as the water lifts it, and let go it has the hand's velocity and rises as high as that gives.
TEST_P(Held, ALightBallIsDrawnThroughWaterAndThrown) {
    Scenario s;
    s.addBall(0.1F, vec3(0.3F, 0.2F, 0.25F), vec3(0.0F), 0.5F, 0.1F);
    s.bodies[0].shape = sphereShape(0.1F, 200, 0.05F);
    s.bodies[0].meetsWater = true;
    s.step = static_cast<float>(kFrame / 4);
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.box.max = vec3(1.2F, 1.4F, 0.5F);
    p.blocks = {{vec3(0), vec3(1.2F, 0.4F, 0.5F), vec3(0.0F)}};
    p.fixedStep = s.step;
    Twice t(GetParam(), s, p);
    if (!t.absent.empty()) GTEST_SKIP() << t.absent;
    vec3 to = s.bodies[0].state.pose.position;
    const auto hand = [&] { return BodyPull{.body = 0, .at = vec3(0.0F), .to = to}; };
    for (int frame = 0; frame < 25; ++frame) t.frame(hand());
    const double above = double{t.onGpu().pose.position.y - to.y};
    // The spring carries what the water does.
    const double lifted = t.force().y / (double{s.bodies[0].shape.mass} * 24 * 24);
    const double heldOff = t.off, heldMisjudged = std::exchange(t.misjudged, 0.0);
    for (int frame = 0; frame < 24; ++frame) {
        to.x += 1.5F * static_cast<float>(kFrame);
        t.frame(hand());
    }
    const double drawnOff = t.off, drawnMisjudged = std::exchange(t.misjudged, 0.0);
    for (int frame = 0; frame < 21; ++frame) {
        to.y += 2.0F * static_cast<float>(kFrame);
        t.frame(hand());
    }
    const BodyState let = t.onGpu();
    float top = let.pose.position.y;
    for (int frame = 0; frame < 15; ++frame) {
        t.frame(std::nullopt);
        top = std::max(top, t.onGpu().pose.position.y);
    }
    const double rise = double{let.velocity.y} * double{let.velocity.y} / (2 * 9.81);
    std::printf(
        "%s: held %.4f m above the hand (%.4f m by its lift), %.1e m off the cpu's; drawn %.1e m; thrown %.1e m, %.1e m/s; expected to "
        "%.1e m, drawn %.1e m, thrown %.1e m; let go at %.3f m/s it rises %.4f m (%.4f m); %llu strays\n",
        GetParam(), above, lifted, heldOff, drawnOff, t.off, t.fastOff, heldMisjudged, drawnMisjudged, t.misjudged, double{let.velocity.y},
        double{top - let.pose.position.y}, rise, static_cast<unsigned long long>(t.stats().bodyStrays));
    EXPECT_NEAR(above, lifted, 0.1 * lifted);
    EXPECT_LT(t.off, 0.02);
    EXPECT_LT(std::max(drawnMisjudged, t.misjudged), 0.03);
    EXPECT_NEAR(let.velocity.y, 2, 0.1F);
    EXPECT_NEAR(double{top - let.pose.position.y}, rise, 0.02 * rise + 0.005);
}

// A hand draws a box into a wall, to a place behind it, and then along it: the box stops at the wall, sticks to it as Coulomb's law says,
// and then slides. In the end it is where it is on the cpu, where contacts without a memory let it creep before. Let go, it does not jump
// off.
TEST_P(Held, ABoxIsDrawnAgainstAWall) {
    Scenario s;
    s.gravity = vec3(0.0F);
    constexpr float kFriction = 0.3F;
    s.addBox(vec3(0.2F), vec3(2.4F, 1, 0), kFriction);
    Twice t(GetParam(), s, body_rig::paramsOf(s));
    if (!t.absent.empty()) GTEST_SKIP() << t.absent;
    float deepest = 0, stuck = 0, beyond = 0;  // m: how far it moved while it had to stick; the offset of the hand at which it slid
    std::optional<float> from;
    const vec3 grip(0.02F, 0.03F, 0.01F);
    vec3 to(2.4F, 1, 0);
    for (int frame = 0; frame < 80; ++frame) {
        if (frame < 20) to.x += 0.05F;  // 3 m/s, to 3.4 m: the wall is at 3 m
        if (frame >= 30) to.y += 0.01F;
        t.frame(BodyPull{.body = 0, .at = grip, .to = to});
        const BodyState now = t.onGpu();
        deepest = std::max(deepest, now.pose.position.x - 2.9F);
        if (frame < 30) continue;
        if (!from) from = now.pose.position.y;
        const vec3 off = to - now.pose.toWorld(grip);
        if (std::hypot(off.y, off.z) < 0.95F * kFriction * off.x) stuck = std::max(stuck, std::abs(now.pose.position.y - *from));
        beyond = std::max(beyond, off.y / off.x);
    }
    const BodyState there = t.onGpu();
    const double off = apart(there, t.onCpu());
    for (int frame = 0; frame < 20; ++frame) t.frame(std::nullopt);
    const vec3 away = t.onGpu().velocity;
    std::printf(
        "%s: %.1e m in the wall; it sticks to %.1e m and slides at %.3f; %.1e m off the cpu's, expected to %.1e m; %.1e m/s off the wall\n",
        GetParam(), double{deepest}, double{stuck}, double{beyond}, off, t.misjudged, double{-away.x});
    EXPECT_LT(deepest, 2.0e-3F);
    EXPECT_GT(there.pose.position.x, 2.89F) << "it stays there";
    EXPECT_GT(there.pose.position.y, 1.2F) << "and slides";
    EXPECT_LT(stuck, 5.0e-3F);
    EXPECT_NEAR(beyond, kFriction, 0.15F) << "sliding, the spring's damping adds to it";
    EXPECT_LT(off, 0.02);
    EXPECT_LT(t.misjudged, 0.03);
    EXPECT_LT(std::abs(away.x), 0.1F);
}

// A held ball pushes a free box before it, without gravity and water: in each step the momentum of both grows by the impulse of the hand,
// and the box moves as on the cpu.
TEST_P(Held, ABallPushesABox) {
    Scenario s;
    s.gravity = vec3(0.0F);
    s.addBall(0.1F, vec3(0, 1, 0), vec3(0.0F), 0.5F, 0);
    s.addBox(vec3(0.2F, 0.3F, 0.3F), vec3(0.3F, 1, 0), 0.5F);
    Twice t(GetParam(), s, body_rig::paramsOf(s));
    if (!t.absent.empty()) GTEST_SKIP() << t.absent;
    t.length = double{s.step};  // a step in each frame, so that all states are known
    const auto momentum = [&] {
        dvec3 sum(0.0);
        for (size_t k = 0; k < 2; ++k) sum += double{s.bodies[k].shape.mass} * dvec3(t.onGpu(k).velocity);
        return sum;
    };
    vec3 to(0, 1, 0);
    t.frame(BodyPull{.body = 0, .at = vec3(0.0F), .to = to});
    double error = 0, boxOff = 0;
    for (int frame = 0; frame < 120; ++frame) {
        to.x += 0.01F;
        const BodyPull pull{.body = 0, .at = vec3(0.0F), .to = to};
        const dvec3 impulse = double{s.bodies[0].shape.mass} * t.length * springOf(pull, s.bodies[0].shape, t.onGpu(), t.length),
                    before = momentum();
        t.frame(pull);
        error = std::max(error, glm::length(momentum() - before - impulse));
        EXPECT_EQ(t.substeps(), 1);
        boxOff = std::max(boxOff, apart(t.onGpu(1), t.onCpu(1)));
    }
    const double all = glm::length(momentum());
    std::printf("%s: momentum to %.1e of %.2f N s, ball %.1e m, box %.1e m off the cpu's, expected to %.1e m\n", GetParam(), error / all,
                all, t.off, boxOff, t.misjudged);
    EXPECT_LT(error, 1.0e-5 * all);
    EXPECT_GT(t.onGpu(1).velocity.x, 1.0F) << "the box is pushed";
    EXPECT_LT(t.off, 0.02);
    EXPECT_LT(boxOff, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Devices, Held, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });

// Without the function that predicts, a host cannot know where what it holds will be.
TEST(HeldBodies, NeedPredictions) {
    const std::unique_ptr<Device> cpu = makeTestCpu();
    Scenario s;
    s.addBall(0.1F, vec3(0, 1, 0), vec3(0.0F), 0.5F, 0);
    BulletSolids contacts({.box = body_rig::paramsOf(s).box, .planes = {}, .still = {}, .moving = {}, .poses = {}}, s.bodies, s.forms);
    Solids solids{.bodies = s.bodies, .bodyHost = contacts.host()};
    solids.bodyHost.predict = nullptr;
    const auto made = FluidWorld::create(*cpu, body_rig::paramsOf(s), solids, {});
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().message.find("predict"), std::string::npos) << made.error().message;
}

}  // namespace
}  // namespace rivulet::held_bodies_test
