// Pouring by mouse: the jet's rate at the pointer's position, limited by the free slots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/host_particles.h"
#include "fluid/viewer/pour_brush.h"
#include "tests/physics/worlds.h"

namespace rivulet::pour_test {
namespace {

// A dry ball on the floor of a box.
SceneFile scene() {
    SceneFile s;
    s.name = "pour";
    s.fluid.spacing = 0.03F;
    s.fluid.box.max = vec3(1.0F, 0.8F, 0.6F);
    ColliderParams ball;
    ball.mesh = "meshes/sphere.obj";
    ball.fitSize = 0.2F;
    ball.resolution = 20;
    ball.position = vec3(0.7F, 0.1F, 0.3F);
    s.colliders = {ball};
    s.pour.litres = 24;
    return s;
}

std::unique_ptr<Session> open(Device& device, const SceneFile& scene) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}

TEST(Pour, TheJetHasItsRateAtThePointer) {
    auto device = cpu();
    auto session = open(*device, scene());
    for (int k = 0; k < 5; ++k) session->step(1.0 / 60, true);
    EXPECT_EQ(session->world().stats().particles, 0U) << "no hand, no water";
    session->pourOnto(vec3(0.3F, 0, 0.3F));
    for (int k = 0; k < 12; ++k) session->step(1.0 / 60, true);
    // pi r^2 v for 0.2 s, r three spacings, v the speed after a fall of 3 r; the first layer is half a spacing late.
    const double r = 0.09, v = std::sqrt(2 * 9.81 * 3 * r), volume = 3.14159265 * r * r * v * 0.2;
    const HostParticles jet = readParticles(session->world());
    EXPECT_NEAR(static_cast<double>(jet.position.size()) * std::pow(0.03, 3), volume, 0.1 * volume);
    for (size_t k = 0; k < jet.position.size(); ++k) {
        const vec3 p(jet.position[k]);
        if (p.y > 0.1F) EXPECT_LT(glm::distance(vec2(p.x, p.z), vec2(0.3F, 0.3F)), 0.12F) << "above where it splashes";
        EXPECT_LT(p.y, 0.28F) << "from three radii above";
    }
    session->pourOnto(std::nullopt);
    const uint32_t held = session->world().stats().particles;
    for (int k = 0; k < 12; ++k) session->step(1.0 / 60, true);
    EXPECT_EQ(session->world().stats().particles, held);
    session->pourOnto(vec3(0.3F, 0.1F, 0.3F));
    for (int k = 0; k < 120; ++k) session->step(1.0 / 60, true);
    EXPECT_NEAR(session->world().stats().particles * std::pow(0.03, 3), 24.0e-3, 0.2e-3) << "what there is room for";
    EXPECT_FALSE(session->world().stats().limited.empty()) << "and it is said";
    EXPECT_EQ(session->world().stats().lost, 0U);
    EXPECT_EQ(session->world().stats().speedLimited, 0U);
}

TEST(Pour, WithoutFreeSlotsNothingIsPoured) {
    auto device = cpu();
    SceneFile dry = scene();
    dry.pour.litres = 0;
    auto session = open(*device, dry);
    session->pourOnto(vec3(0.3F, 0, 0.3F));
    for (int k = 0; k < 5; ++k) session->step(1.0 / 60, true);
    EXPECT_EQ(session->world().particles().count, 0U);
    EXPECT_TRUE(session->needsNew(scene())) << "room is made by a new world";
}

// A ray from above hits the ball, the floor beside it or the water on it; outside the box it hits nothing.
TEST(Pour, RaysHitBallFloorAndWater) {
    auto device = cpu();
    SceneFile wet = scene();
    wet.fluid.blocks = {{vec3(0.0F), vec3(0.4F, 0.3F, 0.6F), vec3(0.0F)}};
    auto session = open(*device, wet);
    session->step(1.0 / 60, true);
    const auto down = [&](float x) { return pouredOnto(*session, vec3(x, 3, 0.3F), vec3(0, -2, 0)); };
    ASSERT_TRUE(down(0.7F) && down(0.5F) && down(0.2F));
    EXPECT_NEAR(down(0.7F)->y, 0.2F, 0.002F) << "the ball's top";
    EXPECT_NEAR(down(0.9F)->y, 0.0F, 0.002F) << "the floor";
    EXPECT_NEAR(down(0.2F)->y, 0.3F, 0.02F) << "the water";
    EXPECT_FALSE(down(1.2F));
    EXPECT_FALSE(pouredOnto(*session, vec3(0.5F, 3, 0.3F), vec3(0, 1, 0))) << "the box is behind";
    const auto inside = pouredOnto(*session, vec3(0.9F, 0.5F, 0.3F), vec3(0, 0, 1));
    ASSERT_TRUE(inside);
    EXPECT_NEAR(inside->z, 0.6F, 1.0e-5F) << "from within: its far side";
}

// The place is moved into the box: no particle is spawned outside.
TEST(Pour, StaysInsideTheBoxAtTheLidAndInACorner) {
    auto device = cpu();
    auto session = open(*device, scene());
    for (const vec3& place : {vec3(0.5F, 0.8F, 0.3F), vec3(0.0F, 0.0F, 0.0F), vec3(5.0F, -3.0F, 9.0F)}) {
        session->reset();
        session->pourOnto(place);
        for (int k = 0; k < 20; ++k) session->step(1.0 / 60, true);
        EXPECT_GT(session->world().stats().particles, 50U);
        EXPECT_EQ(session->world().stats().lost, 0U);
        EXPECT_EQ(session->world().stats().nan, 0U);
    }
}

// A dyed jet into a run without dye.
TEST(Pour, ADyedJetIntoARunningScene) {
    auto device = cpu();
    SceneFile before = scene();
    before.pour.litres = 0;
    before.fluid.blocks = {{vec3(0.0F), vec3(0.4F, 0.3F, 0.6F), vec3(0.0F)}};
    auto one = open(*device, before);
    for (int k = 0; k < 10; ++k) one->step(1.0 / 60, true);
    SceneFile after = before;
    after.pour = {.litres = 2, .liquid = "honey", .dye = vec3(0.9F, 0.2F, 0.1F)};
    after.room = one->world().particles().count;
    ASSERT_TRUE(Session::sameWater(before, after));
    auto two = open(*device, after);
    ASSERT_TRUE(two->continueFrom(*one));
    const uint32_t held = one->world().stats().particles;
    EXPECT_EQ(readParticles(two->world()).position.size(), held);
    two->pourOnto(vec3(0.8F, 0, 0.3F));
    for (int k = 0; k < 30; ++k) two->step(1.0 / 60, true);
    const ParticleView view = two->world().particles();
    const auto matter = device->readAll<vec4>(*view.matterOf, view.count);
    const HostParticles all = readParticles(two->world());
    const auto honey = std::count_if(all.id.begin(), all.id.end(), [&](uint32_t id) { return matter[id].w > 0; });
    EXPECT_EQ(static_cast<size_t>(honey) + held, all.position.size());
    EXPECT_NEAR(static_cast<double>(honey) * std::pow(0.03, 3), 2.0e-3, 0.15e-3);
}

}  // namespace
}  // namespace rivulet::pour_test
