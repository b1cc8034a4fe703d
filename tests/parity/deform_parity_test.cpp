// Morphs and bones on every device: against formulas on the cpu, and the others against the cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>

#include "engine/scene/skin.h"
#include "tests/parity/devices.h"

namespace rivulet::deform_parity_test {
namespace {

// A ball of radius 1 whose seam has two vertices per position, as UV charts need; the morph makes it an ellipsoid, two bones bend it.
constexpr vec3 kAxes(1.6F, 0.7F, 1.1F);
ModelPart ball(uint32_t rows = 48) {
    ModelPart part;
    part.name = "ball";
    const uint32_t columns = 2 * rows;
    for (uint32_t k = 0; k <= rows; ++k)
        for (uint32_t i = 0; i <= columns; ++i) {
            const double t = 3.14159265358979 * k / rows, f = 2 * 3.14159265358979 * (i % columns) / columns;
            const double sine = k == 0 || k == rows ? 0 : std::sin(t);
            part.mesh.positions.emplace_back(sine * std::cos(f), std::cos(t), -sine * std::sin(f));
        }
    for (uint32_t k = 0; k < rows; ++k)
        for (uint32_t i = 0; i < columns; ++i) {
            const uint32_t a = k * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
            if (k + 1 < rows) part.mesh.indices.insert(part.mesh.indices.end(), {a, c, d});
            if (k > 0) part.mesh.indices.insert(part.mesh.indices.end(), {a, d, b});
        }
    MorphTarget wide{"wide", {}, {}}, taller{"taller", {}, {}};
    part.bones = {{0, mat4(1.0F)}, {0, mat4(1.0F)}};
    for (uint32_t i = 0; i < part.mesh.positions.size(); ++i) {
        const vec3 p = part.mesh.positions[i];
        wide.vertices.push_back(i);
        wide.offsets.push_back(p * (kAxes - 1.0F));
        if (p.y > 0.5F) taller.vertices.push_back(i), taller.offsets.emplace_back(0.0F, 0.3F, 0.0F);
        const float upper = std::clamp(0.5F + p.y, 0.0F, 1.0F);
        part.grips.push_back({{0, 1, 0, 0}, {1.0F - upper, upper, 0, 0}});
    }
    part.morphs = {wide, taller};
    return part;
}

struct Deformed {
    std::vector<vec4> position, normal;
};
Deformed run(Device& device, const ModelPart& part, std::vector<float> weights, std::vector<mat4> bones = {}) {
    Result<Deformer> made = Deformer::create(device, part);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    if (!made) return {};
    made->run(weights, bones);
    return {device.readAll<vec4>(made->positions(), made->vertices()), device.readAll<vec4>(made->normals(), made->vertices())};
}

TEST(Deform, normalsOfAnEllipsoidEqualTheFormula) {
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    const Deformed d = run(*cpu, part, {1.0F});
    float worst = 0;
    for (size_t i = 0; i < d.position.size(); ++i) {
        const vec3 p(d.position[i]), expected = glm::normalize(p / (kAxes * kAxes));
        ASSERT_LT(glm::length(p - part.mesh.positions[i] * kAxes), 1e-6F);
        worst = std::max(worst, std::acos(std::min(glm::dot(expected, vec3(d.normal[i])), 1.0F)));
    }
    EXPECT_LT(worst * 180.0F / kPi, 1.0F);
}

TEST(Deform, curvatureOfABallIsOneOverItsRadius) {
    auto cpu = makeTestCpu();
    ModelPart part = ball();
    for (vec3& p : part.mesh.positions) p *= 0.25F;
    const Deformed d = run(*cpu, part, {});
    size_t within = 0;
    for (const vec4& n : d.normal) {
        EXPECT_NEAR(n.w, 4.0F, 0.5F);  // near the poles triangles are uneven
        if (std::abs(n.w - 4.0F) < 0.02F) ++within;
    }
    EXPECT_GT(within, d.normal.size() * 9 / 10);
}

TEST(Deform, weightsOfZeroGiveTheRestBitForBitAndAMissingOneIsZero) {
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    for (const std::vector<float>& weights : {std::vector<float>{}, {0.0F}, {0.0F, 0.0F}, {NAN, 0.0F}}) {
        const Deformed d = run(*cpu, part, weights);
        for (size_t i = 0; i < d.position.size(); ++i) ASSERT_EQ(vec3(d.position[i]), part.mesh.positions[i]);
    }
}

TEST(Deform, aSeamHasOneNormal) {
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    const Deformed d = run(*cpu, part, {0.7F, 0.4F});
    for (uint32_t k = 0; k <= 48; ++k) EXPECT_EQ(d.normal[k * 97], d.normal[k * 97 + 96]) << "row " << k;
}

TEST(Deform, bonesRotateTheirVertices) {
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    const mat4 turn = glm::rotate(glm::translate(mat4(1.0F), vec3(0.1F, 0.2F, -0.3F)), 0.5F, glm::normalize(vec3(1, 2, 3)));
    const Deformed d = run(*cpu, part, {}, {mat4(1.0F), turn});
    for (size_t i = 0; i < d.position.size(); ++i) {
        const vec3 p = part.mesh.positions[i], there = vec3(turn * vec4(p, 1.0F));
        const float upper = std::clamp(0.5F + p.y, 0.0F, 1.0F);
        ASSERT_LT(glm::length(vec3(d.position[i]) - glm::mix(p, there, upper)), 1e-6F);
    }
}

TEST(Deform, boundsContainTheDeformedMesh) {
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    Result<Deformer> made = Deformer::create(*cpu, part);
    ASSERT_TRUE(made);
    const mat4 turn = glm::rotate(mat4(1.0F), 0.8F, glm::normalize(vec3(1, 0, 1)));
    made->run(std::vector<float>{0.9F, -0.5F}, std::vector<mat4>{mat4(1.0F), turn});
    for (const vec4& p : cpu->readAll<vec4>(made->positions(), made->vertices()))
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(p[k], made->bounds().min[k]);
            EXPECT_LE(p[k], made->bounds().max[k]);
        }
}

TEST(Deform, missingMorphsAndBonesAreRefusedWithAMessage) {
    auto cpu = makeTestCpu();
    ModelPart part = ball(8);
    part.morphs[0].vertices.back() = 100000;
    Result<Deformer> made = Deformer::create(*cpu, part);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().message, "the part 'ball' has a morph 'wide' whose vertices are out of range");
    part = ball(8);
    part.grips[3].bone.z = 2;
    EXPECT_FALSE(Deformer::create(*cpu, part));
    part = ball(8);
    part.mesh.indices[5] = 100000;
    EXPECT_FALSE(Deformer::create(*cpu, part));
}

class DeformParity : public testing::TestWithParam<const char*> {};

TEST_P(DeformParity, TheSameSkin) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const ModelPart part = ball();
    const std::vector<mat4> bones = {mat4(1.0F), glm::rotate(mat4(1.0F), 0.5F, vec3(0, 0, 1))};
    const Deformed here = run(*cpu, part, {0.6F, 0.8F}, bones), there = run(*gpu->device, part, {0.6F, 0.8F}, bones);
    ASSERT_EQ(here.position.size(), there.position.size());
    for (size_t i = 0; i < here.position.size(); ++i) {
        EXPECT_LT(glm::length(vec3(here.position[i]) - vec3(there.position[i])), 1e-6F);
        EXPECT_LT(glm::length(vec3(here.normal[i]) - vec3(there.normal[i])), 1e-4F);
        EXPECT_NEAR(here.normal[i].w, there.normal[i].w, 2e-3F);
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, DeformParity, testing::Values("gl", "cl"), [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace rivulet::deform_parity_test
