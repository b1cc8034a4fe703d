// Bodies in contact on a GPU that is two frames behind: they move as mechanics says, and nothing waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "fluid/scene/solids_bullet.h"
#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "shaders/fluid/solids/body_state.h"
#include "tests/parity/body_rig.h"
#include "tests/parity/devices.h"
#include "tests/parity/late_device.h"

namespace rivulet::body_contacts_test {
namespace {

using body_rig::kFrame, body_rig::kGravity, body_rig::kTurn, body_rig::Rig, body_rig::Scenario;

class BodyContacts : public testing::TestWithParam<const char*> {};
class MoreBodyContacts : public BodyContacts {};  // on one device, whose kernels are those of the other

// A box falls flat, another on an edge: they come to rest on the floor, and do not sink in.
TEST_P(BodyContacts, ABoxRestsOnTheFloor) {
    Scenario s;
    s.addBox(vec3(0.2F), vec3(0, 0.4F, 0), 0.5F);
    s.addBox(vec3(0.3F, 0.2F, 0.1F), vec3(1, 0.5F, 0), 0.5F, glm::angleAxis(0.5F, glm::normalize(vec3(1, 0.3F, 0.8F))));
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    double lowest = 1;
    for (int frame = 0; frame < 180; ++frame) {
        rig.frame();
        if (frame > 30) lowest = std::min(lowest, rig.place().y);
    }
    std::printf("%s: at %.6f m, lowest %.6f m, %.1e m/s, %.1e rad; the other at %.6f m, %.1e m/s\n", GetParam(), rig.place().y, lowest,
                glm::length(rig.velocity()), rig.turned(), rig.place(1).y, glm::length(rig.velocity(1)));
    EXPECT_NEAR(rig.place().y, 0.1, 2.0e-4);
    EXPECT_GT(lowest, 0.099);
    EXPECT_LT(rig.turned(), 0.01);
    EXPECT_LT(glm::length(rig.velocity()), 2.0e-3);
    EXPECT_NEAR(rig.place(1).y, rig.place(1).y < 0.075 ? 0.05 : 0.1, 2.0e-4) << "on a face";
    EXPECT_LT(glm::length(rig.velocity(1)), 2.0e-3);
}

// A box on a slope of 20 degrees: with a friction of 0.5 it sticks, with 0.2 it slides by Coulomb's law.
TEST_P(MoreBodyContacts, ABoxSlidesByCoulombsLaw) {
    for (const float friction : {0.5F, 0.2F}) {
        const double angle = 20 * double{kTurn};
        const quat turned = glm::angleAxis(20 * kTurn, vec3(0, 0, 1));  // x points up the slope
        const vec3 n = turned * vec3(0, 1, 0), start(0, 1.5F, 0);
        Scenario s;
        s.planes = {{start, n}};
        s.addBox(vec3(0.3F, 0.1F, 0.2F), start + 0.05F * n, friction, turned);
        Rig rig(GetParam(), s);
        if (!rig.world) GTEST_SKIP() << rig.absent;
        const int frames = 60;
        for (int frame = 0; frame < frames; ++frame) rig.frame();
        const double seconds = rig.world->time(), way = glm::length(rig.place() - dvec3(s.bodies[0].state.pose.position));
        const double steps = seconds / double{s.step};  // symplectic Euler
        const double law = 0.5 * kGravity * (std::sin(angle) - double{friction} * std::cos(angle)) * seconds * seconds * (1 + 1 / steps);
        std::printf("%s, friction %.1f: %.5f m, by Coulomb %.5f m; turned %.1e rad\n", GetParam(), double{friction}, way,
                    std::max(law, 0.0), rig.turned());
        EXPECT_LT(rig.turned(), 2.0e-3);
        if (law < 0)
            EXPECT_LT(way, 5.0e-4) << "it sticks";
        else
            EXPECT_NEAR(way, law, 0.01 * law);
    }
}

// A ball that falls from 1 m comes back to e^2 of it, and to e^4 after the second blow.
TEST_P(BodyContacts, ABallBouncesByItsRestitution) {
    constexpr double kBounce = 0.8;
    Scenario s;
    s.addBall(0.1F, vec3(0, 1.1F, 0), vec3(0.0F), 0.5F, static_cast<float>(kBounce));
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    std::vector<double> tops, lows;
    double before = 1.1, last = 1.1;
    for (int frame = 0; frame < 140; ++frame) {
        rig.frame();
        const double now = rig.place().y;
        if (last > before && last > now) {  // the top of the parabola through the frames
            const DeviceBody& row = rig.row();
            tops.push_back(now + 0.5 * double{row.velocity.y} * double{row.velocity.y} / kGravity - 0.1);
        }
        lows.push_back(now);
        before = last;
        last = now;
    }
    ASSERT_GE(tops.size(), 2U);
    std::printf("%s: %.4f m (%.4f), %.4f m (%.4f), lowest %.4f m\n", GetParam(), tops[0], kBounce * kBounce, tops[1], std::pow(kBounce, 4),
                *std::ranges::min_element(lows));
    EXPECT_NEAR(tops[0], kBounce * kBounce, 0.02);
    EXPECT_NEAR(tops[1], std::pow(kBounce, 4), 0.02);
    EXPECT_GT(*std::ranges::min_element(lows), 0.0995);
}

// A solid ball rolls down a slope at 5/7 of g sin, without slip.
TEST_P(MoreBodyContacts, ABallRollsDownASlope) {
    const double angle = 10 * double{kTurn};
    const quat turned = glm::angleAxis(10 * kTurn, vec3(0, 0, 1));
    const vec3 n = turned * vec3(0, 1, 0), start(0, 1.5F, 0);
    Scenario s;
    s.planes = {{start, n}};
    s.addBall(0.1F, start + 0.1F * n, vec3(0.0F), 0.5F, 0.0F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    const int frames = 60;
    for (int frame = 0; frame < frames; ++frame) rig.frame();
    const double seconds = rig.world->time(), way = glm::length(rig.place() - dvec3(s.bodies[0].state.pose.position));
    // sphereShape's inertia is that of a solid ball, 2/5 m r^2, as its samples have it.
    const BodyShape& shape = s.bodies[0].shape;
    const double inertia = double{shape.inertia.x} / (double{shape.mass} * 0.01);
    const double law = 0.5 * kGravity * std::sin(angle) / (1 + inertia) * seconds * seconds * (1 + double{s.step} / seconds);
    const double rim = glm::length(dvec3(vec3(rig.row().spin))) * 0.1;
    std::printf("%s: %.5f m, by the law %.5f m (I = %.4f m r^2); rim %.4f m/s, middle %.4f m/s\n", GetParam(), way, law, inertia, rim,
                glm::length(rig.velocity()));
    EXPECT_NEAR(inertia, 0.4, 1.0e-4);
    EXPECT_NEAR(way, law, 0.005 * law);
    EXPECT_NEAR(rim, glm::length(rig.velocity()), 1.0e-3);
}

// Two balls of other masses meet, without gravity: the momentum stays, and they part by the product of their restitutions.
TEST_P(BodyContacts, BallsPartByTheirRestitution) {
    Scenario s;
    s.gravity = vec3(0.0F);
    s.addBall(0.1F, vec3(-0.5F, 1, 0), vec3(2, 0, 0), 0.0F, 0.8F);
    s.addBall(0.15F, vec3(0.5F, 1, 0), vec3(-1, 0, 0), 0.0F, 0.75F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    const double one = s.bodies[0].shape.mass, other = s.bodies[1].shape.mass, before = 2 * one - other;
    for (int frame = 0; frame < 40; ++frame) rig.frame();
    const double after = one * rig.velocity(0).x + other * rig.velocity(1).x;
    const double parting = rig.velocity(1).x - rig.velocity(0).x;
    std::printf("%s: momentum %.1e of it off, %.5f m/s apart (%.5f)\n", GetParam(), std::abs(after - before) / one, parting, 3 * 0.6);
    EXPECT_NEAR(after, before, 2.0e-6 * one);
    EXPECT_NEAR(parting, 3 * 0.6, 1.0e-4);
    for (const size_t k : {size_t{0}, size_t{1}}) EXPECT_LT(std::abs(rig.velocity(k).y) + std::abs(rig.velocity(k).z), 1.0e-3);
}

// Five boxes on each other stand for 3 s.
TEST_P(MoreBodyContacts, AStackStands) {
    Scenario s;
    for (int k = 0; k < 5; ++k) s.addBox(vec3(0.2F), vec3(0, 0.1F + 0.2F * static_cast<float>(k), 0), 0.5F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    for (int frame = 0; frame < 180; ++frame) rig.frame();
    double aside = 0, sunk = 0;
    for (size_t k = 0; k < 5; ++k) {
        aside = std::max(aside, std::hypot(rig.place(k).x, rig.place(k).z));
        sunk = std::max(sunk, 0.1 + 0.2 * static_cast<double>(k) - rig.place(k).y);
    }
    std::printf("%s: the farthest %.2e m aside, the top %.2e m sunk, %.1e m/s\n", GetParam(), aside, sunk, glm::length(rig.velocity(4)));
    EXPECT_LT(aside, 1.0e-3) << "they do not creep";
    EXPECT_LT(sunk, 5.0e-4);
    EXPECT_LT(glm::length(rig.velocity(4)), 0.02) << "nor rock";
}

// A thin floor of triangles: a ball that falls on it at 3 m/s, a box that falls on a corner of its own, and a ball that rolls over its
// edges and is not held up by them.
TEST_P(BodyContacts, AThinMeshHolds) {
    std::vector<vec3> corners;
    std::vector<uint32_t> faces;
    constexpr uint32_t kAcross = 20;
    for (uint32_t z = 0; z <= kAcross; ++z)
        for (uint32_t x = 0; x <= kAcross; ++x)
            corners.emplace_back(-1 + 0.1F * static_cast<float>(x), 1.0F, -1 + 0.1F * static_cast<float>(z));
    for (uint32_t z = 0; z < kAcross; ++z)
        for (uint32_t x = 0; x < kAcross; ++x) {
            const uint32_t a = z * (kAcross + 1) + x, b = a + kAcross + 1;
            for (const uint32_t k : {a, b, a + 1, a + 1, b, b + 1}) faces.push_back(k);
        }
    Scenario s;
    s.still = {MeshView{corners, faces, {}, {}}};
    s.addBall(0.05F, vec3(0, 1.5F, 0), vec3(0, -3, 0), 0.5F, 0.0F);
    s.addBox(vec3(0.12F), vec3(0.5F, 1.4F, 0.5F), 0.5F, glm::angleAxis(0.7F, glm::normalize(vec3(1, 0.2F, 0.6F))));
    s.addBall(0.05F, vec3(-0.9F, 1.05F, -0.53F), vec3(1, 0, 0.1F), 0.5F, 0.0F);
    s.bodies[2].state.spin = vec3(2, 0, -20);  // it rolls
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    double ball = 2, box = 2, rolling = 2, highest = 0;
    for (int frame = 0; frame < 90; ++frame) {
        rig.frame();
        ball = std::min(ball, rig.place(0).y);
        box = std::min(box, rig.place(1).y);
        if (frame < 75) {
            rolling = std::min(rolling, rig.place(2).y);
            highest = std::max(highest, rig.place(2).y);
        }
        if (frame == 74)
            std::printf("%s: ball not below %.5f m, box %.5f m, rolling between %.6f and %.6f m at %.4f m/s\n", GetParam(), ball, box,
                        rolling, highest, glm::length(rig.velocity(2)));
        if (frame == 74) EXPECT_NEAR(glm::length(rig.velocity(2)), std::hypot(1, 0.1), 1.0e-3);
    }
    EXPECT_GT(ball, 1.045);
    EXPECT_NEAR(rig.place(0).y, 1.05, 5.0e-4);
    EXPECT_GT(box, 1.05);
    EXPECT_NEAR(rig.place(1).y, 1.06, 1.0e-3);
    EXPECT_NEAR(rolling, 1.05, 1.0e-4);
    EXPECT_NEAR(highest, 1.05, 1.0e-4);
}

// A plate moves at 0.5 m/s and pushes a box along the floor, with friction: the box has its speed and stays before it.
TEST_P(MoreBodyContacts, AMovingSolidPushes) {
    const std::vector<vec3> corners = {{0, 0, -0.5F}, {0, 0.5F, -0.5F}, {0, 0.5F, 0.5F}, {0, 0, 0.5F}};
    const std::vector<uint32_t> faces = {0, 1, 2, 0, 2, 3};
    Scenario s;
    s.moving = {MeshView{corners, faces, {}, {}}};
    s.poses = {Pose{vec3(-0.5F, 0.02F, 0)}};
    s.addBox(vec3(0.2F), vec3(0, 0.1F, 0), 0.3F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    double through = 0;
    for (int frame = 0; frame < 150; ++frame) {
        const Pose next{vec3(static_cast<float>(-0.5 + 0.5 * (frame + 1) * kFrame), 0.02F, 0)};
        rig.contacts->moveTo(std::span(&next, 1), kFrame);
        rig.frame();
        through = std::max(through, double{next.position.x} + 0.1 - rig.place().x);
    }
    std::printf("%s: %.5f m/s, overlap at most %.1e m, the box is %.1e m before it\n", GetParam(), rig.velocity().x, through,
                rig.place().x - 0.1 - 0.75);
    EXPECT_NEAR(rig.velocity().x, 0.5, 0.01);
    EXPECT_LT(through, 1.0e-3);
    EXPECT_NEAR(rig.place().x, 0.85, 3.0e-3);
    EXPECT_NEAR(rig.place().y, 0.1, 1.0e-3);
}

// A box falls into a pool, turned and beside a wall that it touches. It is where the host has it, as far as rounding lets a splash be
// compared, is never in the wall, and comes to float as deep.
TEST_P(MoreBodyContacts, ABoxSplashesInBesideAWall) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.box.max = vec3(0.5F, 0.8F, 0.5F);
    p.blocks = {{vec3(0), vec3(0.5F, 0.25F, 0.5F), vec3(0.0F)}};
    std::vector<Body> bodies(1);
    bodies[0].shape = boxShape(vec3(0.2F, 0.1F, 0.2F), 500, p.spacing);
    bodies[0].state = {{vec3(0.36F, 0.45F, 0.25F), glm::angleAxis(0.4F, vec3(0, 0, 1))}, vec3(0.8F, 0, 0), vec3(0.0F)};
    BodyForm form;
    form.size = vec3(0.2F, 0.1F, 0.2F);
    form.friction = 0.3F;
    form.restitution = 0;
    const BulletSolids::Scene scene{.box = p.box, .planes = {}, .still = {}, .moving = {}, .poses = {}};
    BulletSolids contacts(scene, bodies, std::span(&form, 1)), others(scene, bodies, std::span(&form, 1));
    LateDevice late(*gpu->device, 1);
    const std::unique_ptr<Device> cpu = makeTestCpu();
    auto ahead = FluidWorld::create(late, p, {.bodies = bodies, .bodyHost = contacts.host()}, {});
    auto exact = FluidWorld::create(*cpu, p, {.bodies = bodies, .bodyHost = others.host()}, {});
    ASSERT_TRUE(ahead && exact);
    double off = 0, in = 0, depth = 0, depthOfHost = 0;
    constexpr int kFrames = 120;
    for (int frame = 0; frame < kFrames; ++frame) {
        (*ahead)->step({.gravity = p.gravity}, kFrame);
        late.frameEnds();
        (*exact)->step({.gravity = p.gravity}, kFrame);
        const DeviceBody& d = late.rows.back()[0];
        const Pose pose{vec3(d.position), quat(d.rotation.w, d.rotation.x, d.rotation.y, d.rotation.z)};
        for (int k = 0; k < 8; ++k) in = std::max(in, double{pose.toWorld(form.size * (vec3(k & 1, (k >> 1) & 1, k >> 2) - 0.5F)).x} - 0.5);
        const vec3 host = (*exact)->bodies()[0].pose.position;
        if (frame < 20) off = std::max(off, double{glm::length(pose.position - host)});
        if (frame >= kFrames / 2) {
            depth += double{pose.position.y} * 2 / kFrames;
            depthOfHost += double{host.y} * 2 / kFrames;
        }
    }
    std::printf("%s: %.1e m off as it falls in, %.1e m in the wall; floats at %.4f m, the host's at %.4f m\n", GetParam(), off, in, depth,
                depthOfHost);
    EXPECT_EQ(late.reads, 0U);
    EXPECT_LT(off, 0.2 * double{p.spacing});
    EXPECT_LT(in, 1.0e-3);
    EXPECT_NEAR(depth, depthOfHost, 0.2 * double{p.spacing});
}

// The scene of nine ducks that touch each other and the tank: nothing waits for a GPU that is two frames behind.
TEST_P(BodyContacts, DucksWaitForNothing) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const Result<SceneFile> scene = loadScene("rubber_ducks", std::vector<std::string>{"fluid.spacing=0.08", "fluid.fixedStep=0.0041666"});
    ASSERT_TRUE(scene) << scene.error().message;
    LateDevice late(*gpu->device, scene->bodies.size());
    auto session = Session::create(*scene, late, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int frame = 0; frame < 24; ++frame) {
        (*session)->step(kFrame, false);
        late.frameEnds();
    }
    const bool cl = std::string(GetParam()) == "cl";
    EXPECT_LE((*session)->world().stats().bodyWaits, cl ? 1U : 0U) << "1: a session on cl keeps a state from which the cpu can go on";
    if (!cl) EXPECT_EQ(late.reads, 0U);
    std::printf("%s: %llu strays\n", GetParam(), static_cast<unsigned long long>((*session)->world().stats().bodyStrays));
    for (const DeviceBody& d : late.rows.back()) {
        const vec3 at(d.position);
        EXPECT_TRUE(at.x > 0 && at.x < 1.2F && at.y > 0 && at.y < 0.6F && at.z > 0 && at.z < 0.5F) << at.x << " " << at.y << " " << at.z;
    }
}

// Boards that lie on each other or end to end, within 0.2 mm and 0.5 mrad: no contact is found at which they overlap by more than they do.
// Of some of these pairs Bullet reports a direction along which they overlap by their length.
TEST(ContactSearch, NoContactIsDeeperThanTheOverlap) {
    const vec3 size(0.02F, 0.2F, 0.1F);
    Scenario s;
    for (int k = 0; k < 2; ++k) s.addBox(size, vec3(0.0F), 0.5F);
    BoxParams box;
    box.min = vec3(-3.0F);
    box.max = vec3(3.0F);
    BulletSolids search(BulletSolids::Scene{.box = box, .planes = {}, .still = {}, .moving = {}, .poses = {}}, s.bodies, s.forms);
    const BodyHost host = search.host();
    std::mt19937 random(2);
    const auto any = [&random] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    float deepest = 0;
    size_t found = 0;
    constexpr int kPairs = 4000;
    for (int n = 0; n < kPairs; ++n) {
        // Where the second is from the first: beside its broad face, or beyond its end.
        vec3 offset = size * vec3(0.9F * any(), 0.9F * any(), 0.9F * any());
        const int axis = n % 2;
        offset[axis] = size[axis] + 1.0e-4F * (any() - 1);
        const quat about = glm::normalize(quat(any(), any(), any(), any()));
        std::vector<BodyState> states(2);
        states[0].pose.rotation = about;
        states[1].pose = {about * offset, about * glm::normalize(quat(1, 2.5e-4F * any(), 2.5e-4F * any(), 2.5e-4F * any()))};
        const std::vector<vec4> balls = {vec4(0, 0, 0, 0.01F), vec4(states[1].pose.position, 0.01F)};
        std::vector<BodyContact> contacts;
        ASSERT_TRUE(host.contacts(host.self, states, balls, kFrame, contacts));
        found += std::min<size_t>(contacts.size(), 1);
        for (const BodyContact& c : contacts) {
            const Pose &a = states[c.a].pose, &b = states[c.b].pose;
            deepest = std::min(deepest, glm::dot(a.toWorld(c.onA) - b.toWorld(c.onB), b.rotation * c.normal));
        }
    }
    std::printf("the deepest contact overlaps by %.2e m\n", double{-deepest});
    EXPECT_EQ(found, size_t{kPairs}) << "contacts of each pair";
    EXPECT_GT(deepest, -5.0e-4F);
}

INSTANTIATE_TEST_SUITE_P(Devices, BodyContacts, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });
INSTANTIATE_TEST_SUITE_P(Devices, MoreBodyContacts, testing::Values("cl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::body_contacts_test
