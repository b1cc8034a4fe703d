// The counts and corrections of cleanMesh, compared with expected.json of tests/meshes, and on meshes with defects made here.
#include <gtest/gtest.h>
#include <json/json.h>

#include <algorithm>
#include <map>

#include "fluid/voxel/mesh_defects.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_defects_test {
namespace {

using test::cleaned;
using test::Mesh;

double signedVolume(const CleanMesh& mesh) {
    double six = 0;
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        const dvec3 a(mesh.positions[mesh.indices[t]]), b(mesh.positions[mesh.indices[t + 1]]), c(mesh.positions[mesh.indices[t + 2]]);
        six += glm::dot(a, glm::cross(b, c));
    }
    return six / 6.0;
}

TEST(VoxelDefects, ACleanMeshHasNone) {
    const CleanMesh mesh = cleaned(test::makeBox(vec3(-1), vec3(1)));
    EXPECT_EQ(mesh.positions.size(), 8U) << "36 corners at 8 places";
    EXPECT_EQ(mesh.source.size(), 12U);
    EXPECT_TRUE(mesh.unmatched.empty());
    EXPECT_TRUE(mesh.defects.watertight);
    EXPECT_EQ(mesh.defects.components, 1U);
    EXPECT_EQ(mesh.defects.badEdges(), 0U);
    EXPECT_EQ(mesh.defects.sentence(), "");
    EXPECT_DOUBLE_EQ(signedVolume(mesh), 8.0);
}

TEST(VoxelDefects, HolesAreCountedAndNamed) {
    Mesh box = test::makeBox(vec3(-1), vec3(1));
    box.indices.resize(box.indices.size() - 6);  // a side
    const CleanMesh mesh = cleaned(box);
    EXPECT_EQ(mesh.defects.boundaryEdges, 4U);
    EXPECT_FALSE(mesh.defects.watertight);
    EXPECT_EQ(mesh.unmatched.size(), 8U);
    EXPECT_EQ(mesh.defects.sentence(), "The mesh has 4 boundary edges (holes): inside is decided by winding number.");
}

TEST(VoxelDefects, ReversedFacesAreCorrected) {
    Mesh ball = test::makeSphere(vec3(0), 1.0F, 12);
    const double volume = signedVolume(cleaned(ball));
    std::mt19937 random(3);
    size_t turned = 0;
    for (size_t t = 0; t < ball.indices.size(); t += 3) {
        if (random() % 4 != 0) continue;
        std::swap(ball.indices[t + 1], ball.indices[t + 2]);
        ++turned;
    }
    const CleanMesh mesh = cleaned(ball);
    EXPECT_EQ(mesh.defects.flippedFaces, turned - mesh.defects.degenerateFaces);
    EXPECT_TRUE(mesh.defects.watertight);
    EXPECT_DOUBLE_EQ(signedVolume(mesh), volume);
    EXPECT_NE(mesh.defects.sentence().find("facing the wrong way"), std::string::npos) << mesh.defects.sentence();
}

TEST(VoxelDefects, ACavityKeepsItsOrientation) {
    Mesh shell = test::makeBox(vec3(-1), vec3(1));
    Mesh hole = test::makeBox(vec3(-0.5F), vec3(0.5F));
    for (size_t t = 0; t < hole.indices.size(); t += 3) std::swap(hole.indices[t + 1], hole.indices[t + 2]);
    std::swap(hole.indices[1], hole.indices[2]);  // except one face
    const MeshView views[] = {shell.view(), hole.view()};
    const CleanMesh mesh = cleanMesh(views);
    EXPECT_EQ(mesh.defects.flippedFaces, 1U);
    EXPECT_EQ(mesh.defects.components, 2U);
    EXPECT_DOUBLE_EQ(signedVolume(mesh), 8.0 - 1.0);
    EXPECT_EQ(mesh.source.back(), 23U);
    EXPECT_EQ(mesh.component.back(), 1U);
}

TEST(VoxelDefects, RepeatedAndDegenerateFacesAreRemoved) {
    Mesh box = test::makeBox(vec3(-1), vec3(1));
    const std::vector<uint32_t> first(box.indices.begin(), box.indices.begin() + 3);
    box.indices.insert(box.indices.end(), {first[1], first[2], first[0]});  // again, from another corner
    box.indices.insert(box.indices.end(), {first[0], first[0], first[1]});
    const CleanMesh mesh = cleaned(box);
    EXPECT_EQ(mesh.defects.triangles, 14U);
    EXPECT_EQ(mesh.defects.duplicateFaces, 1U);
    EXPECT_EQ(mesh.defects.degenerateFaces, 1U);
    EXPECT_EQ(mesh.source.size(), 12U);
    EXPECT_TRUE(mesh.defects.watertight);
    // A face and its reverse both stay: they close a body of no volume.
    Mesh leaf;
    leaf.triangle(vec3(0), vec3(1, 0, 0), vec3(0, 1, 0));
    leaf.triangle(vec3(0), vec3(0, 1, 0), vec3(1, 0, 0));
    EXPECT_EQ(cleaned(leaf).source.size(), 2U);
    EXPECT_TRUE(cleaned(leaf).defects.watertight);
}

TEST(VoxelDefects, AMoebiusStripIsLeftAsGiven) {
    Mesh strip;
    const auto rim = [](int k, float side) {
        const float round = 2 * kPi * static_cast<float>(k % 20) / 20.0F, tilt = round / 2;
        const float turn = k >= 20 ? -side : side;  // the end meets the start upside down
        return vec3((1 + 0.3F * turn * std::cos(tilt)) * std::cos(round), (1 + 0.3F * turn * std::cos(tilt)) * std::sin(round),
                    0.3F * turn * std::sin(tilt));
    };
    for (int k = 0; k < 20; ++k) strip.quad(rim(k, -1), rim(k, 1), rim(k + 1, 1), rim(k + 1, -1));
    const CleanMesh mesh = cleaned(strip);
    EXPECT_EQ(mesh.defects.unorientable, 1U);
    EXPECT_EQ(mesh.defects.flippedFaces, 0U);
    EXPECT_EQ(mesh.defects.boundaryEdges, 40U);
    // The seam's faces run the same way along it: twice unmatched.
    EXPECT_EQ(mesh.unmatched.size() / 2, 40U + 2U);
    EXPECT_NE(mesh.defects.sentence().find("Moebius"), std::string::npos);
}

TEST(VoxelDefects, UnmatchedEdgesFormLoops) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const CleanMesh mesh = cleaned(test::makeJumble(seed, 200));
        std::vector<int> ends(mesh.positions.size(), 0);
        for (size_t k = 0; k < mesh.unmatched.size(); k += 2) {
            ++ends[mesh.unmatched[k]];
            --ends[mesh.unmatched[k + 1]];
        }
        EXPECT_FALSE(mesh.unmatched.empty());
        EXPECT_EQ(std::count(ends.begin(), ends.end(), 0), static_cast<long>(ends.size()));
    }
}

// expected.json counts edges and components before anything is cleaned, by indices, and components share a vertex. Here equal places
// are merged, duplicate and degenerate faces are removed, and the faces of a component share edges of two faces. The differences:
const std::map<std::string, std::array<size_t, 3>>& differences() {
    static const std::map<std::string, std::array<size_t, 3>> rows{
        // {boundary edges, edges of three and more faces, components}
        {"sphere_degenerate", {0, 0, 1}},             // its bad edges belong to the removed faces
        {"nonmanifold_edge_two_cubes", {0, 1, 2}},    // two cubes share no edge of two faces
        {"nonmanifold_vertex_two_cubes", {0, 0, 2}},  // the same
        {"sphere_holes", {736, 0, 6}},                // five islands are connected by a vertex only
        {"coplanar_boxes", {0, 8, 9}},                // corners and edges of the boxes coincide; patches between edges of four faces
    };
    return rows;
}

TEST(VoxelDefects, TestMeshesAsExpected) {
    std::ifstream file(test::testMesh("generated/expected.json"));
    ASSERT_TRUE(file);
    Json::Value expected;
    file >> expected;
    size_t seen = 0;
    for (const std::string& name : expected.getMemberNames()) {
        const CleanMesh mesh = cleaned(test::readObj(test::testMesh("generated/" + name + ".obj")));
        const Json::Value& want = expected[name];
        std::array<size_t, 3> counts{want["boundary_edges"].asUInt(), want["nonmanifold_edges"].asUInt(), want["components"].asUInt()};
        if (const auto other = differences().find(name); other != differences().end()) counts = other->second;
        EXPECT_EQ(mesh.defects.triangles, want["tris"].asUInt()) << name;
        EXPECT_EQ(mesh.defects.boundaryEdges, counts[0]) << name;
        EXPECT_EQ(mesh.defects.nonManifoldEdges, counts[1]) << name;
        EXPECT_EQ(mesh.defects.components, counts[2]) << name;
        EXPECT_EQ(mesh.defects.unorientable, name == "mobius" ? 1U : 0U) << name;
        // A mesh that is closed by indices is closed here too, and consistent faces are not reversed.
        EXPECT_EQ(mesh.defects.flippedFaces, 0U) << name;
        if (mesh.defects.watertight && want["dup_directed"].asUInt() == 0) {
            EXPECT_NEAR(signedVolume(mesh), want["signed_volume"].asDouble(), 1e-5 * std::abs(want["signed_volume"].asDouble()) + 1e-6)
                << name;
        }
        ++seen;
    }
    EXPECT_GE(seen, 16U);
    Mesh torn = test::readObj(test::spotMesh());
    torn.indices.resize(torn.indices.size() - 3);
    EXPECT_EQ(cleaned(torn).defects.sentence(), "The mesh has 3 boundary edges (holes): inside is decided by winding number.");
}

}  // namespace
}  // namespace rivulet::voxel_defects_test
