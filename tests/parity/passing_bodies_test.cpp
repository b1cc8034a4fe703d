// Bodies that pass close by others, walls and meshes are not touched by them, however fast; those in whose way something is, are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "engine/core/mesh_view.h"
#include "tests/parity/body_rig.h"

namespace rivulet::passing_bodies_test {
namespace {

using body_rig::kGravity, body_rig::Rig, body_rig::Scenario;

class PassingBodies : public testing::TestWithParam<const char*> {};

constexpr float kClear[] = {0.005F, 0.03F};  // m

// In each lane one that flies past a fixed box. Without gravity it keeps its velocity.
TEST_P(PassingBodies, KeepTheirVelocity) {
    Scenario s;
    s.gravity = vec3(0.0F);
    std::vector<size_t> flying;
    float lane = -2.7F;
    for (const float speed : {2.0F, 5.0F})
        for (const float clear : kClear)
            for (const bool ball : {false, true}) {
                s.addBox(vec3(0.4F, 0.2F, 0.4F), vec3(0, 0.4F, lane), 0.5F);
                s.bodies.back().shape.mass = 0;
                const vec3 from(-1, 0.6F + clear, lane);
                if (ball)
                    s.addBall(0.1F, from, vec3(0.0F), 0.5F, 0.5F);
                else
                    s.addBox(vec3(0.2F), from, 0.5F);
                s.bodies.back().state.velocity = vec3(speed, 0, 0);
                flying.push_back(s.bodies.size() - 1);
                lane += 0.6F;
            }
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    for (int frame = 0; frame < 36; ++frame) rig.frame();
    for (const size_t k : flying) {
        const dvec3 from(s.bodies[k].state.pose.position), velocity(s.bodies[k].state.velocity);
        EXPECT_LT(glm::length(rig.velocity(k) - velocity), 1.0e-5) << k;
        EXPECT_LT(glm::length(rig.place(k) - from - velocity * rig.world->time()), 1.0e-4) << k;
        EXPECT_LT(rig.turned(k), 1.0e-3) << k;
    }
}

// Boxes fall past the edges of a thin plate, which is a mesh of long triangles, and of a free box that falls more slowly.
TEST_P(PassingBodies, FallFreely) {
    const std::vector<vec3> corners = {{-0.5F, 0.996F, -0.04F}, {0.5F, 0.996F, -0.04F}, {-0.5F, 1.004F, -0.04F}, {0.5F, 1.004F, -0.04F},
                                       {-0.5F, 0.996F, 0.04F},  {0.5F, 0.996F, 0.04F},  {-0.5F, 1.004F, 0.04F},  {0.5F, 1.004F, 0.04F}};
    const std::vector<uint32_t> triangles = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                             2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    Scenario s;
    s.still = {MeshView{corners, triangles, {}, {}}};
    s.addBox(vec3(0.2F), vec3(0.62F, 2.2F, 0), 0.5F);
    s.addBox(vec3(0.2F), vec3(-0.605F, 2.2F, 0), 0.5F);
    s.addBall(0.1F, vec3(0, 2.2F, 0.145F), vec3(0.0F), 0.5F, 0.5F);
    s.addBox(vec3(0.2F), vec3(0, 2.6F, 2), 0.5F);
    s.addBox(vec3(0.2F), vec3(0.205F, 3.4F, 2), 0.5F);
    s.bodies.back().state.velocity = vec3(0, -4, 0);
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    for (int frame = 0; frame < 36; ++frame) rig.frame();
    const double t = rig.world->time();
    for (size_t k = 0; k < s.bodies.size(); ++k) {
        if (k == 4) continue;  // it lies on the ground by then
        const dvec3 wanted = dvec3(s.bodies[k].state.velocity) - dvec3(0, kGravity * t, 0);
        EXPECT_LT(glm::length(rig.velocity(k) - wanted), 1.0e-4) << k;
        EXPECT_LT(rig.turned(k), 1.0e-3) << k;
    }
    EXPECT_LT(std::abs(rig.place(4).x - 0.205), 1.0e-4);
}

// 30 mm of the way of each is barred: it does not pass.
TEST_P(PassingBodies, AreStoppedByWhatIsInTheirWay) {
    Scenario s;
    s.gravity = vec3(0.0F);
    std::vector<size_t> flying;
    float lane = -2;
    for (const float speed : {2.0F, 5.0F, 10.0F})
        for (const bool ball : {false, true}) {
            s.addBox(vec3(0.4F, 0.2F, 0.4F), vec3(0, 0.4F, lane), 0.5F);
            s.bodies.back().shape.mass = 0;
            const vec3 from(-1, 0.57F, lane);
            if (ball)
                s.addBall(0.1F, from, vec3(0.0F), 0.5F, 0);
            else
                s.addBox(vec3(0.2F), from, 0.5F);
            s.bodies.back().state.velocity = vec3(speed, 0, 0);
            flying.push_back(s.bodies.size() - 1);
            lane += 0.8F;
        }
    Rig rig(GetParam(), s);
    if (!rig.world) GTEST_SKIP() << rig.absent;
    for (int frame = 0; frame < 36; ++frame) {
        rig.frame();
        for (const size_t k : flying) {
            // The boxes turn about the edge that they hit; neither's centre comes into the fixed box or nearer than a tenth of its size.
            const dvec3 at = rig.place(k);
            const dvec3 nearest = glm::clamp(at, dvec3(-0.2, 0.3, s.bodies[k - 1].state.pose.position.z - 0.2),
                                             dvec3(0.2, 0.5, s.bodies[k - 1].state.pose.position.z + 0.2));
            EXPECT_GT(glm::length(at - nearest), 0.095) << k << " in frame " << frame;
        }
    }
    for (const size_t k : flying) EXPECT_LT(rig.velocity(k).x, 0.75 * double{s.bodies[k].state.velocity.x}) << k;
}

INSTANTIATE_TEST_SUITE_P(Devices, PassingBodies, testing::Values("gl", "cl"), [](const auto& row) { return row.param; });

}  // namespace
}  // namespace rivulet::passing_bodies_test
