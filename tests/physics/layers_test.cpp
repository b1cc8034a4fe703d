// Collision layers of a scene: what the water meets, and which bodies and colliders meet each other.
#include "fluid/sim/solids/layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/session/session.h"
#include "tests/physics/worlds.h"

namespace rivulet::layers_test {
namespace {

constexpr double kFrame = 1.0 / 60;

SceneFile room() {
    SceneFile s;
    s.fluid.method = "pbf";
    s.fluid.spacing = 0.04F;
    s.fluid.box.max = vec3(0.6F, 1.0F, 0.34F);
    s.fluid.collision.layers.meets = 1;
    return s;
}
BodyParams crate(const vec3& position) {
    BodyParams b;
    b.size = vec3(0.12F);
    b.position = position;
    b.density = 2000;
    return b;
}
ColliderParams sheet(float height, int layers) {
    ColliderParams c;
    c.mesh = "meshes/sheet.obj";
    c.fitSize = 0.62F;  // 0.36 m wide
    c.resolution = 24;
    c.position = vec3(0.3F, height, 0.17F);
    c.layers.layers = layers;
    return c;
}

std::unique_ptr<Session> start(Device& device, const SceneFile& scene) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}
void run(Session& session, double seconds) {
    for (int k = 0; k < static_cast<int>(std::lround(seconds / kFrame)); ++k) session.step(kFrame, true);
}
float lowest(const FluidWorld& world) {
    float y = 10;
    for (const vec4& p : world.device().readAll<vec4>(*world.particles().position, world.particles().slots))
        if (p.w >= 0) y = std::min(y, p.y);
    return y;
}

// Both masks count: each must be on a layer that the other meets.
TEST(Layers, MeetIfEachIsOnALayerThatTheOtherMeets) {
    for (int a = 0; a < 16; ++a)
        for (int b = 0; b < 16; ++b) {
            const LayersParams one{a & 3, a >> 2}, other{b & 3, b >> 2};
            const bool both = (one.layers & other.meets) != 0 && (other.layers & one.meets) != 0;
            EXPECT_EQ(one.meet(other), both);
            EXPECT_EQ(one.meet(other), other.meet(one));
        }
    EXPECT_TRUE(LayersParams().meet(LayersParams()));
}

// Water falls through a grating that it does not meet, as if it were not there, and a crate lies on it. On a layer that the water meets the
// same sheet holds it.
TEST(Layers, WaterFallsThroughAGratingThatHoldsACrate) {
    auto device = cpu();
    SceneFile scene = room();
    scene.fluid.blocks = {{.min = vec3(0.1F, 0.5F, 0.02F), .max = vec3(0.5F, 0.62F, 0.14F)}};
    scene.bodies = {crate(vec3(0.3F, 0.5F, 0.24F))};
    SceneFile without = scene;
    without.bodies[0].layers.layers = 2;
    scene.bodies[0].layers.layers = 2;
    scene.colliders = {sheet(0.4F, 2)};
    auto grating = start(*device, scene), free = start(*device, without);
    scene.colliders = {sheet(0.4F, 1)};
    auto closed = start(*device, scene);
    ASSERT_TRUE(grating && free && closed);
    run(*grating, 0.5);
    run(*free, 0.5);
    run(*closed, 0.5);
    EXPECT_LT(lowest(grating->world()), 0.06F);
    EXPECT_TRUE(device->readAll<vec4>(*grating->world().particles().position, 50) ==
                device->readAll<vec4>(*free->world().particles().position, 50))
        << "the water does not depend on what it does not meet";
    EXPECT_NEAR(grating->world().bodies()[0].pose.position.y, 0.46F, 0.02F);
    EXPECT_EQ(grating->world().bodies()[0].pose.position, closed->world().bodies()[0].pose.position) << "the crate meets both sheets alike";
    EXPECT_LT(free->world().bodies()[0].pose.position.y, 0.1F) << "without the grating it lies on the floor";
    EXPECT_GT(lowest(closed->world()), 0.38F);
    EXPECT_EQ(grating->fields().still, nullptr) << "nothing was baked";
}

// Of three crates that fall onto each other's place one passes through the others, because the masks say so; the other two are a stack.
TEST(Layers, BodiesPassThroughEachOther) {
    auto device = cpu();
    SceneFile scene = room();
    scene.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.08F)}};
    scene.bodies = {crate(vec3(0.3F, 0.061F, 0.2F)), crate(vec3(0.3F, 0.25F, 0.2F)), crate(vec3(0.3F, 0.5F, 0.2F))};
    for (BodyParams& b : scene.bodies) b.layers = {2, 2};
    scene.bodies[1].layers = {4, 4};
    auto session = start(*device, scene);
    ASSERT_TRUE(session);
    run(*session, 0.7);
    const std::vector<BodyState>& b = session->world().bodies();
    EXPECT_NEAR(b[0].pose.position.y, 0.06F, 0.005F);
    EXPECT_NEAR(b[1].pose.position.y, 0.06F, 0.005F) << "where the first one is";
    EXPECT_NEAR(b[2].pose.position.y, 0.18F, 0.01F) << "on the first one";
}

// A plane that the water does not meet holds bodies alone, and a lift that the water does not meet carries a crate up.
TEST(Layers, PlanesAndMovingColliders) {
    auto device = cpu();
    SceneFile scene = room();
    scene.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.6F, 0.08F, 0.34F)}};
    ColliderParams floor;
    floor.shape = "plane";
    floor.position = vec3(0.0F, 0.3F, 0.0F);
    floor.layers.layers = 2;
    scene.colliders = {floor};
    scene.bodies = {crate(vec3(0.3F, 0.4F, 0.17F))};
    auto session = start(*device, scene);
    ASSERT_TRUE(session);
    EXPECT_GT(session->world().particles().count, 0U) << "behind the plane, which would have left it out";
    run(*session, 0.4);
    EXPECT_NEAR(session->world().bodies()[0].pose.position.y, 0.36F, 0.01F);
    EXPECT_LT(lowest(session->world()), 0.05F);

    scene.colliders = {sheet(0.3F, 2)};
    scene.colliders[0].motion.keys = {{.time = 0.2F, .position = {}, .rotation = {}},
                                      {.time = 0.8F, .position = vec3(0.0F, 0.2F, 0.0F), .rotation = {}}};
    auto lift = start(*device, scene);
    ASSERT_TRUE(lift);
    run(*lift, 0.9);
    EXPECT_NEAR(lift->world().bodies()[0].pose.position.y, 0.56F, 0.02F);
    EXPECT_TRUE(lift->world().poses().empty()) << "the water has no solid";
    lift->reset();
    run(*lift, 0.2);
    EXPECT_NEAR(lift->world().bodies()[0].pose.position.y, 0.36F, 0.02F);
}

TEST(Layers, WhatCannotBeIsRefused) {
    auto device = cpu();
    SceneFile scene = room();
    scene.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.08F)}};
    scene.colliders = {sheet(0.4F, 2)};
    scene.colliders[0].wave.amplitude = 0.02F;
    const auto session = Session::create(scene, *device, {});
    ASSERT_FALSE(session);
    EXPECT_NE(session.error().message.find("the water does not meet it"), std::string::npos) << session.error().message;
}

}  // namespace
}  // namespace rivulet::layers_test
