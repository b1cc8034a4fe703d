// Model files as colliders: parts, animations, models that are only drawn, cameras and lights. Compared with places computed by hand.
#include "fluid/scene/collider_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/device_cpu.h"
#include "engine/scene/transform.h"
#include "fluid/io/recording.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/unit/gltf_file.h"
#include "tests/unit/program_runner.h"

namespace rivulet::collider_model_test {
namespace {

using testing::Scratch;

constexpr float kHalf = 0.70710678F;

// A bar of 0.2 x 0.04 x 0.04 m that turns about z, through a point 0.3 m up, a quarter in half a second; with `post`, beside one that
// stands still. A camera, a light, and a blue material for the post.
std::string turnstile(const Scratch& scratch, bool post) {
    GltfFile file;
    const std::string bar = file.box(-0.1F, 0.1F, -0.02F, 0.02F, -0.02F, 0.02F),
                      other = file.box(-0.02F, 0.02F, 0, 0.1F, -0.02F, 0.02F, R"(,"material":0)");
    const int t = file.floats("SCALAR", {0, 0.5F}), turn = file.floats("VEC4", {0, 0, 0, 1, 0, 0, kHalf, kHalf});
    return file.write(scratch.path(), post ? "post" : "turnstile",
                      fmt::format(R"("scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"all","children":[1,{4}2,3]}},{{"name":"bar","mesh":0,"translation":[0,0.3,0]}},{{"name":"eye","camera":0,"translation":[0,0.25,1]}},
{{"name":"lamp","rotation":[-{6},0,0,{6}],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}},{{"name":"post","mesh":1,"translation":[0.3,0,0]}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"directional","color":[1,0.5,0.25],"intensity":2}}]}}}},
"materials":[{{"name":"blue","pbrMetallicRoughness":{{"baseColorFactor":[0.1,0.2,0.8,1],"metallicFactor":0,"roughnessFactor":0.5}}}}],
"meshes":[{0},{1}],"animations":[{{"name":"turn","samplers":[{{"input":{2},"output":{3}}}],"channels":[{{"sampler":0,"target":{{"node":1,"path":"rotation"}}}}]}}])",
                                  bar, other, t, turn, post ? "4," : "", 0, kHalf));
}

SceneFile sceneWith(const std::string& mesh) {
    SceneFile scene;
    scene.fluid.spacing = 0.02F;
    scene.fluid.box = {vec3(-0.4F, 0, -0.1F), vec3(0.4F, 0.6F, 0.1F)};
    scene.fluid.blocks = {{.min = vec3(-0.38F, 0.01F, -0.08F), .max = vec3(0.38F, 0.2F, 0.08F)}};
    ColliderParams collider;
    collider.mesh = mesh;
    collider.position = vec3(0.05F, 0, 0);
    scene.colliders = {collider};
    return scene;
}

vec3 turnedAboutZ(const vec3& p, const vec3& centre, float degrees) {
    const float a = degrees * kPi / 180;
    const vec3 d = p - centre;
    return centre + vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
}

int nodeCalled(const Scene& scene, const std::string& name) {
    for (size_t k = 0; k < scene.nodes().size(); ++k)
        if (scene.nodes()[k].name == name && !scene.nodes()[k].mesh) return static_cast<int>(k);
    return -1;
}

class ColliderModelTest : public ::testing::Test {
  protected:
    void SetUp() override { device_ = makeCpuDevice(cpuKernels()); }
    void refused(const SceneFile& scene, const std::string& words) {
        Status sense = checkScene(scene);
        std::string message = sense ? "" : sense.error().message;
        if (sense) {
            const auto session = Session::create(scene, *device_, {});
            ASSERT_FALSE(session) << words;
            message = session.error().message;
        }
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    std::unique_ptr<CpuDevice> device_;
    Scratch scratch_;
};

TEST_F(ColliderModelTest, AClipThatMovesAllOfAFileIsARigidSolid) {
    SceneFile scene = sceneWith(turnstile(scratch_, false));
    scene.colliders[0].animation.speed = 2;
    scene.colliders[0].scale = 1.5F;
    Scene nodes;
    Result<ColliderModel> model = ColliderModel::create(scene.colliders[0], "", *device_, nodes);
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_TRUE(model->rigid());
    const vec3 centre(0.05F, 0.45F, 0);  // the node's place, scaled and moved
    EXPECT_LT(glm::distance(model->pose(0).position, centre), 1e-5F);
    for (const double time : {0.0, 0.1, 0.2, 0.3}) {  // at twice the speed a quarter takes 0.25 s, then it begins again
        const auto degrees = static_cast<float>(360 * std::fmod(time, 0.25));
        const Pose pose = model->pose(time);
        for (const vec3& own : model->mesh().positions)
            EXPECT_LT(glm::distance(pose.toWorld(own), turnedAboutZ(centre + own, centre, degrees)), 1e-5F) << time;
    }
    scene.colliders[0].animation.loops = false;
    Scene more;
    model = ColliderModel::create(scene.colliders[0], "", *device_, more);
    ASSERT_TRUE(model);
    EXPECT_LT(glm::distance(model->pose(7).rotation * vec3(1, 0, 0), vec3(0, 1, 0)), 1e-5F) << "it stays as it ends";
}

TEST_F(ColliderModelTest, AClipThatMovesNoPartLeavesAWall) {
    GltfFile file;
    const std::string box = file.box(-0.1F, 0.1F, 0, 0.1F, -0.02F, 0.02F);
    const int t = file.floats("SCALAR", {0, 1}), way = file.floats("VEC3", {0, 0, 1, 0, 0, 2}),
              stays = file.floats("VEC3", {0.1F, 0, 0, 0.1F, 0, 0});
    SceneFile scene = sceneWith(file.write(scratch_.path(), "still",
                                           fmt::format(R"("scenes":[{{"nodes":[0,1]}}],
"nodes":[{{"name":"box","mesh":0}},{{"name":"eye","camera":0}}],"cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"znear":0.1}}}}],"meshes":[{0}],
"animations":[{{"name":"ride","samplers":[{{"input":{1},"output":{2}}},{{"input":{1},"output":{3}}}],
"channels":[{{"sampler":0,"target":{{"node":1,"path":"translation"}}}},{{"sampler":1,"target":{{"node":0,"path":"translation"}}}}]}}])",
                                                       box, t, way, stays)));
    scene.colliders[0].animation.speed = 1;
    const auto made = Session::create(scene, *device_, {});
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_TRUE((*made)->fields().rigid.empty());
    EXPECT_TRUE((*made)->fields().deforming.empty());
    ASSERT_NE((*made)->fields().still, nullptr);
    const int node = nodeCalled((*made)->solids(), "box");
    EXPECT_LT(glm::distance(vec3((*made)->solids().worldMatrices()[static_cast<size_t>(node)][3]), vec3(0.15F, 0, 0)), 1e-6F)
        << "as at t = 0";
}

TEST_F(ColliderModelTest, AClipThatMovesAPartBendsTheSolidAndItsNodes) {
    SceneFile scene = sceneWith(turnstile(scratch_, true));
    scene.colliders[0].animation.speed = 1;
    scene.colliders[0].animation.clip = "turn";
    Result<std::unique_ptr<Session>> made = Session::create(scene, *device_, {});
    ASSERT_TRUE(made) << made.error().message;
    Session& session = **made;
    ASSERT_EQ(session.fields().deforming.size(), 1U);
    const vec3 centre(0.05F, 0.3F, 0);
    const int bar = nodeCalled(session.solids(), "bar");
    ASSERT_GE(bar, 0);
    for (int frame = 0; frame <= 24; ++frame) {
        if (frame > 0) session.step(1.0 / 60, true);
        const auto degrees = static_cast<float>(180 * std::fmod(session.world().time(), 0.5));
        RecordedFrame now;
        session.placesInto(now);
        ASSERT_EQ(now.corners.size(), 16U);
        for (size_t k = 0; k < 16; ++k) {
            const bool turns = k < 8;
            const vec3 rest =
                turns ? vec3((k & 1U) != 0 ? 0.1F : -0.1F, (k & 2U) != 0 ? 0.02F : -0.02F, (k & 4U) != 0 ? 0.02F : -0.02F) + centre
                      : vec3((k & 1U) != 0 ? 0.37F : 0.33F, (k & 2U) != 0 ? 0.1F : 0.0F, (k & 4U) != 0 ? 0.02F : -0.02F);
            EXPECT_LT(glm::distance(now.corners[k], turns ? turnedAboutZ(rest, centre, degrees) : rest), 1e-4F) << "frame " << frame;
        }
        const mat4 place = session.solids().worldMatrices()[static_cast<size_t>(bar)];
        EXPECT_LT(glm::distance(transformPoint(place, vec3(0.1F, 0, 0)), turnedAboutZ(centre + vec3(0.1F, 0, 0), centre, degrees)), 1e-4F);
    }
    session.reset();
    const mat4 place = session.solids().worldMatrices()[static_cast<size_t>(bar)];
    EXPECT_LT(glm::distance(transformPoint(place, vec3(0.1F, 0, 0)), centre + vec3(0.1F, 0, 0)), 1e-5F);
}

TEST_F(ColliderModelTest, AModelThatIsOnlyDrawnIsNotSolid) {
    SceneFile scene = sceneWith(turnstile(scratch_, true));
    scene.colliders[0].position.y = -0.2F;  // its bar lies in the water
    const auto solid = Session::create(scene, *device_, {});
    ASSERT_TRUE(solid) << solid.error().message;
    scene.colliders[0].solid = false;
    const auto ghost = Session::create(scene, *device_, {});
    ASSERT_TRUE(ghost) << ghost.error().message;
    const std::vector<ColliderParams> colliders = std::exchange(scene.colliders, {});
    const auto none = Session::create(scene, *device_, {});
    ASSERT_TRUE(none);
    EXPECT_EQ((*ghost)->fields().first(), nullptr);
    EXPECT_EQ((*ghost)->world().particles().count, (*none)->world().particles().count);
    EXPECT_LT((*solid)->world().particles().count, (*none)->world().particles().count);
    EXPECT_EQ((*ghost)->solids().nodes().size(), (*solid)->solids().nodes().size());
    // It moves, all the same: by a motion, and by its own clip.
    scene.colliders = colliders;
    scene.colliders[0].motion.axis = vec3(0, 1, 0);
    scene.colliders[0].motion.spin = 90;
    const auto spun = Session::create(scene, *device_, {});
    ASSERT_TRUE(spun) << spun.error().message;
    scene.colliders[0].motion.spin = 0;
    scene.colliders[0].animation.speed = 1;
    const auto played = Session::create(scene, *device_, {});
    ASSERT_TRUE(played) << played.error().message;
    for (int k = 0; k < 12; ++k) {
        (*spun)->step(1.0 / 60, true);
        (*played)->step(1.0 / 60, true);
    }
    const vec3 centre(0.05F, 0.1F, 0);
    const auto placeIn = [](const Session& s) { return s.solids().worldMatrices()[static_cast<size_t>(nodeCalled(s.solids(), "bar"))]; };
    const auto a = static_cast<float>((*spun)->world().time() * kPi / 2), b = static_cast<float>((*played)->world().time() * 180);
    EXPECT_LT(glm::distance(transformPoint(placeIn(**spun), vec3(0.1F, 0, 0)), centre + 0.1F * vec3(std::cos(a), 0, -std::sin(a))), 1e-4F);
    EXPECT_LT(glm::distance(transformPoint(placeIn(**played), vec3(0.1F, 0, 0)), turnedAboutZ(centre + vec3(0.1F, 0, 0), centre, b)),
              1e-4F);
}

TEST_F(ColliderModelTest, MaterialsAreTheFilesUnlessTheSceneSetsThem) {
    SceneFile scene = sceneWith(turnstile(scratch_, true));
    scene.colliders[0].colour = vec3(0.9F, 0.1F, 0.1F);
    std::vector<std::string> said;
    auto made = Session::create(scene, *device_, Log{[&](LogLevel, std::string_view text) { said.emplace_back(text); }});
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(std::count_if(said.begin(), said.end(),
                            [](const std::string& s) { return s.find("the materials of its file") != std::string::npos; }),
              1);
    const auto colours = [&] {
        std::vector<vec3> all;
        for (const Node& node : (*made)->solids().nodes())
            if (node.mesh) all.push_back(node.material.baseColour);
        return all;
    };
    EXPECT_EQ(colours(), (std::vector<vec3>{vec3(0.9F, 0.1F, 0.1F), vec3(0.1F, 0.2F, 0.8F)})) << "the bar has none in its file";
    scene.colliders[0].materials = "scene";
    (*made)->apply(scene);
    EXPECT_EQ(colours(), (std::vector<vec3>{vec3(0.9F, 0.1F, 0.1F), vec3(0.9F, 0.1F, 0.1F)}));
}

TEST_F(ColliderModelTest, ACameraAndALightComeFromAFile) {
    SceneFile scene = sceneWith(turnstile(scratch_, false));
    scene.colliders[0].rotation = vec3(0, 90, 0);  // what looked along -z looks along -x
    scene.camera.from = "eye";
    scene.light.from = "lamp";
    const auto made = Session::create(scene, *device_, {});
    ASSERT_TRUE(made) << made.error().message;
    const SceneFile& taken = (*made)->scene();
    EXPECT_LT(glm::distance(taken.camera.position, vec3(1.05F, 0.25F, 0)), 1e-5F);
    EXPECT_LT(glm::distance(taken.camera.target, vec3(0, 0.25F, 0)), 1e-5F) << "ahead, abreast of the box's middle";
    EXPECT_NEAR(taken.camera.fieldOfView, 0.5F * 180 / kPi, 1e-3F);
    EXPECT_LT(glm::distance(taken.light.direction, vec3(0, 1, 0)), 1e-5F);
    EXPECT_LT(glm::distance(taken.light.colour, vec3(1, 0.5F, 0.25F)), 1e-5F);
    EXPECT_EQ(taken.light.intensity, LightParams().intensity);
}

TEST_F(ColliderModelTest, AContradictionIsOneSentence) {
    const std::string file = turnstile(scratch_, true);
    SceneFile scene = sceneWith(file);
    scene.colliders[0].animation = {"turm", 1, true};
    refused(scene, "no animation `turm`; there is turn; did you mean turn?");
    scene.colliders[0].animation = {"", 1, true};
    scene.colliders[0].motion.spin = 9;
    refused(scene, "colliders[0] has an animation and a motion");
    scene = sceneWith(file);
    scene.colliders[0].solid = false;
    scene.colliders[0].wave.amplitude = 0.1F;
    refused(scene, "has a wave and is not solid");
    scene = sceneWith(file);
    scene.camera.from = "eyes";
    refused(scene, "camera.from is `eyes`, which no collider's file has; there is eye; did you mean eye?");
    scene = sceneWith("meshes/spot.obj");
    scene.light.from = "lamp";
    refused(scene, "light.from is `lamp`, but no collider's file has a light");
    scene.light.from = "";
    scene.colliders[0].animation.speed = 1;
    refused(scene, "colliders[0] (meshes/spot.obj): the file has no animation to play");
    scene = sceneWith(file);
    scene.colliders[0].animation.speed = 1;
    BodyParams ball;
    ball.shape = "sphere";
    ball.radius = 0.05F;
    ball.position = vec3(-0.2F, 0.4F, 0);
    scene.bodies = {ball};
    refused(scene, "colliders[0] bends, and bodies would pass through it");
}

}  // namespace
}  // namespace rivulet::collider_model_test
