// dressHead finds in the head's meshes the values in head.json, which make_head computed from its own formulas.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/import_model.h"
#include "fluid/scene/head_look.h"

namespace rivulet::head_look_test {
namespace {

const std::string kHead = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/head/";

TEST(HeadLook, eyeballsHaveThePositionsOfHeadJson) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head);
    for (const float side : {1.0F, -1.0F}) {
        const EyeLook eye = eyeLookOf(head->find(side > 0 ? "eyeLeft" : "eyeRight")->mesh);
        EXPECT_LT(glm::distance(eye.centre, vec3(side * 0.0317F, 0.0268F, 0.0260F)), 1e-4F);
        EXPECT_NEAR(eye.radius, 0.0120F, 1e-4F);
        EXPECT_GT(eye.sight.z, 0.99F);
        EXPECT_LT(side * eye.sight.x, 0.0F) << "eyes turn towards each other a little";
    }
}

TEST(HeadLook, aTearLineFollowsTheLowerLid) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head);
    ASSERT_TRUE(dressHead(*head, kHead));
    const ModelPart* line = head->find("tearLineLeft");
    ASSERT_NE(line, nullptr);
    ASSERT_NE(head->find("tearLineRight"), nullptr);
    EXPECT_TRUE(line->material.blended);
    // Every third point of head.json's lower_lid_margin, without the corners.
    const vec3 margin[] = {{0.023317F, 0.024326F, 0.035764F}, {0.026281F, 0.023210F, 0.036903F}, {0.029608F, 0.022417F, 0.038281F},
                           {0.033109F, 0.022293F, 0.038291F}, {0.036504F, 0.023071F, 0.037118F}, {0.039239F, 0.024336F, 0.035848F}};
    for (const vec3& p : margin) {
        float nearest = 1;
        for (const vec3& q : line->mesh.positions) nearest = std::min(nearest, glm::distance(p, q));
        EXPECT_LT(nearest, 1.0e-3F) << p.x;
    }
    const EyeLook eye = *head->find("eyeLeft")->material.eye;
    for (const vec3& q : line->mesh.positions) EXPECT_GT(glm::distance(q, eye.centre), eye.radius) << "inside the eye";
    ASSERT_EQ(line->morphs.size(), head->find("skin")->morphs.size() + 1) << "the skin's, and how full the lid is";
    EXPECT_EQ(line->morphs.back().name, "brimLeft");
    float risen = 0;
    for (const vec3& offset : line->morphs.back().offsets) risen = std::max(risen, offset.y);
    EXPECT_GT(risen, 4e-4F) << "a full lid's film is higher";
    const auto squint = std::find_if(line->morphs.begin(), line->morphs.end(), [](const MorphTarget& m) { return m.name == "squintLeft"; });
    ASSERT_NE(squint, line->morphs.end());
    float up = 0;
    for (const vec3& offset : squint->offsets) up = std::max(up, offset.y);
    EXPECT_GT(up, 2e-4F) << "a squint lifts the lower lid";
}

// With other names for its parts it is any head: its eyes are found, and get what a found eye can have.
TEST(HeadLook, foundEyesAreWetAndHaveATearLine) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head);
    size_t skin = 0;
    std::string left;
    for (size_t p = 0; p < head->parts.size(); ++p) {
        ModelPart& part = head->parts[p];
        if (part.name == "skin") skin = p;
        if (!part.name.starts_with("eye")) continue;
        part.name = "ball" + part.name.substr(3);
        part.material.roughness = 0.6F;
    }
    const FoundFace face = findFace(head->parts, skin);
    ASSERT_EQ(face.by, FoundFace::By::balls) << face.missing;
    wetFoundEyes(*head, skin, face);
    EXPECT_LT(head->find("ballLeft")->material.roughness, 0.1F);
    for (const float side : {1.0F, -1.0F}) {
        const ModelPart* line = head->find(side > 0 ? "tearLineLeft" : "tearLineRight");
        ASSERT_NE(line, nullptr);
        for (const vec3& p : {vec3(0.026281F, 0.023210F, 0.036903F), vec3(0.033109F, 0.022293F, 0.038291F)}) {  // of head.json's margin
            float nearest = 1;
            for (const vec3& q : line->mesh.positions) nearest = std::min(nearest, glm::distance(p * vec3(side, 1, 1), q));
            EXPECT_LT(nearest, 1.0e-3F);
        }
        EXPECT_EQ(line->morphs.back().name, side > 0 ? "brimLeft" : "brimRight");
    }
    const size_t parts = head->parts.size();
    head->parts[0].material.eye = std::make_shared<EyeLook>();
    wetFoundEyes(*head, skin, face);
    EXPECT_EQ(head->parts.size(), parts) << "a dressed head stays as it is";
}

TEST(HeadLook, strandsAreWidenedAboutTheirMiddle) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head);
    const Mesh before = head->find("lashesLeft")->mesh;
    ASSERT_TRUE(dressHead(*head, kHead));
    const ModelPart& after = *head->find("lashesLeft");
    ASSERT_GT(after.material.strand, 0.0F);
    for (size_t i = 0; i + 1 < before.positions.size(); i += 2) {
        const vec3 was = before.positions[i + 1] - before.positions[i], is = after.mesh.positions[i + 1] - after.mesh.positions[i];
        EXPECT_LT(glm::length(is * after.material.strand - was), 1e-6F);
        EXPECT_LT(glm::distance(after.mesh.positions[i] + after.mesh.positions[i + 1], before.positions[i] + before.positions[i + 1]),
                  1e-6F);
    }
}

TEST(HeadLook, aMeshThatIsNoHeadIsLeftAsItIs) {
    Result<Model> spot = importModel(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/spot.obj");
    ASSERT_TRUE(spot);
    ASSERT_TRUE(dressHead(*spot, kHead));
    ASSERT_EQ(spot->parts.size(), 1U);
    EXPECT_FALSE(spot->parts[0].material.skin);
    Mesh flat;
    flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    EXPECT_EQ(eyeLookOf(flat).radius, EyeLook{}.radius);
}

}  // namespace
}  // namespace rivulet::head_look_test
