// Solid voxels against the generalized winding number by brute force: every triangle's solid angle, in double, at voxels' centres.
#include "fluid/voxel/voxelize_solid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "engine/core/jobs.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_solid_test {
namespace {

using test::cleaned;
using test::gridAround;
using test::Mesh;

struct Oracle {
    double winding = 0;
    bool onSurface = false;  // within 1e-6 voxels
};

double distanceToTriangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const auto toSegment = [&](const dvec3& s, const dvec3& e) {
        const double all = glm::dot(e - s, e - s);
        return glm::length(p - (s + (e - s) * (all > 0 ? std::clamp(glm::dot(p - s, e - s) / all, 0.0, 1.0) : 0.0)));
    };
    const double rim = std::min({toSegment(a, b), toSegment(b, c), toSegment(c, a)});
    const dvec3 n = glm::cross(b - a, c - a);
    const double area = glm::length(n);
    if (area < 1e-12) return rim;
    const bool within = glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
                        glm::dot(glm::cross(a - c, p - c), n) >= 0;
    return within ? std::min(rim, std::abs(glm::dot(p - a, n)) / area) : rim;
}

// Van Oosterom and Strackee 1983.
Oracle oracleAt(const CleanMesh& mesh, const VoxelGrid& grid, const ivec3& voxel) {
    const dvec3 p = dvec3(voxel) + 0.5;
    const auto corner = [&](uint32_t index) {
        return (dvec3(mesh.positions[index]) - dvec3(grid.origin)) / static_cast<double>(grid.voxel) - p;
    };
    Oracle o;
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        const dvec3 a = corner(mesh.indices[t]), b = corner(mesh.indices[t + 1]), c = corner(mesh.indices[t + 2]);
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        const double volume = glm::dot(a, glm::cross(b, c));
        o.winding += std::atan2(volume, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
        const double twiceArea = glm::length(glm::cross(b - a, c - a));
        if (std::abs(volume) <= 1e-5 * twiceArea + 1e-12 && distanceToTriangle(dvec3(0.0), a, b, c) < 1e-6) o.onSurface = true;
    }
    o.winding /= 2.0 * std::numbers::pi;
    return o;
}

struct Wrong {
    size_t asked = 0, wrong = 0, inside = 0;
    std::string first;
};

void ask(const CleanMesh& mesh, const VoxelGrid& grid, const ivec3& c, Wrong& w, double tolerance = 1e-7) {
    const Oracle o = oracleAt(mesh, grid, c);
    if (o.onSurface || std::abs(std::abs(o.winding) - 0.5) < tolerance) return;
    ++w.asked;
    w.inside += grid.test(c) ? 1 : 0;
    if (grid.test(c) == (std::abs(o.winding) > 0.5)) return;
    if (w.wrong++ == 0)
        w.first = "voxel " + std::to_string(c.x) + " " + std::to_string(c.y) + " " + std::to_string(c.z) + " has winding number " +
                  std::to_string(o.winding);
}

// Every voxel, if triangles times voxels are within the budget; else some of all voxels, and some of those whose neighbours along x differ.
Wrong compare(const Mesh& mesh, VoxelGrid grid, double budget) {
    const CleanMesh clean = cleaned(mesh);
    voxelizeSolid(clean, grid);
    Wrong w;
    const auto affordable = static_cast<size_t>(budget / static_cast<double>(clean.source.size() + 1));
    std::vector<ivec3> all, edge;
    for (int z = 0; z < grid.size.z; ++z) {
        for (int y = 0; y < grid.size.y; ++y) {
            for (int x = 0; x < grid.size.x; ++x) {
                all.emplace_back(x, y, z);
                if (grid.test({x, y, z}) != grid.test({x + 1, y, z}) || grid.test({x, y, z}) != grid.test({x - 1, y, z}))
                    edge.emplace_back(x, y, z);
            }
        }
    }
    if (all.size() > affordable) {
        std::mt19937 random(7);
        for (std::vector<ivec3>* some : {&all, &edge}) {
            std::shuffle(some->begin(), some->end(), random);
            some->resize(std::min(some->size(), affordable / 2));
        }
        all.insert(all.end(), edge.begin(), edge.end());
    }
    for (const ivec3& c : all) ask(clean, grid, c, w);
    return w;
}

void expectRight(const Mesh& mesh, const VoxelGrid& grid, const std::string& name, double budget = 2.5e6) {
    const Wrong w = compare(mesh, grid, budget);
    EXPECT_GT(w.asked, 0U) << name;
    EXPECT_EQ(w.wrong, 0U) << name << ": of " << w.asked << ", first: " << w.first;
}

Mesh joined(const Mesh& a, const Mesh& b) {
    Mesh m = a;
    for (uint32_t i : b.indices) m.indices.push_back(i + static_cast<uint32_t>(a.positions.size()));
    m.positions.insert(m.positions.end(), b.positions.begin(), b.positions.end());
    return m;
}

Mesh turnedOver(Mesh m) {
    for (size_t t = 0; t < m.indices.size(); t += 3) std::swap(m.indices[t + 1], m.indices[t + 2]);
    return m;
}

// The mesh without the triangles for which `gone` is true.
template <class Gone>
Mesh without(const Mesh& mesh, Gone gone) {
    Mesh m = mesh;
    m.indices.clear();
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        if (gone(t)) continue;
        for (size_t k = 0; k < 3; ++k) m.indices.push_back(mesh.indices[3 * t + k]);
    }
    return m;
}

TEST(VoxelSolid, ClosedMeshesAreFilled) {
    const Mesh ball = test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 1.0F, 9);
    for (int resolution : {1, 2, 7, 16, 33}) expectRight(ball, gridAround(ball, resolution), "ball");
    expectRight(turnedOver(ball), gridAround(ball, 20), "inverted ball");
    const Mesh box = test::makeBox(vec3(0), vec3(1.0F, 0.5F, 0.25F));
    // Faces midway between, on and beside the planes of centres.
    for (float margin : {0.0F, 0.5F, 0.25F, 1.7F}) expectRight(box, gridAround(box, 16, margin), "box");
    const Mesh shells = joined(joined(ball, turnedOver(test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 0.7F, 9))),
                               test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 0.3F, 9));
    expectRight(shells, gridAround(shells, 24), "nested shells");
    const Mesh twice = joined(ball, test::makeSphere(vec3(0.6F, 0.2F, 0.3F), 0.8F, 9));
    expectRight(twice, gridAround(twice, 24, 2.0F), "overlapping balls");
}

TEST(VoxelSolid, CountsVoxelsOfABox) {
    // Faces on the planes of centres on both sides: half open, so each plane counts once.
    const Mesh box = test::makeBox(vec3(0), vec3(1));
    VoxelGrid grid = gridAround(box, 8, 0.5F);
    voxelizeSolid(cleaned(box), grid);
    size_t inside = 0;
    for (uint8_t byte : grid.bits) inside += static_cast<size_t>(std::popcount(byte));
    EXPECT_EQ(inside, 8U * 8U * 8U);
}

TEST(VoxelSolid, OpenMeshesByWindingNumber) {
    const Mesh ball = test::makeSphere(vec3(0), 1.0F, 9);
    expectRight(without(ball, [](size_t t) { return t % 7 == 0; }), gridAround(ball, 24), "ball with holes");
    expectRight(without(ball, [](size_t t) { return t < 120; }), gridAround(ball, 24), "bowl");
    expectRight(without(ball, [](size_t t) { return t % 2 == 0; }), gridAround(ball, 24), "half of the faces");
    const Mesh box = test::makeBox(vec3(0), vec3(1));
    for (size_t side = 0; side < 6; ++side)
        for (float margin : {0.0F, 0.5F})
            expectRight(without(box, [&](size_t t) { return t / 2 == side; }), gridAround(box, 12, margin), "box without a side");
    for (const vec3& normal : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0.3F, 1, 0.2F)}) {
        const Mesh sheet = test::makeSheet(vec3(0.1F, 0.2F, 0.3F), normal, 1.0F);
        expectRight(sheet, gridAround(sheet, 12, 3.0F), "sheet");
    }
    for (unsigned seed = 1; seed <= 4; ++seed)
        expectRight(test::makeJumble(seed, 40), gridAround(test::makeJumble(seed, 40), 16), "jumble");
    Mesh lone;
    lone.triangle(vec3(0), vec3(1, 0.1F, 0.2F), vec3(0.3F, 1, 0.7F));
    expectRight(lone, gridAround(lone, 12, 1.0F), "one triangle");
}

// Triangles about as long as `size` each, that share no vertex: jittered in space, or along a ball.
Mesh looseTriangles(int count, float size, bool ball) {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    const auto point = [&] { return vec3(at(random), at(random), at(random)); };
    Mesh m;
    for (int k = 0; k < count; ++k) {
        const vec3 p = point();
        if (!ball) {
            const vec3 q = point(), r = point();
            m.triangle(p, p + size * q, p + size * r);
            continue;
        }
        const vec3 out = glm::normalize(p), u = glm::normalize(glm::cross(out, vec3(0.3F, 0.5F, 0.8F))), v = glm::cross(out, u);
        m.triangle(out + size * u, out + size * v, out - size * (u + v));
    }
    return m;
}

TEST(VoxelSolid, ManyLoosePieces) {
    struct Case {
        int count;
        float size;
        bool ball;
        int resolution;
        double tolerance;
    };
    // The first three are exact; above 1,024 pieces the result has a limited accuracy.
    for (const Case& c : {Case{400, 0.5F, false, 16, 1e-7}, Case{1000, 0.3F, false, 16, 1e-7}, Case{1000, 0.08F, true, 20, 1e-7},
                          Case{6000, 0.3F, false, 24, 0.02}, Case{20000, 0.018F, true, 32, 0.02}}) {
        const Mesh mesh = looseTriangles(c.count, c.size, c.ball);
        const CleanMesh clean = cleaned(mesh);
        VoxelGrid grid = gridAround(mesh, c.resolution, 1.0F);
        voxelizeSolid(clean, grid);
        Wrong w;
        std::mt19937 random(3);
        const auto side = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
        for (int k = 0; k < 6'000'000 / c.count; ++k)
            ask(clean, grid, {side(grid.size.x), side(grid.size.y), side(grid.size.z)}, w, c.tolerance);
        EXPECT_GT(w.asked, 200U);
        EXPECT_GT(w.inside, 0U) << c.count;
        EXPECT_EQ(w.wrong, 0U) << c.count << " pieces: of " << w.asked << ", first: " << w.first;
    }
}

// One mesh with many holes, and loose triangles that touch it and each other.
TEST(VoxelSolid, ManyHolesAndLoosePieces) {
    const Mesh ball = test::makeSphere(vec3(0.1F), 1.0F, 16);
    const Mesh holes = without(ball, [](size_t t) { return t % 3 == 0; });
    expectRight(holes, gridAround(holes, 18), "many holes");
    Mesh both = joined(holes, looseTriangles(400, 0.1F, false));
    const auto centre = static_cast<uint32_t>(both.positions.size());
    both.positions.emplace_back(0.0F);
    for (uint32_t k = 0; k < 30; ++k) both.indices.insert(both.indices.end(), {centre, 7 * k, 7 * k + 3});
    expectRight(both, gridAround(both, 18), "holes and loose pieces");
}

TEST(VoxelSolid, ManyLoosePiecesCanBeCancelled) {
    const Mesh mesh = looseTriangles(1000, 0.2F, false);
    VoxelGrid grid = gridAround(mesh, 24);
    double last = 0;
    int calls = 0;
    EXPECT_TRUE(voxelizeSolid(cleaned(mesh), grid, [&](double done) {
        EXPECT_GE(done, last);
        EXPECT_LE(done, 1.0);
        last = done;
        ++calls;
        return true;
    }));
    EXPECT_GT(calls, 3);
    int left = 2;
    EXPECT_FALSE(voxelizeSolid(cleaned(mesh), grid, [&](double) { return --left > 0; }));
    EXPECT_EQ(left, 0) << "no call after the cancellation";
}

TEST(VoxelSolid, GridsThatCutTheMesh) {
    for (const Mesh& mesh :
         {test::makeSphere(vec3(0), 1.0F, 9), without(test::makeSphere(vec3(0), 1.0F, 9), [](size_t t) { return t % 5 == 0; })}) {
        VoxelGrid grid = gridAround(mesh, 32);
        grid.size = ivec3(13, 7, 5);
        for (const vec3& at : {vec3(-0.9F), vec3(-0.2F, 0.1F, 0.4F), vec3(0.3F, -1.1F, 0.0F), vec3(3.0F)}) {
            grid.origin = at;
            expectRight(mesh, grid, "part of a ball");
        }
    }
}

TEST(VoxelSolid, TestMeshes) {
    for (const std::filesystem::path& path : test::testMeshes()) {
        const Mesh mesh = test::readObj(path);
        expectRight(mesh, gridAround(mesh, 40), path.stem(), 1.5e6);
        expectRight(mesh, gridAround(mesh, 23, 1.5F), path.stem(), 1e6);
    }
}

TEST(VoxelSolid, NoTriangleSetsNothing) {
    VoxelGrid grid;
    grid.size = ivec3(5, 3, 2);
    grid.voxel = 1.0F;
    voxelizeSolid(CleanMesh{}, grid);
    EXPECT_EQ(grid.bits, std::vector<uint8_t>(4, 0));
}

TEST(VoxelSolid, TheSameForAnyNumberOfThreads) {
    const Mesh mesh = without(test::makeSphere(vec3(0), 1.0F, 24), [](size_t t) { return t % 11 == 0; });
    VoxelGrid one = gridAround(mesh, 61), many = one;
    {
        const Workers single(1);
        const JobsScope scope(single.jobs());
        voxelizeSolid(cleaned(mesh), one);
    }
    voxelizeSolid(cleaned(mesh), many);
    EXPECT_EQ(one.bits, many.bits);
    const Mesh loose = looseTriangles(1500, 0.1F, false);
    VoxelGrid oneOfLoose = gridAround(loose, 20), manyOfLoose = oneOfLoose;
    {
        const Workers single(1);
        const JobsScope scope(single.jobs());
        voxelizeSolid(cleaned(loose), oneOfLoose);
    }
    voxelizeSolid(cleaned(loose), manyOfLoose);
    EXPECT_EQ(oneOfLoose.bits, manyOfLoose.bits);
}

}  // namespace
}  // namespace rivulet::voxel_solid_test
