// Meshes of the iso-surface: closed, manifold, outward, of the right volume, and as assimp reads them back.
#include "fluid/io/marching_cubes.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>

#include "engine/core/file.h"
#include "engine/scene/import_model.h"
#include "fluid/io/mesh_file.h"
#include "tests/unit/mesh_volume.h"
#include "tests/unit/program_runner.h"

namespace rivulet::marching_cubes_test {
namespace {

constexpr float kSpacing = 0.02F;  // m

std::vector<vec4> ballOf(double radius, double jitter) {
    std::mt19937 bits(3);
    const auto off = [&] { return jitter * (bits() / 2147483648.0 - 1); };
    std::vector<vec4> all;
    const int reach = static_cast<int>(radius) + 2;
    for (int z = -reach; z < reach; ++z)
        for (int y = -reach; y < reach; ++y)
            for (int x = -reach; x < reach; ++x) {
                const dvec3 p = dvec3(x, y, z) + 0.5 + dvec3(off(), off(), off());
                if (glm::length(p) < radius) all.emplace_back(kSpacing * vec3(p), 1.0F);
            }
    return all;
}

// Foam: particles at random, some touching, so that all the cases of a cell come up.
std::vector<vec4> foam() {
    std::mt19937 bits(5);
    std::vector<vec4> all;
    for (int i = 0; i < 3000; ++i) {
        const auto x = [&] { return kSpacing * 20.0F * static_cast<float>(bits() / 4294967296.0); };
        const float a = x(), b = x(), c = x();
        all.emplace_back(a, b, c, 1.0F);
    }
    return all;
}

SurfaceMesh meshOf(std::span<const vec4> particles, int cells) {
    Result<IsoSurface> surface = IsoSurface::create(particles, kSpacing);
    EXPECT_TRUE(surface);
    Result<SurfaceMesh> mesh = marchingCubes(*surface, cells);
    EXPECT_TRUE(mesh);
    return std::move(*mesh);
}

// Each directed edge once, and its opposite too.
void expectClosedManifold(const MeshView& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> directed;
    for (size_t k = 0; k < mesh.indices.size(); k += 3)
        for (size_t e = 0; e < 3; ++e) ++directed[{mesh.indices[k + e], mesh.indices[k + (e + 1) % 3]}];
    size_t bad = 0;
    for (const auto& [edge, times] : directed) {
        const auto back = directed.find({edge.second, edge.first});
        bad += times == 1 && back != directed.end() && back->second == 1 ? 0 : 1;
    }
    EXPECT_EQ(bad, 0U) << "of " << directed.size() << " directed edges";
}

TEST(MarchingCubes, ABallOfParticlesKeepsItsVolume) {
    const std::vector<vec4> ball = ballOf(10, 0.1);
    const double volume = static_cast<double>(ball.size()) * std::pow(double{kSpacing}, 3);
    for (const int cells : {1, 2, 3}) {
        const SurfaceMesh mesh = meshOf(ball, cells);
        EXPECT_NEAR(volumeOf(mesh.view()) / volume, 1, 0.03) << cells;
        expectClosedManifold(mesh.view());
        const auto triangles = static_cast<double>(mesh.view().triangleCount()), vertices = static_cast<double>(mesh.positions.size());
        EXPECT_EQ(vertices - triangles / 2, 2) << "a ball has Euler's number 2";
    }
}

TEST(MarchingCubes, FoamIsClosedAndManifold) {
    for (const int cells : {1, 2}) {
        const SurfaceMesh mesh = meshOf(foam(), cells);
        EXPECT_GT(mesh.indices.size(), 30000U);
        expectClosedManifold(mesh.view());
    }
}

TEST(MarchingCubes, NormalsAndTrianglesPointOutward) {
    const SurfaceMesh mesh = meshOf(ballOf(10, 0.1), 2);
    double worst = 1;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        EXPECT_NEAR(glm::length(mesh.normals[i]), 1, 1e-5);
        worst = std::min(worst, double{glm::dot(mesh.normals[i], glm::normalize(mesh.positions[i]))});
    }
    EXPECT_GT(worst, 0.6);  // particles on a lattice make steps of a ball
    size_t inward = 0;
    for (size_t k = 0; k < mesh.indices.size(); k += 3) {
        const vec3 a = mesh.positions[mesh.indices[k]], b = mesh.positions[mesh.indices[k + 1]], c = mesh.positions[mesh.indices[k + 2]];
        const vec3 n = glm::cross(b - a, c - a);
        EXPECT_GT(glm::length(n), 0);
        if (glm::dot(n, mesh.normals[mesh.indices[k]]) < 0) ++inward;
    }
    EXPECT_EQ(inward, 0U);
}

// Both formats, by a reader that is not ours.
TEST(MarchingCubes, AssimpReadsTheMeshBack) {
    const testing::Scratch scratch;
    const SurfaceMesh mesh = meshOf(ballOf(5, 0.1), 2);
    for (const MeshFormat& format : meshFormats().rows) {
        const std::string path = scratch.file(std::string("ball.") + format.name);
        ASSERT_TRUE(writeFileAtomic(path, format.write(mesh.view(), {})));
        Result<Mesh> back = importMesh(path);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->view().triangleCount(), mesh.view().triangleCount());
        EXPECT_NEAR(volumeOf(back->view()), volumeOf(mesh.view()), 1e-6 * volumeOf(mesh.view()));
        ASSERT_EQ(back->normals.size(), back->positions.size());
        for (size_t i = 0; i < back->positions.size(); ++i) EXPECT_GT(glm::dot(back->normals[i], glm::normalize(back->positions[i])), 0.5);
    }
}

// A number whose lowest byte is a line's end begins the data.
TEST(MarchingCubes, AssimpReadsAPlyThatBeginsWithALineFeed) {
    const testing::Scratch scratch;
    for (const uint32_t bits : {0x3D76F70AU, 0x3D76F70DU}) {
        const float x = std::bit_cast<float>(bits);
        const std::vector<vec3> corners = {vec3(x, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)};
        const std::vector<uint32_t> sides = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
        const std::string path = scratch.file("tetrahedron.ply");
        ASSERT_TRUE(writeFileAtomic(path, writePly({corners, sides, {}, {}})));
        Result<Mesh> back = importMesh(path);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->view().triangleCount(), 4U);
        EXPECT_NEAR(volumeOf(back->view()), volumeOf({corners, sides, {}, {}}), 1e-6);
    }
}

TEST(MarchingCubes, OfNothingIsNothing) {
    EXPECT_TRUE(meshOf({}, 2).indices.empty());
    Result<IsoSurface> none = IsoSurface::create({}, kSpacing);
    ASSERT_TRUE(none);
    EXPECT_FALSE(marchingCubes(*none, 0));
    EXPECT_FALSE(marchingCubes(*none, kMaxCellsPerSpacing + 1));
}

}  // namespace
}  // namespace rivulet::marching_cubes_test
