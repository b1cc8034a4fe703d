// Eyes, lids and tear points that are found in meshes without marks, against the values of head.json and of MediaPipe's face.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "engine/scene/import_model.h"
#include "fluid/scene/find_face.h"
#include "fluid/scene/skin_model.h"

namespace rivulet::find_face_test {
namespace {

const std::string kMeshes = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/";

SkinModel head() {
    FlowParams params;
    params.mesh = kMeshes + "head/head.glb";
    Result<SkinModel> model = loadSkinModel(params, "");
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? std::move(*model) : SkinModel{};
}

// Distance of a point from a line of points.
float off(const vec3& p, const std::vector<vec3>& line) {
    float least = 1.0e30F;
    for (size_t k = 0; k + 1 < line.size(); ++k) {
        const vec3 e = line[k + 1] - line[k];
        const float length = glm::dot(e, e), share = length > 0 ? std::clamp(glm::dot(p - line[k], e) / length, 0.0F, 1.0F) : 0.0F;
        least = std::min(least, glm::distance(p, line[k] + share * e));
    }
    return least;
}

// `turn`, `scale`: of the parts, from head.json's frame.
void expectMarksOfHead(const FoundFace& face, const mat3& turn, float scale, float tear, float lid) {
    ASSERT_TRUE(face.found()) << face.missing;
    EXPECT_EQ(face.missing, "");
    const Result<FaceMarks> marks = readFaceMarks(kMeshes + "head/head.json");
    ASSERT_TRUE(marks);
    for (size_t side = 0; side < 2; ++side) {
        const EyeMarks& given = marks->eyes[side];
        std::vector<vec3> found;
        for (const vec3& p : face.eyes[side].lowerLid) found.push_back(glm::transpose(turn) * p / scale);
        ASSERT_EQ(found.size(), 25U);
        EXPECT_LT(glm::distance(glm::transpose(turn) * face.eyes[side].tear / scale, *given.tear), tear) << side;
        for (const vec3& p : found) EXPECT_LT(off(p, given.lowerLid), lid) << side << ": " << p.x << " " << p.y << " " << p.z;
        // From corner to corner: no mark of the file lies far from what was found.
        for (const vec3& p : given.lowerLid) EXPECT_LT(off(p, found), 2.5e-3F) << side << ": " << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_NEAR(face.eyeDistance() / scale, 0.063F, 2.0e-3F);
    EXPECT_GT(glm::dot(face.up, turn * vec3(0, 1, 0)), 0.95F);
    EXPECT_GT(glm::dot(face.forward, turn * vec3(0, 0, 1)), 0.95F);
    ASSERT_TRUE(face.nose && face.chin);
    EXPECT_LT(glm::distance(glm::transpose(turn) * *face.nose / scale, vec3(0, -0.0053F, 0.0750F)), 4.0e-3F);
    EXPECT_NEAR((glm::transpose(turn) * *face.chin / scale).y, -0.0945F, 6.0e-3F);
}

TEST(FindFace, EyeballsGiveTheMarksOfHeadJson) {
    const SkinModel model = head();
    const FoundFace face = findFace(model.model.parts, model.skin);
    EXPECT_EQ(face.by, FoundFace::By::balls);
    EXPECT_EQ(face.balls, (std::vector<std::string>{"eyeLeft (eye)", "eyeRight (eye)"}));
    for (size_t side = 0; side < 2; ++side) {
        EXPECT_NEAR(face.eyes[side].radius, 0.012F, 1.0e-4F);
        EXPECT_LT(glm::distance(face.eyes[side].centre, vec3(side == 0 ? 0.0317F : -0.0317F, 0.0268F, 0.0260F)), 1.0e-4F);
    }
    expectMarksOfHead(face, mat3(1.0F), 1, 1.0e-3F, 1.5e-3F);
}

TEST(FindFace, WithoutEyeballsTheHolesOfTheSkinGiveThem) {
    SkinModel model = head();
    const std::vector<ModelPart> skin = {model.model.parts[model.skin]};
    const FoundFace face = findFace(skin, 0);
    EXPECT_EQ(face.by, FoundFace::By::holes);
    expectMarksOfHead(face, mat3(1.0F), 1, 1.5e-3F, 2.5e-3F);
}

// Skin and eyeballs in one part, as exporters of sculptures leave them.
TEST(FindFace, EyeballsMayBePiecesOfTheSkin) {
    const SkinModel model = head();
    ModelPart one = model.model.parts[model.skin];
    for (const ModelPart& part : model.model.parts) {
        if (part.materialName != "eye") continue;
        const auto first = static_cast<uint32_t>(one.mesh.positions.size());
        one.mesh.positions.insert(one.mesh.positions.end(), part.mesh.positions.begin(), part.mesh.positions.end());
        for (const uint32_t i : part.mesh.indices) one.mesh.indices.push_back(first + i);
    }
    const FoundFace face = findFace(std::span(&one, 1), 0);
    EXPECT_EQ(face.by, FoundFace::By::balls);
    expectMarksOfHead(face, mat3(1.0F), 1, 1.0e-3F, 1.5e-3F);
}

// In centimetres, with +Z up; and in millimetres, turned about no axis of the frame.
TEST(FindFace, UnitAndOrientationDoNotMatter) {
    const mat3 zUp(vec3(1, 0, 0), vec3(0, 0, 1), vec3(0, -1, 0));
    const mat3 askew = glm::mat3_cast(glm::angleAxis(0.9F, glm::normalize(vec3(1, 2, 0.5F))));
    for (const auto& [turn, scale, tear, lid] : {std::tuple(zUp, 100.0F, 1.0e-3F, 1.5e-3F), std::tuple(askew, 1000.0F, 4.0e-3F, 3.0e-3F)}) {
        SkinModel model = head();
        for (ModelPart& part : model.model.parts)
            for (vec3& p : part.mesh.positions) p = turn * (scale * p);
        expectMarksOfHead(findFace(model.model.parts, model.skin), turn, scale, tear, lid);
    }
}

// MediaPipe's face has neither eyeballs nor openings. Its vertices 133, 33, 362 and 263 are the corners of its eyes, 145 and 374 the
// middles of the lower lids.
TEST(FindFace, AFaceWithoutOpeningsIsEstimatedFromItsNose) {
    FlowParams params;
    params.mesh = kMeshes + "canonical_face_model.obj";
    const Result<SkinModel> model = loadSkinModel(params, "");
    ASSERT_TRUE(model);
    const FoundFace face = findFace(model->model.parts, 0);
    ASSERT_EQ(face.by, FoundFace::By::proportions);
    EXPECT_NE(face.missing.find("no openings"), std::string::npos) << face.missing;
    EXPECT_EQ(face.up, vec3(0, 1, 0));
    EXPECT_EQ(face.forward, vec3(0, 0, 1));
    for (size_t side = 0; side < 2; ++side) {
        const vec3 mirror(side == 0 ? 1 : -1, 1, 1);
        const FoundEye& eye = face.eyes[side];
        EXPECT_LT(glm::distance(eye.inner, mirror * vec3(1.856432F, 2.585245F, 3.757904F)), 0.3F);
        EXPECT_LT(glm::distance(eye.outer, mirror * vec3(4.445859F, 2.663991F, 3.173422F)), 0.3F);
        EXPECT_LT(off(mirror * vec3(3.177186F, 2.294265F, 3.775704F), eye.lowerLid), 0.15F);
        // On the skin.
        const Result<FlowMesh> flow = makeFlowMesh(model->model.parts[0].mesh.view());
        ASSERT_TRUE(flow);
        for (const vec3& p : eye.lowerLid) EXPECT_LT(glm::distance(p, positionOf(*flow, nearestPoint(*flow, p))), 0.1F);
    }
    ASSERT_TRUE(face.nose && face.chin);
    EXPECT_LT(glm::distance(*face.nose, vec3(0, -0.46317F, 7.58658F)), 0.15F);
    EXPECT_LT(glm::distance(*face.chin, vec3(0, -9.403378F, 4.264492F)), 0.3F);
}

TEST(FindFace, WhatIsNoFaceHasNoEyes) {
    for (const char* name : {"sphere", "spot", "duck", "tumbler", "hourglass", "rocks", "paddle_wheel", "duck_eyes", "basin"}) {
        FlowParams params;
        params.mesh = kMeshes + name + ".obj";
        const Result<SkinModel> model = loadSkinModel(params, "", SkinPart::likely);
        ASSERT_TRUE(model) << model.error().message;
        const FoundFace face = findFace(model->model.parts, model->skin);
        EXPECT_FALSE(face.found()) << name;
        EXPECT_NE(face.missing.find("No eyes were found"), std::string::npos) << name << ": " << face.missing;
    }
}

TEST(FindFace, MarksThatAreWrittenAreReadAgain) {
    FaceMarks marks;
    marks.up = vec3(0, 0, 1);
    marks.forward = vec3(0, -1, 0);
    marks.eyes[0].tear = vec3(1.25F, -2.5F, 3.0e-4F);
    marks.eyes[0].lowerLid = {vec3(1, 2, 3), vec3(4, 5, 6), vec3(7, 8, 9)};
    const std::string path = ::testing::TempDir() + "find_face_marks.json";
    FILE* file = std::fopen(path.c_str(), "w");
    ASSERT_NE(file, nullptr);
    const std::string text = faceMarksText(marks);
    ASSERT_EQ(std::fwrite(text.data(), 1, text.size(), file), text.size());
    ASSERT_EQ(std::fclose(file), 0);
    const Result<FaceMarks> again = readFaceMarks(path);
    (void)std::remove(path.c_str());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->up, marks.up);
    EXPECT_EQ(again->forward, marks.forward);
    EXPECT_EQ(again->eyes[0].tear, marks.eyes[0].tear);
    EXPECT_EQ(again->eyes[0].lowerLid, marks.eyes[0].lowerLid);
    EXPECT_FALSE(again->eyes[1].tear);
}

TEST(FindFace, TheRotationThatIsProposedMakesAFaceUpright) {
    for (const vec3& turn : {vec3(-90, 0, 0), vec3(0, 0, 90), vec3(0, 90, 0), vec3(37, -90, 0), vec3(20, 130, -70)}) {
        FlowParams params;
        params.mesh = kMeshes + "head/head.glb";
        params.rotation = turn;
        Result<SkinModel> lying = loadSkinModel(params, "");
        ASSERT_TRUE(lying);
        const FoundFace face = findFace(lying->model.parts, lying->skin);
        ASSERT_TRUE(face.found()) << face.missing;
        params.rotation = uprightRotation(params, face.up, face.forward);
        Result<SkinModel> upright = loadSkinModel(params, "");
        ASSERT_TRUE(upright);
        const FoundFace again = findFace(upright->model.parts, upright->skin);
        EXPECT_GT(again.up.y, 0.98F) << turn.x << " " << turn.y << " " << turn.z;
        EXPECT_GT(again.forward.z, 0.98F) << turn.x << " " << turn.y << " " << turn.z;
    }
}

}  // namespace
}  // namespace rivulet::find_face_test
