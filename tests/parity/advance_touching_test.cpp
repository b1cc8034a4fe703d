// The kernel that moves bodies in contact, against the law of impact, and the rows that the host gives it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/solids/body_contacts.h"
#include "fluid/sim/solids/body_shapes.h"
#include "shaders/fluid/solids/body_state.h"
#include "tests/parity/devices.h"
#include "tests/parity/touching.h"

namespace rivulet::advance_touching_test {
namespace {

class AdvanceTouching : public testing::TestWithParam<const char*> {};

// Bodies of any inertia meet in one point each, at any angle: velocities and spins after the blow are those that the law of impact gives in
// double, (1 + e) of the speed of approach over what resists it, without friction.
TEST_P(AdvanceTouching, ABlowIsThatOfMechanics) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    std::mt19937 random(11);
    const auto any = [&random] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    constexpr size_t kPairs = 80;
    Touching t;
    t.step.dt = 1.0e-5F;
    for (size_t k = 0; k < 2 * kPairs; ++k) {
        Body b;
        b.shape.mass = 2 + any();
        b.shape.inertia = vec3(0.03F) + 0.01F * vec3(any(), any(), any());
        b.state = {{vec3(any(), any(), any()), glm::normalize(quat(any(), any(), any(), any()))},
                   vec3(any(), any(), any()),
                   2.0F * vec3(any(), any(), any())};
        t.bodies.push_back(b);
    }
    for (uint32_t k = 0; k < kPairs; ++k) {
        BodyContact c;
        c.a = 2 * k;
        c.b = k % 4 == 0 ? BodyContact::kSolid : 2 * k + 1;
        const BodyState& a = t.bodies[c.a].state;
        BodyState& b = t.bodies[2 * k + 1].state;
        c.onA = 0.1F * vec3(any(), any(), any());
        const vec3 at = a.pose.toWorld(c.onA), arm = 0.1F * vec3(any(), any(), any());
        b.pose.position = at - arm;
        const vec3 n = glm::normalize(a.velocityAt(at) - b.velocityAt(at)) * -1.0F;
        const vec3 normal = glm::normalize(n + 0.4F * vec3(any(), any(), any()));
        const bool solid = c.b == BodyContact::kSolid;
        c.onB = solid ? at : b.pose.toOwn(at);
        c.normal = solid ? normal : glm::conjugate(b.pose.rotation) * normal;
        c.velocityB = solid ? b.velocityAt(at) : vec3(0.0F);
        c.secondsB = 1;
        c.friction = 0;
        c.restitution = 0.5F + 0.5F * any();
        t.contacts.push_back(c);
    }
    const std::vector<DeviceBody> got = t.run(*gpu->device);
    double speed = 0, spin = 0, biggest = 0;
    for (const BodyContact& c : t.contacts) {
        const bool solid = c.b == BodyContact::kSolid;
        const size_t other = c.a + 1;
        const BodyState &a = t.bodies[c.a].state, &b = t.bodies[other].state;
        const dvec3 n(solid ? c.normal : b.pose.rotation * c.normal);
        const dvec3 at(a.pose.toWorld(c.onA)), armA = at - dvec3(a.pose.position), armB = at - dvec3(b.pose.position);
        const auto times = [&](size_t k, const dvec3& v) {  // the inverse of its inertia
            const dmat3 r = glm::mat3_cast(dquat(t.bodies[k].state.pose.rotation));
            return r * ((glm::transpose(r) * v) / dvec3(t.bodies[k].shape.inertia));
        };
        const dvec3 turnA = times(c.a, glm::cross(armA, n)), turnB = solid ? dvec3(0.0) : times(other, glm::cross(armB, n));
        double k = 1 / double{t.bodies[c.a].shape.mass} + glm::dot(n, glm::cross(turnA, armA));
        if (!solid) k += 1 / double{t.bodies[other].shape.mass} + glm::dot(n, glm::cross(turnB, armB));
        const double approach = -glm::dot(n, dvec3(a.velocityAt(vec3(at))) - dvec3(b.velocityAt(vec3(at))));
        const double bounce = approach > 0.2 ? double{c.restitution} : 0.0;
        const double impulse = std::max(approach, 0.0) * (1 + bounce) / k;
        biggest = std::max(biggest, impulse);
        const auto check = [&](size_t body, const dvec3& push, const dvec3& turn) {
            const BodyState& was = t.bodies[body].state;
            const double mass = t.bodies[body].shape.mass;
            speed = std::max(speed, glm::length(dvec3(vec3(got[body].velocity)) - dvec3(was.velocity) - push / mass));
            spin = std::max(spin, glm::length(dvec3(vec3(got[body].spin)) - dvec3(was.spin) - turn));
        };
        check(c.a, impulse * n, impulse * turnA);
        check(other, solid ? dvec3(0.0) : -impulse * n, -impulse * turnB);
    }
    std::printf("%s: speeds to %.1e m/s, spins to %.1e rad/s; impulses of up to %.2f N s\n", GetParam(), speed, spin, biggest);
    EXPECT_LT(speed, 1.0e-4);
    EXPECT_LT(spin, 1.0e-3);
    EXPECT_GT(biggest, 1);
}

// A box meets the floor with a face, an edge or a corner, at once and turned by any angle about the vertical: the velocity and spin after
// the blow are those of the law of impact in double. A face has four contacts, and leaves without any spin.
TEST_P(AdvanceTouching, ABoxBouncesByTheLaw) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const vec3 half(0.06F, 0.05F, 0.04F);
    Touching t;
    t.step.dt = 1.0e-5F;
    struct Law {
        double speed, spin;
    };
    std::vector<Law> laws;
    for (const float e : {0.1F, 0.5F, 0.9F})
        for (const float speed : {3.2F, 60.0F})
            for (const int corners : {4, 2, 1})
                for (const float about : {0.0F, 0.3F, 1.1F}) {
                    Body b;
                    b.shape = boxShape(2.0F * half, 500, 0.05F);
                    quat turned = glm::angleAxis(about, vec3(0, 1, 0));
                    if (corners < 4) turned = turned * glm::angleAxis(0.5F, vec3(0, 0, 1));
                    if (corners < 2) turned = turned * glm::angleAxis(0.4F, vec3(1, 0, 0));
                    b.state = {{vec3(static_cast<float>(t.bodies.size()), 0, 0), turned}, vec3(0, -speed, 0), vec3(0.0F)};
                    std::vector<vec3> own;
                    for (int k = 0; k < 8; ++k) own.push_back(half * (2.0F * vec3(k & 1, (k >> 1) & 1, k >> 2) - 1.0F));
                    std::ranges::sort(own, {}, [&](const vec3& p) { return (turned * p).y; });
                    own.resize(static_cast<size_t>(corners));
                    for (const vec3& p : own) {
                        BodyContact c;
                        c.a = static_cast<uint32_t>(t.bodies.size());
                        c.onA = p;
                        c.onB = b.state.pose.toWorld(p);
                        c.normal = vec3(0, 1, 0);
                        c.friction = 0;
                        c.restitution = e;
                        t.contacts.push_back(c);
                    }
                    // Two corners of an edge share the blow: it is that of a point between them.
                    dvec3 arm(0.0);
                    for (const vec3& p : own) arm += dvec3(turned * p) / static_cast<double>(corners);
                    const dmat3 r = glm::mat3_cast(dquat(turned));
                    const dvec3 up(0, 1, 0), turn = r * ((glm::transpose(r) * glm::cross(arm, up)) / dvec3(b.shape.inertia));
                    const double impulse =
                        double{speed} * (1 + double{e}) / (1 / double{b.shape.mass} + glm::dot(up, glm::cross(turn, arm)));
                    laws.push_back({impulse / double{b.shape.mass} - double{speed}, glm::length(turn) * impulse});
                    t.bodies.push_back(b);
                }
    const std::vector<DeviceBody> got = t.run(*gpu->device);
    double speed = 0, spin = 0;
    for (size_t k = 0; k < laws.size(); ++k) {
        const double scale = double{-t.bodies[k].state.velocity.y};
        speed = std::max(speed, std::abs(double{got[k].velocity.y} - laws[k].speed) / scale);
        spin = std::max(spin, std::abs(glm::length(dvec3(vec3(got[k].spin))) - laws[k].spin) * double{half.x} / scale);
    }
    std::printf("%s: speeds to %.1e, spins at a corner to %.1e of the blow's speed\n", GetParam(), speed, spin);
    EXPECT_LT(speed, 1.0e-3);
    EXPECT_LT(spin, 1.0e-3);
}

// A solid turns and moves on in the frame: a body meets it where its point is by then, at that point's velocity and normal. Where its time
// is over, it rests.
TEST_P(AdvanceTouching, ASolidTurnsInTheFrame) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const vec3 centre(1, 2, 3), spin(0, 0, 20), velocity(0.5F, 0, 0), at = centre + vec3(0.3F, 0, 0);
    for (const float seconds : {0.1F, 0.02F}) {
        Touching t;
        t.step.dt = 1.0e-5F;
        t.passed = 0.05F;
        const float moved = std::min(seconds, t.passed);
        const quat turned = glm::angleAxis(20 * moved, vec3(0, 0, 1));
        const vec3 there = centre + moved * velocity + turned * (at - centre), n = turned * vec3(0, 1, 0);
        const vec3 fast = seconds > t.passed ? velocity + glm::cross(spin, there - centre - moved * velocity) : vec3(0.0F);
        Body b;
        b.shape = sphereShape(0.1F, 500, 0.05F);
        b.state.pose.position = there + 0.1F * n;
        b.state.velocity = -3.0F * n;
        t.bodies = {b};
        BodyContact c;
        c.radiusA = 0.1F;
        c.onB = at;
        c.normal = vec3(0, 1, 0);
        c.velocityB = velocity;
        c.spinB = spin;
        c.centreB = centre;
        c.secondsB = seconds;
        c.friction = 0;
        t.contacts = {c};
        const vec3 got(t.run(*gpu->device)[0].velocity);
        EXPECT_LT(glm::length(got - glm::dot(fast, n) * n), 1.0e-3F) << got.x << " " << got.y << " " << got.z;
    }
}

// Bodies without contacts move as advance_bodies moves them, under loads, too.
TEST_P(AdvanceTouching, WhatTouchesNothingMovesFreely) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    std::mt19937 random(5);
    const auto any = [&random] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    Touching t;
    t.step.dt = 2.0e-3F;
    t.step.gravity = vec4(0, -9.81F, 0, 0);
    std::vector<BodyState> states;
    for (int k = 0; k < 150; ++k) {
        Body b;
        b.shape = boxShape(vec3(0.3F, 0.2F, 0.1F), 300, 0.05F);
        b.state = {{vec3(any(), any(), any()), glm::normalize(quat(any(), any(), any(), any()))},
                   vec3(any(), any(), any()),
                   30.0F * vec3(any(), any(), any())};
        t.bodies.push_back(b);
        states.push_back(b.state);
    }
    for (int k = 0; k < 150; ++k) {
        const dvec3 force(any(), any(), any()), torque(any(), any(), any());
        t.loads.push_back({10.0 * force, 2.0 * torque, {}, {}});
    }
    BodyContact far;  // of two of them, that do not meet
    far.a = 0;
    far.b = 1;
    far.onA = vec3(0, 50, 0);
    far.normal = glm::conjugate(states[1].pose.rotation) * (states[0].pose.rotation * vec3(0, 1, 0));
    t.contacts = {far};
    const std::vector<DeviceBody> got = t.run(*gpu->device);
    FreeBodies free(t.bodies);
    const BodyHost host = free.host();
    host.advance(host.self, t.loads, vec3(t.step.gravity), double{t.step.dt}, states);
    for (size_t k = 0; k < 150; ++k) {
        EXPECT_LT(glm::length(vec3(got[k].position) - states[k].pose.position), 1.0e-6F) << k;
        EXPECT_LT(glm::length(vec3(got[k].velocity) - states[k].velocity), 1.0e-6F) << k;
        EXPECT_LT(glm::length(vec3(got[k].spin) - states[k].spin), 3.0e-4F) << k;
    }
}

// A body whose spin is NaN is a wall to the one that meets it; both remain where they may be.
TEST_P(AdvanceTouching, WhatIsNotFiniteStaysAlone) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Touching t;
    t.step.dt = 1.0e-3F;
    t.bodies.resize(2);
    for (Body& b : t.bodies) b.shape = boxShape(vec3(0.2F), 500, 0.05F);
    t.bodies[0].state.pose.position = vec3(0, 0.2F, 0);
    t.bodies[0].state.velocity = vec3(0, -1, 0);
    t.bodies[1].state.spin.x = NAN;
    BodyContact c;
    c.a = 0;
    c.b = 1;
    c.onA = vec3(0, -0.1F, 0);
    c.onB = vec3(0, 0.1F, 0);
    c.normal = vec3(0, 1, 0);
    t.contacts = {c};
    const std::vector<DeviceBody> got = t.run(*gpu->device);
    EXPECT_NEAR(got[0].velocity.y, 0, 1.0e-5F);
    EXPECT_NEAR(got[0].position.y, 0.2F, 1.0e-5F);
    EXPECT_EQ(got[0].faults, 0U);
    EXPECT_EQ(vec3(got[1].position), vec3(0.0F));
    EXPECT_EQ(got[1].faults, BODY_MISLED);
}

INSTANTIATE_TEST_SUITE_P(Devices, AdvanceTouching, testing::Values("cl", "gl"), [](const auto& row) { return row.param; });

// Contacts of many bodies, some of which do not move: no two pairs of a colour share one that does, and each contact is in its pair.
TEST(ContactRows, PairsOfAColourShareNoBody) {
    std::mt19937 random(3);
    constexpr uint32_t kBodies = 60;
    std::vector<bool> moves(kBodies);
    for (size_t k = 0; k < kBodies; ++k) moves[k] = k % 7 != 0;
    std::vector<BodyContact> contacts;
    for (int k = 0; k < 600; ++k) {
        BodyContact c;
        c.a = static_cast<uint32_t>(random() % kBodies);
        if (!moves[c.a]) continue;
        c.b = k % 5 == 0 ? BodyContact::kSolid : static_cast<uint32_t>(random() % kBodies);
        if (c.b == c.a) continue;
        c.onA = vec3(static_cast<float>(k), 0, 0);
        contacts.push_back(c);
    }
    const ContactRows rows = contactRows(contacts, moves, {}, 0.1F);
    ASSERT_EQ(rows.contacts.size(), contacts.size());
    ASSERT_EQ(rows.colours.back(), rows.pairs.size());
    std::set<float> seen;
    for (uint32_t colour = 0; colour < rows.colourCount(); ++colour) {
        std::set<uint32_t> used;
        for (uint32_t p = rows.colours[colour]; p < rows.colours[colour + 1]; ++p) {
            const ContactPair& pair = rows.pairs[p];
            EXPECT_TRUE(used.insert(pair.bodyA).second);
            EXPECT_EQ(pair.a, rows.slots[pair.bodyA]);
            if (pair.b != NO_SLOT) {
                EXPECT_EQ(pair.b, rows.slots[pair.bodyB]);
                if (moves[pair.bodyB]) EXPECT_TRUE(used.insert(pair.bodyB).second);
            }
            for (uint32_t k = pair.first; k < pair.end; ++k) {
                const BodyContact& c = contacts[static_cast<size_t>(
                    std::ranges::find(contacts, rows.contacts[k].onA.x, [](const BodyContact& one) { return one.onA.x; }) -
                    contacts.begin())];
                EXPECT_EQ(c.a, pair.bodyA);
                EXPECT_EQ(c.b, pair.bodyB);
                EXPECT_TRUE(seen.insert(c.onA.x).second);
            }
        }
    }
    EXPECT_EQ(seen.size(), contacts.size());
    EXPECT_LT(rows.touching, kBodies + 1);
    // The next frame: each contact has moved a little, and is still the same.
    std::vector<BodyContact> next(contacts.rbegin(), contacts.rend());
    for (BodyContact& c : next) {
        c.onA.x += 0.05F;
        c.normal = vec3(0, 1, 0);
    }
    for (BodyContact& c : contacts) c.normal = vec3(0, 1, 0);
    const ContactRows was = contactRows(contacts, moves, {}, 0.1F), is = contactRows(next, moves, was, 0.1F);
    for (const ContactRow& row : is.contacts) {
        ASSERT_NE(row.before, NO_CONTACT);
        EXPECT_NEAR(was.contacts[row.before].onA.x, row.onA.x - 0.05F, 1.0e-3F);
    }
}

// Four contacts of a pair become one, then three: each impulse has a place, and one only.
TEST(ContactRows, NoImpulseIsLost) {
    std::vector<BodyContact> four(4), one(1);
    for (size_t k = 0; k < 4; ++k) {
        four[k].onA = vec3(static_cast<float>(k), 0, 0);
        four[k].normal = vec3(0, 1, 0);
    }
    one[0] = four[2];
    const std::vector<bool> moves = {true};
    const ContactRows was = contactRows(four, moves, {}, 0.1F), is = contactRows(one, moves, was, 0.1F);
    ASSERT_EQ(is.contacts.size(), 1U);
    const ContactRow& row = is.contacts[0];
    EXPECT_EQ(row.before, 2U) << "its own comes first";
    EXPECT_EQ((std::set<uint32_t>{row.before, row.before1, row.before2, row.before3}), (std::set<uint32_t>{0, 1, 2, 3}));
    four.pop_back();
    const ContactRows more = contactRows(four, moves, is, 0.1F);
    EXPECT_EQ(std::ranges::count(more.contacts, 0U, &ContactRow::before), 1) << "one has it";
    EXPECT_EQ(more.contacts[2].before, 0U);
    one[0].normal = vec3(1, 0, 0);
    EXPECT_EQ(contactRows(one, moves, was, 0.1F).contacts[0].before, NO_CONTACT) << "another surface";
}

// Of a face's points the corners stay, of an edge's the ends; points of an uneven surface stay all.
TEST(ContactRows, AFaceIsItsCorners) {
    const vec3 n = glm::normalize(vec3(1, 2, 3)), u = glm::normalize(glm::cross(n, vec3(0, 1, 0))), v = glm::cross(n, u);
    std::vector<vec3> places;
    std::vector<float> separations;
    for (int z = 0; z < 4; ++z)
        for (int x = 0; x < 4; ++x) {
            places.push_back(static_cast<float>(x) * u + static_cast<float>(z) * v);
            separations.push_back(0.01F * static_cast<float>(x) - 0.02F * static_cast<float>(z));
        }
    EXPECT_EQ(outlineOf(places, separations, n, 1.0e-3F), (std::vector<size_t>{0, 3, 12, 15}));
    EXPECT_EQ(outlineOf(std::span(places).first(4), std::span(separations).first(4), n, 1.0e-3F), (std::vector<size_t>{0, 3}));
    separations[5] -= 0.1F;
    EXPECT_EQ(outlineOf(places, separations, n, 1.0e-3F).size(), 16U);
    EXPECT_TRUE(outlineOf({}, {}, n, 1.0e-3F).empty());
}

// The deepest point comes first, then the corners of a face before what lies between them.
TEST(ContactRows, ChosenPointsAreSpread) {
    std::vector<vec3> places;
    std::vector<float> separations;
    for (int z = 0; z < 5; ++z)
        for (int x = 0; x < 5; ++x) {
            places.emplace_back(static_cast<float>(x), 0, static_cast<float>(z));
            separations.push_back(x == 2 && z == 1 ? -0.01F : 0.0F);
        }
    const std::vector<size_t> chosen = spreadOf(places, separations, 5);
    ASSERT_EQ(chosen.size(), 5U);
    EXPECT_EQ(chosen[0], 7U);
    const std::set<size_t> others(chosen.begin() + 1, chosen.end());
    EXPECT_EQ(others, (std::set<size_t>{0, 4, 20, 24}));
    EXPECT_EQ(spreadOf(places, separations, 50).size(), 25U);
    EXPECT_TRUE(spreadOf({}, {}, 4).empty());
}

}  // namespace
}  // namespace rivulet::advance_touching_test
