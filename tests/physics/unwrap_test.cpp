// UVs of a skin are checked, and new ones are made: charts that do not touch, cover the whole skin and preserve angles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "engine/scene/import_model.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/unwrap.h"
#include "fluid/flow/uv_triangle.h"
#include "tests/physics/charted_skins.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::unwrap_test {
namespace {

using test::Skin;

// Rows of `around` points each, joined; `at` gives a point from the row's share and an angle.
template <class F>
Skin turned(uint32_t rows, uint32_t around, bool closed, F&& at) {
    Skin s;
    for (uint32_t k = 0; k <= rows; ++k)
        for (uint32_t i = 0; i < around; ++i)
            s.positions.push_back(vec3(at(static_cast<double>(closed ? k % rows : k) / rows, 2 * kPiD * i / around)));
    for (uint32_t k = 0; k < rows; ++k)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = k * around + i, b = k * around + (i + 1) % around, c = a + around, d = b + around;
            s.indices.insert(s.indices.end(), {a, c, d, a, d, b});
        }
    return s;
}

Skin cylinder() {
    return turned(20, 48, false, [](double r, double a) { return dvec3(0.03 * std::cos(a), 0.12 * r, 0.03 * std::sin(a)); });
}
Skin cone() {
    return turned(20, 48, false, [](double r, double a) { return (1.02 - r) * dvec3(0.05 * std::cos(a), -0.1, 0.05 * std::sin(a)); });
}
Skin torus() {
    return turned(60, 30, true, [](double r, double a) {
        const double out = 0.05 + 0.02 * std::cos(a);
        return dvec3(out * std::cos(2 * kPiD * r), 0.02 * std::sin(a), out * std::sin(2 * kPiD * r));
    });
}

void expectGood(const std::string& name, const FlowMesh& mesh, double mostDistortion, uint32_t mostCharts = UINT32_MAX) {
    const int size = 1024, gutter = 3;
    const Result<Unwrap> made = unwrap(mesh, size, gutter);
    ASSERT_TRUE(made) << name << ": " << made.error().message;
    const UvReport report = checkUvs(mesh, made->uvs, size);
    EXPECT_EQ(report.overlap, 0) << name;
    EXPECT_EQ(report.mirrored, 0U) << name;
    EXPECT_EQ(report.beyond, 0U) << name;
    EXPECT_LT(report.lost, 0.01) << name << ": " << report.sentence();
    EXPECT_GE(made->distortion, 1 - 1e-9) << name;
    EXPECT_LT(made->distortion, mostDistortion) << name;
    EXPECT_LE(made->charts, mostCharts) << name;
    // The distance between charts is larger than both gutters.
    std::vector<uint32_t> owner(static_cast<size_t>(size) * size, UINT32_MAX);
    double inUv = 0, onSkin = 0;
    for (size_t t = 0; t < mesh.triangleCount(); ++t) {
        const UvTriangle f = uvTriangle(std::span(made->uvs).subspan(3 * t, 3), size);
        if (!f.good()) continue;
        inUv += f.area;
        const vec3 a = mesh.rest[mesh.corner[3 * t]];
        onSkin += double{glm::length(glm::cross(mesh.rest[mesh.corner[3 * t + 1]] - a, mesh.rest[mesh.corner[3 * t + 2]] - a))};
        eachCentre(f, 0, [&](int x, int y) { owner[static_cast<size_t>(y) * size + static_cast<size_t>(x)] = made->chart[t]; });
    }
    size_t near = 0;
    for (int y = gutter; y < size - gutter; ++y)
        for (int x = gutter; x < size - gutter; ++x) {
            const uint32_t own = owner[static_cast<size_t>(y) * size + static_cast<size_t>(x)];
            if (own == UINT32_MAX) continue;
            for (int k = -gutter; k <= gutter; ++k)
                for (int i = -gutter; i <= gutter; ++i) {
                    const uint32_t other = owner[static_cast<size_t>(y + k) * size + static_cast<size_t>(x + i)];
                    near += other != UINT32_MAX && other != own ? 1 : 0;
                }
        }
    EXPECT_EQ(near, 0U) << name;
    EXPECT_NEAR(inUv / onSkin / (made->texelsPerMetre * made->texelsPerMetre), 1, 0.02) << name << ": scaled to the skin's metres";
}

TEST(Unwrap, ShapesAreUnwrapped) {
    const std::pair<const char*, Skin> shapes[] = {
        {"cylinder", cylinder()}, {"cone", cone()}, {"ball", test::cubeBall(0.04F, 20)}, {"torus", torus()}};
    for (const auto& [name, skin] : shapes) {
        const Result<FlowMesh> mesh = makeFlowMesh(skin.view());
        ASSERT_TRUE(mesh);
        // Developable shapes have no distortion.
        expectGood(name, *mesh, name[0] == 'c' ? 1.0001 : 1.01, 16);
    }
}

TEST(Unwrap, EveryTestMeshIsUnwrapped) {
    std::vector<std::string> paths;
    for (const std::filesystem::path& path : test::testMeshes()) paths.push_back(path.string());
    for (const char* own : {"duck", "hourglass", "thin_cup", "shell", "sheet", "canonical_face_model"})
        paths.push_back(std::string(RIVULET_SOURCE_DIR "/assets/meshes/") + own + ".obj");
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
        const Result<Mesh> file = importMesh(path);
        ASSERT_TRUE(file) << path;
        const Result<FlowMesh> mesh = makeFlowMesh(file->view());
        ASSERT_TRUE(mesh) << path;
        expectGood(std::filesystem::path(path).filename().string(), *mesh, 1.01);
    }
}

// Defects of UVs are found and counted; valid UVs are not reported.
TEST(Unwrap, BadUvsAreFoundAndReplaced) {
    const Skin good = test::cubeBall(0.04F, 10);
    const auto judged = [&](const Skin& skin) {
        const Result<FlowMesh> mesh = makeFlowMesh(skin.view());
        EXPECT_TRUE(mesh);
        Result<SkinUvs> uvs = skinUvs(*mesh, skin.view(), 512);
        EXPECT_TRUE(uvs);
        EXPECT_EQ(uvs->unwrapped, uvs->notice.find("New UVs were made") != std::string::npos);
        EXPECT_TRUE(checkUvs(*mesh, uvs->uvs, 512).usable());
        return *uvs;
    };
    EXPECT_FALSE(judged(good).unwrapped);
    EXPECT_EQ(judged(good).notice, "");

    Skin mirrored = good;
    for (vec2& uv : mirrored.uvs) uv.x = 1 - uv.x;
    const SkinUvs turnedRound = judged(mirrored);
    EXPECT_FALSE(turnedRound.unwrapped);
    EXPECT_EQ(turnedRound.given.mirrored, 1200U);

    Skin beyond = good;
    for (vec2& uv : beyond.uvs) uv += vec2(3.4F, -7.7F);
    const SkinUvs wrapped = judged(beyond);
    EXPECT_FALSE(wrapped.unwrapped);
    EXPECT_EQ(wrapped.given.beyond, 1200U);
    EXPECT_EQ(wrapped.given.overlap, 0);

    Skin pinched = test::shattered(good);
    for (size_t t = 0; t < 1200; t += 20)
        for (size_t k = 1; k < 3; ++k) pinched.uvs[3 * t + k] = pinched.uvs[3 * t];
    const SkinUvs noArea = judged(pinched);
    EXPECT_EQ(noArea.given.noArea, 60U);
    EXPECT_GT(noArea.given.lost, 0.02);
    EXPECT_LT(noArea.given.lost, 0.08);
    EXPECT_TRUE(noArea.unwrapped);

    Skin folded = good;
    for (vec2& uv : folded.uvs) uv.x = std::abs(uv.x - 0.505F);  // one half of the map overlaps the other
    const SkinUvs overlapping = judged(folded);
    EXPECT_GT(overlapping.given.overlap, 0.3);
    EXPECT_TRUE(overlapping.unwrapped);
    EXPECT_NE(overlapping.notice.find("% of overlap"), std::string::npos) << overlapping.notice;

    Skin none = good;
    none.uvs.clear();
    EXPECT_TRUE(judged(none).unwrapped);
    EXPECT_TRUE(judged(none).given.missing);

    Skin nan = good;
    nan.uvs[7].x = std::numeric_limits<float>::quiet_NaN();
    nan.uvs[500].y = std::numeric_limits<float>::infinity();
    EXPECT_GT(judged(nan).given.notNumbers, 5U);

    // On a map of sixteen texels there is no room.
    const Result<FlowMesh> mesh = makeFlowMesh(good.view());
    ASSERT_TRUE(mesh);
    const Result<Unwrap> small = unwrap(*mesh, 16);
    ASSERT_FALSE(small);
    EXPECT_NE(small.error().message.find("no room"), std::string::npos) << small.error().message;
}

}  // namespace
}  // namespace rivulet::unwrap_test
