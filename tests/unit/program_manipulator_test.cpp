// A person's hand in the picture: a body is lifted and thrown, meshes and emitters are chosen, moved and turned by their handles.
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>
#include <filesystem>
#include <string_view>

#include "engine/core/json.h"
#include "engine/scene/pick.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/sim/world/host_particles.h"
#include "fluid/viewer/manipulator.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_manipulator_test {
namespace {

TEST(ScenePick, ARayMeetsTheNearestVisibleTriangleFromEitherSide) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    mesh->indices = {0, 1, 2};
    Scene scene;
    Node group;
    group.local = glm::translate(mat4(1.0F), vec3(0, 0, 3));
    const int parent = scene.add(group);
    for (const float z : {0.0F, -1.0F, -2.0F}) {
        Node node;
        node.parent = parent;
        node.mesh = mesh;
        node.local = glm::scale(glm::translate(mat4(1.0F), vec3(0, 0, z)), vec3(2.0F));
        node.visible = z != -2.0F;
        scene.add(node);
    }
    const auto from = [&](float z, float way) { return pick(scene, vec3(0.1F, 0.2F, z), vec3(0, 0, way)); };
    ASSERT_TRUE(from(0, 0.5F) && from(9, -2));
    EXPECT_EQ(from(0, 0.5F)->node, 2U) << "the one at z 1 is hidden, that at 2 is the first";
    EXPECT_FLOAT_EQ(from(0, 0.5F)->place.z, 2.0F);
    EXPECT_FLOAT_EQ(from(0, 0.5F)->distance, 4.0F);
    EXPECT_EQ(from(0, 0.5F)->normal, vec3(0, 0, -1));
    EXPECT_EQ(from(9, -2)->node, 1U);
    EXPECT_FLOAT_EQ(from(9, -2)->place.z, 3.0F);
    EXPECT_EQ(from(9, -2)->normal, vec3(0, 0, 1));
    EXPECT_FALSE(from(9, 2));
    EXPECT_FALSE(pick(scene, vec3(5, 0, 0), vec3(0, 0, 1)));
}

class Hand : public testing::ViewerFixture {
  protected:
    void SetUp() override {
        SceneFile scene;
        scene.name = "hand";
        scene.fluid.spacing = 0.05F;
        scene.look.renderer = "points";
        scene.fluid.blocks = {{.min = vec3(0.05F), .max = vec3(0.95F, 0.2F, 0.3F)}};
        scene.bodies.resize(1);
        scene.bodies[0].size = vec3(0.2F);
        scene.bodies[0].position = vec3(0.5F, 0.2F, 0.7F);
        scene.colliders.resize(1);
        scene.colliders[0].mesh = "meshes/spot.obj";
        scene.colliders[0].fitSize = 0.3F;
        scene.colliders[0].position = vec3(0.5F, 0.6F, 0.3F);
        scene.colliders[0].resolution = 16;
        scene.emitters.resize(1);
        scene.emitters[0].position = vec3(0.2F, 0.8F, 0.8F);
        scene.emitters[0].litresPerSecond = 0.5F;
        begin(scene, kWindow, {140, 70});
        moveTo(vec2(690, 690));
        frame();
    }
    Camera camera() { return cameraOf(viewer_->scene().camera, viewer_->session().bounds()); }
    vec2 seen(const vec3& p) { return *seenAt(camera(), p, vec2(kWindow)); }
    vec3 bodyAt() { return viewer_->session().world().bodies()[0].pose.position; }
    void choose(const vec3& at) {
        moveTo(seen(at));
        press(true);
        press(false);
    }
    // Along an axis, from a place on the arrow.
    void drag(const vec3& from, const vec3& to) {
        moveTo(seen(from));
        press(true);
        for (int k = 1; k <= 4; ++k) moveTo(seen(glm::mix(from, to, 0.25F * static_cast<float>(k))));
        press(false);
        settle();
    }

    static constexpr ivec2 kWindow{1400, 700};
    static constexpr double kFrame = 1.0 / 60;
};

TEST_F(Hand, LiftsABodyAndThrowsIt) {
    for (int k = 0; k < 20; ++k) frame(kFrame);
    const vec3 rest = bodyAt();
    EXPECT_LT(rest.y, 0.2F) << "it has fallen to the floor";
    const CameraParams before = viewer_->scene().camera;
    moveTo(seen(rest));
    press(true, MouseButton::left, kFrame);
    EXPECT_TRUE(viewer_->hand().holds());
    const ViewRay ray = rayThrough(camera(), input_.mouse, vec2(kWindow));
    const Pose taken = viewer_->session().world().bodies()[0].pose;
    const vec3 grip = glm::inverse(taken.rotation) * (viewer_->session().meet(ray.origin, ray.direction)->place - taken.position);
    const vec2 up = seen(rest + vec3(0, 0.4F, 0));
    for (int k = 1; k <= 40; ++k) moveTo(glm::mix(seen(rest), up, std::min(static_cast<float>(k) / 20.0F, 1.0F)), kFrame);
    for (int k = 0; k < 60; ++k) frame(kFrame);
    const Pose lifted = viewer_->session().world().bodies()[0].pose;
    EXPECT_LT(glm::distance(seen(lifted.position + lifted.rotation * grip), up), 6.0F) << "it hangs where the hand has it";
    EXPECT_GT(lifted.position.y, rest.y + 0.25F);
    EXPECT_LT(glm::length(viewer_->session().world().bodies()[0].velocity), 0.1F);
    EXPECT_EQ(viewer_->scene().camera.position, before.position) << "the view stays";

    // 0.3 m within a tenth of a second, and let go.
    const vec3 high = bodyAt();
    for (int k = 1; k <= 6; ++k) moveTo(seen(high + vec3(-0.05F * static_cast<float>(k), 0, 0)), kFrame);
    press(false, MouseButton::left, kFrame);
    EXPECT_FALSE(viewer_->hand().holds());
    const BodyState thrown = viewer_->session().world().bodies()[0];
    EXPECT_LT(thrown.velocity.x, -0.5F);
    for (int k = 0; k < 6; ++k) frame(kFrame);
    const BodyState flies = viewer_->session().world().bodies()[0];
    EXPECT_NEAR(flies.velocity.y - thrown.velocity.y, -9.81F * 0.1F, 0.15F) << "nothing holds it any more";
    EXPECT_LT(flies.pose.position.x, thrown.pose.position.x - 0.05F);
    for (int k = 0; k < 60; ++k) frame(kFrame);
    EXPECT_TRUE(isFinite(bodyAt()));
    EXPECT_EQ(glm::clamp(bodyAt(), vec3(0.0F), vec3(1.0F)), bodyAt()) << "it stays in the box";
}

// However hard one pulls, through walls and far outside, it comes back.
TEST_F(Hand, PullsThroughNoWall) {
    moveTo(seen(bodyAt()));
    press(true, MouseButton::left, kFrame);
    for (int k = 0; k < 60; ++k) moveTo({360.0F + static_cast<float>(k * 211 % 640), static_cast<float>(k * 137 % 690)}, kFrame);
    press(false, MouseButton::left, kFrame);
    for (int k = 0; k < 60; ++k) frame(kFrame);
    EXPECT_EQ(glm::clamp(bodyAt(), vec3(0.0F), vec3(1.0F)), bodyAt());
    EXPECT_EQ(viewer_->session().world().stats().nan, 0U);
    EXPECT_LT(glm::length(viewer_->session().world().bodies()[0].velocity), 3.0F);
}

TEST_F(Hand, MovesAMeshByItsHandlesAndPutsItBack) {
    const vec3 was = viewer_->scene().colliders[0].position;
    choose(was);
    ASSERT_EQ(viewer_->hand().chosen(), (Session::Thing{Session::Thing::Kind::collider, 0}));
    const vec3 middle = viewer_->session().boundsOf(viewer_->hand().chosen()).centre();
    const float length = 0.1F * glm::distance(camera().position, middle);
    const auto heightOfAll = [&] {
        double sum = 0;
        for (const vec4& p : readParticles(viewer_->session().world()).position) sum += double{p.y};
        return sum;
    };
    for (int k = 0; k < 6; ++k) frame(kFrame);
    const double time = viewer_->session().time();
    const double height = heightOfAll();
    const Bounds water = [&] {
        Bounds b;
        b.add(viewer_->session().field().surface.origin);
        return b;
    }();
    drag(middle + vec3(0, length, 0), middle + vec3(0, length - 0.15F, 0));
    EXPECT_NEAR(viewer_->scene().colliders[0].position.y, was.y - 0.15F, 0.01F);
    EXPECT_FLOAT_EQ(viewer_->scene().colliders[0].position.x, was.x) << "along one axis";
    EXPECT_NEAR(viewer_->session().field().surface.origin.y, water.min.y - 0.15F, 0.02F) << "water meets it where it now is";
    EXPECT_EQ(viewer_->hand().chosen(), (Session::Thing{Session::Thing::Kind::collider, 0})) << "it is still chosen";
    EXPECT_EQ(viewer_->session().time(), time) << "and the water goes on";
    EXPECT_GT(time, 0);
    EXPECT_NEAR(heightOfAll(), height, 1.0e-6);

    withControl('Z');
    settle();
    EXPECT_EQ(viewer_->scene().colliders[0].position, was);

    // By its ring, 30 degrees about y.
    const float radius = 0.75F * 0.16F * glm::distance(camera().position, middle);
    const auto ring = [&](float degrees) {
        return middle + radius * vec3(std::sin(degrees * kPi / 180.0F), 0, std::cos(degrees * kPi / 180.0F));
    };
    moveTo(seen(ring(20)));
    press(true);
    for (const float degrees : {30.0F, 40.0F, 50.0F}) moveTo(seen(ring(degrees)));
    press(false);
    settle();
    EXPECT_NEAR(viewer_->scene().colliders[0].rotation.y, 30.0F, 1.0F);
    EXPECT_NEAR(viewer_->scene().colliders[0].rotation.x, 0.0F, 0.2F);
    EXPECT_EQ(viewer_->scene().colliders[0].position, was);
}

// What the world takes while it runs moves while water flows.
TEST_F(Hand, AnEmitterMovesAtOnce) {
    for (int k = 0; k < 5; ++k) frame(kFrame);
    viewer_->chooseThing({Session::Thing::Kind::emitter, 0});
    frame();
    const vec3 was = viewer_->scene().emitters[0].position;
    const float length = 0.1F * glm::distance(camera().position, was);
    const double time = viewer_->session().time();
    drag(was + vec3(length, 0, 0), was + vec3(length + 0.2F, 0, 0));
    EXPECT_NEAR(viewer_->scene().emitters[0].position.x, was.x + 0.2F, 0.01F);
    EXPECT_EQ(viewer_->session().time(), time) << "the same water";
}

// P makes room and keeps the water; then the left button pours where it points, and turns no view.
TEST_F(Hand, PoursWhereTheMousePoints) {
    for (int k = 0; k < 4; ++k) frame(kFrame);
    const double time = viewer_->session().time();
    const auto count = [&] { return readParticles(viewer_->session().world()).position.size(); };
    const size_t held = count();
    const vec3 place(0.8F, 0.0F, 0.6F);
    moveTo(seen(place));
    key('P');
    settle();
    EXPECT_TRUE(viewer_->brush().on());
    EXPECT_GT(viewer_->scene().pour.litres, 1);
    EXPECT_EQ(viewer_->session().time(), time) << "the same water";
    EXPECT_NEAR(static_cast<double>(count()), static_cast<double>(held), 2) << "but the emitter's";
    const vec3 eye = viewer_->scene().camera.position;
    press(true, MouseButton::left, kFrame);
    for (int k = 0; k < 20; ++k) moveTo(seen(place) + vec2(k % 2, 0), kFrame);
    const size_t poured = count();
    EXPECT_GT(poured, held + 100);
    EXPECT_EQ(viewer_->scene().camera.position, eye);
    EXPECT_EQ(viewer_->message(), "");
    press(false, MouseButton::left, kFrame);
    EXPECT_EQ(viewer_->hand().chosen(), Session::Thing{}) << "no click";
    for (int k = 0; k < 3; ++k) frame(kFrame);
    EXPECT_LT(count(), poured + 20) << "let go of, it ends; the scene's own emitter goes on";
    key(key::kEscape);
    EXPECT_FALSE(viewer_->brush().on());
    press(true, MouseButton::left, kFrame);
    moveTo(seen(place) + vec2(40, 0), kFrame);
    press(false, MouseButton::left, kFrame);
    EXPECT_NE(viewer_->scene().camera.position, eye) << "the button turns the view again";
    const std::string path = "poured.json";
    SceneFile saved = viewer_->scene();
    ASSERT_TRUE(saveScene(saved, path));
    const auto again = loadScene(path, {});
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->pour.litres, saved.pour.litres);
    std::filesystem::remove(path);
}

TEST_F(Hand, NoBrushIsLeftWhereNothingCanBePoured) {
    key('P');
    settle();
    ASSERT_TRUE(viewer_->brush().on());
    ASSERT_TRUE(hover("###scene", {"reset all"}));
    click();
    settle();
    EXPECT_EQ(viewer_->scene().pour.litres, 0);
    EXPECT_FALSE(viewer_->brush().on());
}

TEST_F(Hand, ReportsThatNoSlotIsLeftForPouring) {
    SceneFile little = viewer_->scene();
    little.emitters.clear();
    little.pour.litres = 3;
    viewer_->open(little);
    settle();
    const vec3 place(0.8F, 0.0F, 0.6F);
    moveTo(seen(place));
    key('P');
    press(true, MouseButton::left, kFrame);
    EXPECT_EQ(viewer_->message(), "");
    for (int k = 0; k < 120 && viewer_->message().empty(); ++k) moveTo(seen(place) + vec2(k % 2, 0), kFrame);
    EXPECT_NE(viewer_->message().find("pour.litres"), std::string::npos)
        << viewer_->session().world().stats().particles << " of " << viewer_->session().world().particles().count;
}

TEST_F(Hand, TheTreeChoosesHidesAndLooksUp) {
    frame();
    ASSERT_TRUE(hover("tree", {"###things"}));
    click();
    frame();
    EXPECT_TRUE(viewer_->scene().colliders[0].visible);
    ASSERT_TRUE(hover("tree", {"#0", "##drawn"}));
    click();
    EXPECT_FALSE(viewer_->scene().colliders[0].visible);
    EXPECT_FALSE(viewer_->session().solids().visible()[0]) << "it is no longer drawn";
    ASSERT_TRUE(hover("tree", {"#0", "##drawn"}));
    click();
    ASSERT_TRUE(hover("tree", {"#0", "##row"}));
    click();
    EXPECT_EQ(viewer_->hand().chosen(), (Session::Thing{Session::Thing::Kind::collider, 0}));
    EXPECT_FALSE(hover("parameters", {"fluid", "fluid"})) << "only its parameters are shown";
    for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (std::string_view(window->Name).find("parameters") != std::string_view::npos)
            EXPECT_GT(window->ContentSize.y, 300.0F) << "and they are unfolded";
}

TEST_F(Hand, ADragBesideAllTurnsTheViewAndAClickThereChoosesNothing) {
    choose(viewer_->scene().colliders[0].position);
    EXPECT_NE(viewer_->hand().chosen().kind, Session::Thing::Kind::none);
    const vec3 before = viewer_->scene().camera.position;
    moveTo({700, 30});
    press(true);
    moveTo({760, 30});
    press(false);
    EXPECT_NE(viewer_->scene().camera.position, before);
    EXPECT_NE(viewer_->hand().chosen().kind, Session::Thing::Kind::none) << "a drag chooses nothing else";
    press(true);
    press(false);
    EXPECT_EQ(viewer_->hand().chosen().kind, Session::Thing::Kind::none);
}

}  // namespace
}  // namespace rivulet::program_manipulator_test
