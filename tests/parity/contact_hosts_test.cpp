// Hosts of their own for bodies that a GPU moves: what they may name as a contact, and when they are asked.
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/body_rig.h"
#include "tests/parity/devices.h"
#include "tests/parity/touching.h"

namespace rivulet::contact_hosts_test {
namespace {

class ContactHosts : public testing::TestWithParam<const char*> {};

// A box and a ball that spins meet. Whichever of them is named first, and however the ball has turned, the box bounces straight back, and
// without friction the ball keeps its spin.
TEST_P(ContactHosts, MayNameABallSecond) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    for (const bool ballFirst : {false, true}) {
        Touching t;
        t.step.dt = 1.0e-3F;
        Body box, ball;
        box.shape = boxShape(vec3(0.1F), 500, 0.05F);
        box.state = {{vec3(0, 0.15F, 0), glm::angleAxis(0.7F, vec3(0, 1, 0))}, vec3(0, -1, 0), vec3(0.0F)};
        ball.shape = sphereShape(0.1F, 500, 0.05F);
        ball.state = {{vec3(0.0F), glm::angleAxis(1.3F, glm::normalize(vec3(1, 2, 3)))}, vec3(0.0F), vec3(0, 0, 20)};
        t.bodies = {box, ball};
        const vec3 up(0, 1, 0), own = box.state.pose.toOwn(vec3(0, 0.1F, 0));
        BodyContact c;
        c.friction = 0;
        c.restitution = 1;
        c.a = ballFirst ? 1 : 0;
        c.b = ballFirst ? 0 : 1;
        (ballFirst ? c.onB : c.onA) = own;
        (ballFirst ? c.radiusA : c.radiusB) = 0.1F;
        c.normal = glm::conjugate(box.state.pose.rotation) * (ballFirst ? -up : up);
        t.contacts = {c};
        const std::vector<DeviceBody> got = t.run(*gpu->device);
        const double m = box.shape.mass, other = ball.shape.mass;
        EXPECT_LT(glm::length(dvec3(vec3(got[0].velocity)) - dvec3(0, (other - m) / (m + other), 0)), 1.0e-5) << ballFirst;
        EXPECT_LT(glm::length(dvec3(vec3(got[1].velocity)) - dvec3(0, -2 * m / (m + other), 0)), 1.0e-5) << ballFirst;
        EXPECT_LT(glm::length(vec3(got[1].spin) - vec3(0, 0, 20)), 1.0e-4F) << ballFirst;
    }
}

// A box on a slope, whose host finds its contacts.
struct Slope {
    Body box;
    std::vector<vec3> corners;
    int calls = 0, empty = 0;
    bool restless = false;  // the normal differs by rounding from call to call
    static BodyHost of(Slope& slope) {
        BodyHost host;
        host.self = &slope;
        host.remembersNothing = true;
        host.advance = [](void*, std::span<const BodyLoad>, const vec3&, double, std::span<BodyState>) {};
        host.reset = [](void*, std::span<const BodyState>) {};
        host.contacts = [](void* self, std::span<const BodyState> states, std::span<const vec4>, double seconds,
                           std::vector<BodyContact>& found) {
            Slope& s = *static_cast<Slope*>(self);
            ++s.calls;
            if (!(seconds > 0)) ++s.empty;
            const float other = s.restless ? (s.calls % 2 == 0 ? 2.0e-7F : -2.0e-7F) : 0.0F;
            const vec3 n(0.6F + other, 0.8F, 0);
            for (const vec3& corner : s.corners) {
                const vec3 p = states[0].pose.toWorld(corner);
                BodyContact c;
                c.onA = corner;
                c.onB = p - glm::dot(n, p - vec3(0, 1, 0)) * n;
                c.normal = n;
                c.friction = 1;
                found.push_back(c);
            }
            return true;
        };
        host.passed = [](void*, double) {};
        return host;
    }
};

Slope makeSlope() {
    Slope slope;
    slope.box.meetsWater = false;
    slope.box.shape = boxShape(vec3(0.2F, 0.1F, 0.2F), 500, 0.05F);
    const quat turned = glm::angleAxis(-std::asin(0.6F), vec3(0, 0, 1));
    slope.box.state.pose = {vec3(0, 1, 0) + 0.05F * vec3(0.6F, 0.8F, 0), turned};
    for (const float x : {-0.1F, 0.1F})
        for (const float z : {-0.1F, 0.1F}) slope.corners.emplace_back(x, -0.05F, z);
    return slope;
}

// The slope is one of 3, 4 and 5: there the friction's directions change if the normal does by rounding.
TEST_P(ContactHosts, MayRoundTheirNormals) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Slope slope = makeSlope();
    slope.restless = true;
    auto world = FluidWorld::create(*gpu->device, body_rig::paramsOf({}), {.bodies = {slope.box}, .bodyHost = Slope::of(slope)}, {});
    ASSERT_TRUE(world) << world.error().message;
    for (int frame = 0; frame < 20; ++frame) (*world)->step({.gravity = vec3(0, -9.81F, 0)}, body_rig::kFrame);
    const vec3 from = (*world)->bodies()[0].pose.position;
    for (int frame = 0; frame < 60; ++frame) (*world)->step({.gravity = vec3(0, -9.81F, 0)}, body_rig::kFrame);
    EXPECT_LT(glm::length((*world)->bodies()[0].pose.position - from), 5.0e-5F);
}

// Frames shorter than a substep: in those without one there is nothing to ask.
TEST_P(ContactHosts, AreAskedInFramesWithASubstep) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Slope slope = makeSlope();
    FluidParams p = body_rig::paramsOf({});
    p.fixedStep = 0.03F;
    auto world = FluidWorld::create(*gpu->device, p, {.bodies = {slope.box}, .bodyHost = Slope::of(slope)}, {});
    ASSERT_TRUE(world) << world.error().message;
    for (int frame = 0; frame < 20; ++frame) (*world)->step({.gravity = vec3(0, -9.81F, 0)}, body_rig::kFrame);
    EXPECT_GT(slope.calls, 0);
    EXPECT_EQ(slope.empty, 0);
    EXPECT_LT(glm::length((*world)->bodies()[0].pose.position - slope.box.state.pose.position), 5.0e-4F);
}

// Functions that would never be called are refused.
TEST_P(ContactHosts, NeedContactsForWhatBelongsToThem) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    Slope slope = makeSlope();
    BodyHost host = Slope::of(slope);
    host.contacts = nullptr;
    const auto tryIt = [&] {
        auto world = FluidWorld::create(*gpu->device, body_rig::paramsOf({}), {.bodies = {slope.box}, .bodyHost = host}, {});
        return world ? std::string() : world.error().message;
    };
    EXPECT_NE(tryIt().find("contacts and passed"), std::string::npos);
    host.passed = nullptr;
    EXPECT_EQ(tryIt(), "");
    host.pulls = [](void*, std::vector<BodyPull>&) {};
    EXPECT_NE(tryIt().find("pulls"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Devices, ContactHosts, testing::Values("gl", "cl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::contact_hosts_test
