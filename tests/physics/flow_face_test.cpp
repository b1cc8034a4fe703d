// Tears on faces: their path down a cheek, equal on the left and the right.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/import_model.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/scene/face_marks.h"
#include "fluid/scene/scene_file.h"
#include "tests/physics/skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::flow_face_test {
namespace {

struct Way {
    std::vector<vec2> uvs;
    std::vector<vec3> places;
};

// Path of the largest drop of a tear of `microlitres` that begins below the inner corner of an eye, for four seconds. 0: left eye, 1: right
// eye.
Way tearDown(const Mesh& skin, const vec3& from, double microlitres) {
    auto device = cpu();
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    EXPECT_TRUE(mesh);
    const std::vector<vec2> uvs = cornerUvs(*mesh, skin.view());
    Result<SurfaceFlow> flow = SurfaceFlow::create(*device, std::move(*mesh), {});
    EXPECT_TRUE(flow);
    flow->add(nearestPoint(flow->mesh(), from), static_cast<uint32_t>(1e6 * microlitres));
    Way way;
    for (int k = 0; k < 240; ++k) {
        EXPECT_TRUE(flow->step({}, 1.0 / 60));
        const std::vector<SkinDrop> drops = flow->drops();
        if (drops.empty()) break;
        const SkinPoint& at = drops[0].at;
        const vec2* uv = &uvs[3 * size_t{at.triangle}];
        way.uvs.push_back((1 - at.b1 - at.b2) * uv[0] + at.b1 * uv[1] + at.b2 * uv[2]);
        way.places.push_back(drops[0].position);
    }
    return way;
}

Mesh partOf(const Model& model, const std::string& name) {
    for (const ModelPart& part : model.parts)
        if (part.name == name || part.materialName == name)
            return transformed(part.mesh, model.worldMatrices()[static_cast<size_t>(part.node)]);
    ADD_FAILURE() << "no part " << name;
    return {};
}

// On the default head a tear runs beside the nose, past the corner of the mouth, to the jaw; left and right within 1 %.
TEST(FlowOnAFace, ATearRunsBesideTheNoseToTheJaw) {
    const Result<std::string> path = findAsset("meshes/head/head.glb", ""), json = findAsset("meshes/head/head.json", "");
    ASSERT_TRUE(path && json);
    const Result<Model> model = importModel(*path);
    const Result<FaceMarks> marks = readFaceMarks(*json);
    ASSERT_TRUE(model && marks);
    const Mesh skin = partOf(*model, "skin");
    const Way left = tearDown(skin, *marks->eyes[0].tear, 12), right = tearDown(skin, *marks->eyes[1].tear, 12);
    ASSERT_EQ(left.places.size(), right.places.size());
    double length = 0;
    for (size_t k = 1; k < left.places.size(); ++k) length += double{glm::distance(left.places[k], left.places[k - 1])};
    for (size_t k = 0; k < left.places.size(); ++k)
        EXPECT_LT(glm::distance(left.places[k], right.places[k] * vec3(-1, 1, 1)), 0.01 * length) << k;
    // Beside the nose, whose wings are 17 mm off the middle; then by the corner of the mouth, and onto the jaw.
    const vec3 end = left.places.back();
    for (const vec3& x : left.places) {
        if (x.y < 0 && x.y > -0.02F) EXPECT_TRUE(x.x > 0.017F && x.x < 0.035F) << x.x;
        if (x.y < -0.035F && x.y > -0.05F) EXPECT_TRUE(x.x > 0.018F && x.x < 0.035F) << x.x;
    }
    EXPECT_LT(end.y, -0.08F);
    EXPECT_GT(length, 0.11);
}

// On the ICT head (if RIVULET_ASSETS contains it) the tear passes seven points marked by hand, within 4 % of the UVs' width. It moves from
// the upper lip to the lower, because its cap spans the corner of the mouth.
TEST(FlowOnAFace, OnTheIctHeadATearFollowsTheMarkedPath) {
    const Result<std::string> path = findAsset("ict_head/ict_head_full.glb", ""), json = findAsset("ict_head/landmarks.json", "");
    if (!path || !json) GTEST_SKIP() << "the ICT head is not there: assets/fetch_ict_head.sh says where it comes from";
    const Result<Model> model = importModel(*path);
    const Result<FaceMarks> marks = readFaceMarks(*json);
    ASSERT_TRUE(model && marks);
    const Mesh face = partOf(*model, "M_Face");
    const Way right = tearDown(face, *marks->eyes[1].tear, 16), left = tearDown(face, *marks->eyes[0].tear, 16);
    for (const vec2& mark : {vec2(0.404F, 0.708F), vec2(0.399F, 0.643F), vec2(0.393F, 0.570F), vec2(0.397F, 0.506F), vec2(0.400F, 0.417F),
                             vec2(0.386F, 0.343F), vec2(0.457F, 0.235F)}) {
        float near = 1, mirrored = 1;
        for (const vec2& uv : right.uvs) near = std::min(near, glm::distance(uv, mark));
        for (const vec2& uv : left.uvs) mirrored = std::min(mirrored, glm::distance(vec2(1 - uv.x, uv.y), mark));
        EXPECT_LT(near, 0.04F) << mark.x << ", " << mark.y;
        EXPECT_NEAR(near, mirrored, 0.01F);
    }
}

// A drop under a ceiling moves to a floor that lies within its cap; if the floor is further away, the drop keeps hanging.
TEST(FlowOnAFace, AHangingDropMovesToSkinThatItTouches) {
    for (const float gap : {0.0008F, 0.004F}) {
        auto device = cpu();
        // The ceiling's normal points down, the floor's up.
        Shape both = sheetShape(vec3(0, gap, 0), vec3(0.04F, 0, 0), vec3(0, 0, 0.04F), 20, 20);
        const Shape floor = sheetShape(vec3(0, 0, 0.04F), vec3(0.04F, 0, 0), vec3(0, 0, -0.04F), 20, 20);
        const auto first = static_cast<uint32_t>(both.positions.size());
        both.positions.insert(both.positions.end(), floor.positions.begin(), floor.positions.end());
        both.uvs.clear();
        for (const uint32_t i : floor.indices) both.indices.push_back(first + i);
        SurfaceFlow flow = flowOn(*device, both);
        flow.add(nearestPoint(flow.mesh(), vec3(0.02F, gap, 0.02F)), 6000000);
        for (int k = 0; k < 5; ++k) EXPECT_TRUE(flow.step({}, 1.0 / 60));
        ASSERT_EQ(flow.drops().size(), 1U);
        EXPECT_NEAR(flow.drops()[0].position.y, gap < 0.001F ? 0 : gap, 1e-6F);
        EXPECT_NEAR(flow.drops()[0].position.x, 0.02F, 1.5e-3F);
    }
}

}  // namespace
}  // namespace rivulet::flow_face_test
