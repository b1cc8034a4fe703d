// Piles of bodies that a GPU moves come to rest, bounces have their height, and frames may be shorter than a substep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "shaders/fluid/solids/body_contact_rows.h"
#include "tests/parity/body_rig.h"

namespace rivulet::body_piles_test {
namespace {

using body_rig::kFrame, body_rig::kGravity, body_rig::kTurn, body_rig::Rig, body_rig::Scenario;

class BodyPiles : public testing::TestWithParam<const char*> {};

// The fastest point, about, and how far each body has come since `from`.
struct Rest {
    double speed = 0, way = 0;
};
Rest restOf(const Rig& rig, const std::vector<dvec3>& from, double reach) {
    Rest rest;
    for (size_t k = 0; k < from.size(); ++k) {
        rest.speed = std::max(rest.speed, glm::length(rig.velocity(k)) + reach * glm::length(dvec3(vec3(rig.row(k).spin))));
        rest.way = std::max(rest.way, glm::length(rig.place(k) - from[k]));
    }
    return rest;
}
std::vector<dvec3> placesOf(const Rig& rig, size_t count) {
    std::vector<dvec3> places;
    places.reserve(count);
    for (size_t k = 0; k < count; ++k) places.push_back(rig.place(k));
    return places;
}

// Towers of 8 cubes, and of 8 boxes that bounce a little: in the last half of 10 s nothing moves.
TEST_P(BodyPiles, Rest) {
    Scenario s;
    for (int k = 0; k < 8; ++k) s.addBox(vec3(0.1F), vec3(-1, 0.1F * (0.5F + static_cast<float>(k)), 0), 0.5F);
    for (int k = 0; k < 8; ++k) {
        s.addBox(vec3(0.2F, 0.1F, 0.2F), vec3(0, 0.1F * (0.5F + static_cast<float>(k)), 1), 0.5F);
        s.forms.back().restitution = 0.3F;
    }
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    Rest most;
    std::vector<dvec3> half;
    for (int frame = 0; frame < 600; ++frame) {
        rig.frame();
        if (frame == 300) half = placesOf(rig, s.bodies.size());
        if (frame < 300) continue;
        const Rest rest = restOf(rig, half, 0.1);
        most = {std::max(most.speed, rest.speed), std::max(most.way, rest.way)};
    }
    double lean = 0;
    for (size_t k = 0; k < 8; ++k) lean = std::max(lean, std::hypot(rig.place(k).x + 1, rig.place(k).z));
    std::printf("%s: %.1e m/s, %.1e m from 5 to 10 s; the tower leans by %.1e m\n", GetParam(), most.speed, most.way, lean);
    EXPECT_LT(most.speed, 0.02);
    EXPECT_LT(most.way, 1.5e-3);
    EXPECT_LT(lean, 4.0e-3);
}

// Eight dominoes fall over and lie on each other. From 2.5 to 5 s nothing moves.
TEST_P(BodyPiles, DominoesLean) {
    Scenario s;
    for (int k = 0; k < 8; ++k)
        s.addBox(vec3(0.02F, 0.2F, 0.1F), vec3(0.08F * static_cast<float>(k) - 0.3F, 0.1F, 0), 0.5F,
                 glm::angleAxis(k == 0 ? -12 * kTurn : 0.0F, vec3(0, 0, 1)));
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    Rest most;
    std::vector<dvec3> half;
    for (int frame = 0; frame < 300; ++frame) {
        rig.frame();
        if (frame == 150) half = placesOf(rig, s.bodies.size());
        if (frame < 150) continue;
        const Rest rest = restOf(rig, half, 0.1);
        most = {std::max(most.speed, rest.speed), std::max(most.way, rest.way)};
    }
    double lowest = 1;
    for (size_t k = 0; k < 8; ++k) lowest = std::min(lowest, rig.place(k).y);
    std::printf("%s: %.1e m/s, %.1e m from 2.5 to 5 s\n", GetParam(), most.speed, most.way);
    EXPECT_LT(lowest, 0.05) << "they have fallen";
    EXPECT_GT(lowest, 5.0e-3) << "and not into the floor";
    EXPECT_LT(most.speed, 0.05);
    EXPECT_LT(most.way, 2.0e-3);
}

// Boxes that land flat come back to e^2 of their height, and do not turn. What one bounce leaves of a spin grows tenfold in the next: that
// of 0.5 rests after five without having tilted.
TEST_P(BodyPiles, AFlatBoxBouncesToItsHeight) {
    const std::vector<float> bounces = {0.1F, 0.5F, 0.9F};
    Scenario s;
    for (size_t k = 0; k < 3; ++k) {
        s.addBox(vec3(0.1F), vec3(static_cast<float>(k) - 1, 0.57F, 0), 0.5F);
        s.forms.back().restitution = bounces[k];
    }
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    std::vector<double> tops(3), spins(3), most(3);
    std::vector<bool> fell(3), back(3);
    for (int frame = 0; frame < 60; ++frame) {
        rig.frame();
        for (size_t k = 0; k < 3; ++k) {
            const double v = rig.velocity(k).y, step = double{s.step};
            most[k] = std::max(most[k], glm::length(dvec3(vec3(rig.row(k).spin))));
            if (v < -1) fell[k] = true;
            // The top of the parabola of symplectic Euler.
            if (fell[k] && v > 0 && !back[k]) {
                tops[k] = rig.place(k).y - 0.05 + v * v / (2 * kGravity) - 0.5 * v * step;
                spins[k] = glm::length(dvec3(vec3(rig.row(k).spin)));
                back[k] = true;
            }
        }
    }
    for (size_t k = 0; k < 3; ++k) {
        const double e = bounces[k], law = e * e * 0.52;
        std::printf("%s, e = %.1f: %.5f m, by the law %.5f m; %.1e rad/s, then up to %.1e rad/s\n", GetParam(), e, tops[k], law, spins[k],
                    most[k]);
        EXPECT_NEAR(tops[k], law, 0.01 * law);
        EXPECT_LT(spins[k], 5.0e-5);
        EXPECT_LT(most[k], 5.0e-3);
    }
}

// Frames of other lengths, and so substeps: the impulses with which one begins are those of the one before, times the ratio of their
// lengths. A tower does not notice.
TEST_P(BodyPiles, RestInStepsOfAnyLength) {
    Scenario s;
    s.step = 0;  // as the water has it, and a whole frame
    for (int k = 0; k < 8; ++k) s.addBox(vec3(0.1F), vec3(-1, 0.1F * (0.5F + static_cast<float>(k)), 0), 0.5F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    Rest most;
    std::vector<dvec3> half;
    double least = 1, longest = 0;  // s, substeps
    for (int frame = 0; frame < 240; ++frame) {
        const double seconds = frame % 2 == 0 ? kFrame : 0.05 * kFrame;
        rig.frame(seconds);
        const double step = seconds / rig.world->lastSubsteps();
        least = std::min(least, step);
        longest = std::max(longest, step);
        if (frame == 120) half = placesOf(rig, s.bodies.size());
        if (frame < 120) continue;
        const Rest rest = restOf(rig, half, 0.1);
        most = {std::max(most.speed, rest.speed), std::max(most.way, rest.way)};
    }
    std::printf("%s: steps of %.2f and %.2f ms: %.1e m/s, %.1e m\n", GetParam(), 1000 * least, 1000 * longest, most.speed, most.way);
    EXPECT_GT(longest, 4 * least);
    EXPECT_LT(most.speed, 0.1);
    EXPECT_LT(most.way, 1.0e-3);
}

// What rests does not bounce, however much gravity adds to its speed in a substep.
TEST_P(BodyPiles, WhatRestsUnderStrongGravityStays) {
    Scenario s;
    s.gravity = vec3(0, -98.1F, 0);
    s.addBox(vec3(0.1F), vec3(0, 0.05F, 0), 0.5F);
    s.addBall(0.05F, vec3(1, 0.05F, 0), vec3(0.0F), 0.5F, 0.5F);
    for (BodyForm& form : s.forms) form.restitution = 0.5F;
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    const std::vector<dvec3> begin = {dvec3(0, 0.05, 0), dvec3(1, 0.05, 0)};
    for (int frame = 0; frame < 60; ++frame) {
        rig.frame();
        const Rest rest = restOf(rig, begin, 0.05);
        EXPECT_LT(rest.speed, 2.0e-3) << frame;
        EXPECT_LT(rest.way, 1.0e-4) << frame;
    }
}

// More balls than a GPU moves in contact, at once at the floor, in still air and without gravity. The host moves all, for half a second;
// then the GPU does again. No ball is lost or jumps, and all come back.
TEST_P(BodyPiles, MoreThanTouchAtOnce) {
    constexpr int kAcross = 20;
    static_assert(kAcross * kAcross > MOST_TOUCHING);
    Scenario s;
    s.gravity = vec3(0.0F);
    const float speed = 1, bounce = 0.8F;
    for (int k = 0; k < kAcross * kAcross; ++k) {
        const vec3 at(0.25F * static_cast<float>(k % kAcross) - 2.5F, 0.35F, 0.25F * static_cast<float>(k / kAcross) - 2.5F);
        s.addBall(0.05F, at, vec3(0, -speed, 0), 0.5F, bounce);
    }
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    rig.mayWait = true;
    std::vector<BodyState> last = rig.world->bodies();
    std::vector<bool> byHost;  // then the device's rows are not read
    double jump = 0, aside = 0, lowest = 1;
    for (int frame = 0; frame < 75; ++frame) {
        const size_t before = rig.late->rows.size();
        rig.frame();
        byHost.push_back(rig.late->rows.size() == before);
        // While the GPU moves them, the host does not ask where they are: it learns it late, as in any frame.
        std::vector<BodyState> now = byHost.back() ? rig.world->bodies() : last;
        for (size_t k = 0; k < now.size(); ++k) {
            if (!byHost.back()) {
                now[k].pose.position = vec3(rig.place(k));
                now[k].velocity = vec3(rig.velocity(k));
            }
            jump = std::max(jump, double{glm::length(now[k].pose.position - last[k].pose.position)});
            const vec3 off = now[k].pose.position - s.bodies[k].state.pose.position;
            aside = std::max(aside, double{std::hypot(off.x, off.z)});
            lowest = std::min(lowest, double{now[k].pose.position.y});
        }
        last = now;
    }
    const auto begin = std::ranges::find(byHost, true);
    const auto host = std::ranges::count(byHost, true);
    std::printf("%s: the host moves them in %td of 75 frames, from frame %td; at most %.4f m a frame, %.1e m aside, lowest %.4f m\n",
                GetParam(), host, begin - byHost.begin(), jump, aside, lowest);
    EXPECT_GT(begin - byHost.begin(), 5) << "the GPU moves them until they are near the floor";
    EXPECT_NEAR(static_cast<double>(host), 30, 1.5) << "half a second";
    EXPECT_FALSE(byHost.back()) << "then the GPU again";
    EXPECT_LT(jump, 1.01 * double{speed} * kFrame);
    EXPECT_LT(aside, 1.0e-3);
    EXPECT_GT(lowest, 0.049);
    for (const BodyState& b : last) {
        EXPECT_GT(b.velocity.y, 0.3F);
        EXPECT_LE(b.velocity.y, bounce * speed + 1.0e-3F);
        EXPECT_GT(b.pose.position.y, 0.15F);
    }
}

// Substeps longer than a frame: some frames have none, and a stack at rest takes no impulse from memory that no substep wrote.
TEST_P(BodyPiles, FramesWithoutASubstep) {
    Scenario s;
    s.step = 0.03F;
    s.poison = 0xc1200000;  // -10.0F
    for (int k = 0; k < 4; ++k) s.addBox(vec3(0.2F), vec3(0, 0.2F * (0.5F + static_cast<float>(k)), 0), 0.5F);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    std::vector<dvec3> begin, half;
    Rest first, most;
    for (int frame = 0; frame < 240; ++frame) {
        rig.frame();
        if (rig.late->rows.empty()) continue;  // no substep yet
        if (begin.empty()) begin = placesOf(rig, 4);
        if (frame == 120) half = placesOf(rig, 4);
        Rest& of = frame < 120 ? first : most;
        const Rest rest = restOf(rig, frame < 120 ? begin : half, 0.1);
        of = {std::max(of.speed, rest.speed), std::max(of.way, rest.way)};
    }
    std::printf("%s: %.1e m/s, %.1e m, then %.1e m/s, %.1e m\n", GetParam(), first.speed, first.way, most.speed, most.way);
    EXPECT_LT(first.speed, 0.1);
    EXPECT_LT(first.way, 5.0e-3);
    EXPECT_LT(most.speed, 5.0e-3);
    EXPECT_LT(most.way, 5.0e-4);
}

INSTANTIATE_TEST_SUITE_P(Devices, BodyPiles, testing::Values("cl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::body_piles_test
