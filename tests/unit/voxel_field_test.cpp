// Surface voxels and the distance band against brute force, and errors for bad input.
#include "fluid/voxel/voxel_field.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/jobs.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_field_test {
namespace {

using test::Mesh;

VoxelField bake(const Mesh& mesh, int resolution, float band = 0) {
    const MeshView view = mesh.view();
    VoxelFieldOptions options;
    options.resolution = resolution;
    options.band = band;
    Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), options);
    EXPECT_TRUE(field) << field.error().message;
    return field ? std::move(*field) : VoxelField{};
}

// Triangle corner k of the mesh, in double.
std::array<dvec3, 3> corners(const Mesh& mesh, size_t triangle) {
    return {dvec3(mesh.positions[mesh.indices[3 * triangle]]), dvec3(mesh.positions[mesh.indices[3 * triangle + 1]]),
            dvec3(mesh.positions[mesh.indices[3 * triangle + 2]])};
}

// An algorithm other than separating axes: the polygon clipped by the six half-spaces of the box (Sutherland and Hodgman
// 1974). `grow` moves the faces out.
bool overlaps(const std::array<dvec3, 3>& triangle, const dvec3& low, const dvec3& high, double grow) {
    std::vector<dvec3> polygon(triangle.begin(), triangle.end());
    for (int axis = 0; axis < 3; ++axis) {
        for (double side : {-1.0, 1.0}) {
            const double limit = (side > 0 ? high[axis] : -low[axis]) + grow;
            std::vector<dvec3> kept;
            for (size_t k = 0; k < polygon.size(); ++k) {
                const dvec3& a = polygon[k];
                const dvec3& b = polygon[(k + 1) % polygon.size()];
                const double da = side * a[axis] - limit, db = side * b[axis] - limit;
                if (da <= 0) kept.push_back(a);
                if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
                    dvec3 cut = a + (b - a) * (da / (da - db));
                    cut[axis] = side * limit;
                    kept.push_back(cut);
                }
            }
            polygon = std::move(kept);
            if (polygon.empty()) return false;
        }
    }
    return true;
}

struct Coverage {
    size_t missed = 0, extra = 0, set = 0;
};

// Every (triangle, voxel) pair of the triangle's bounds, grown by a voxel. Cases within rounding (1e-7 voxels) may go either way.
Coverage compare(const Mesh& mesh, const VoxelGrid& grid) {
    const double tiny = 1e-7 * static_cast<double>(grid.voxel);
    std::vector<bool> surely(grid.count()), perhaps(grid.count());
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        const auto triangle = corners(mesh, t);
        const dvec3 low = glm::min(triangle[0], glm::min(triangle[1], triangle[2])),
                    high = glm::max(triangle[0], glm::max(triangle[1], triangle[2]));
        const dvec3 origin(grid.origin);
        const auto voxel = static_cast<double>(grid.voxel);
        const ivec3 first = glm::max(ivec3(glm::floor((low - origin) / voxel)) - 1, ivec3(0));
        const ivec3 last = glm::min(ivec3(glm::floor((high - origin) / voxel)) + 1, grid.size - 1);
        for (int z = first.z; z <= last.z; ++z) {
            for (int y = first.y; y <= last.y; ++y) {
                for (int x = first.x; x <= last.x; ++x) {
                    const dvec3 boxLow = origin + voxel * dvec3(x, y, z), boxHigh = boxLow + voxel;
                    const size_t k = grid.index({x, y, z});
                    if (!surely[k] && overlaps(triangle, boxLow, boxHigh, -tiny)) surely[k] = true;
                    if (!perhaps[k] && overlaps(triangle, boxLow, boxHigh, tiny)) perhaps[k] = true;
                }
            }
        }
    }
    Coverage c;
    for (int z = 0; z < grid.size.z; ++z) {
        for (int y = 0; y < grid.size.y; ++y) {
            for (int x = 0; x < grid.size.x; ++x) {
                const bool set = grid.test({x, y, z});
                const size_t k = grid.index({x, y, z});
                c.set += set ? 1 : 0;
                c.missed += surely[k] && !set ? 1 : 0;
                c.extra += set && !perhaps[k] ? 1 : 0;
            }
        }
    }
    return c;
}

void expectCovered(const Mesh& mesh, int resolution, const std::string& name) {
    const VoxelField field = bake(mesh, resolution);
    const Coverage c = compare(mesh, field.surface);
    EXPECT_GT(c.set, 0U) << name;
    EXPECT_EQ(c.missed, 0U) << name << ": voxels that a triangle passes through are not set";
    EXPECT_EQ(c.extra, 0U) << name << ": voxels are set that no triangle touches";
}

TEST(VoxelSurface, CoversGeneratedMeshes) {
    expectCovered(test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 1.0F), 24, "sphere");
    expectCovered(test::makeBox(vec3(-1), vec3(1.0F, 0.37F, 0.11F)), 21, "box");
    for (unsigned seed = 1; seed <= 6; ++seed) expectCovered(test::makeJumble(seed, 70), 16, "jumble");
    for (const vec3& normal : {vec3(1, 0, 0), vec3(1, 1, 0), vec3(1, 1, 1), vec3(0.3F, 1, 0.2F), vec3(1e-3F, 1, 0)})
        expectCovered(test::makeSheet(vec3(0), normal, 1.0F), 24, "sheet");
}

TEST(VoxelSurface, CoversTestMeshes) {
    for (const char* name : {"generated/cube_with_fin.obj", "generated/thin_wall_cup.obj", "generated/sphere_degenerate.obj",
                             "generated/mobius.obj", "generated/huge_sphere.obj", "../../assets/meshes/spot.obj"})
        expectCovered(test::readObj(test::testMesh(name)), 32, name);
}

// Corners on exact voxel boundaries, where doubles are exact: a triangle in a plane between voxels sets both sides of it.
TEST(VoxelSurface, TouchingCounts) {
    const Mesh probe = test::makeBox(vec3(0), vec3(1));
    const VoxelField own = bake(probe, 4);
    const vec3 plane = own.surface.origin + 6.0F * own.surface.voxel;
    Mesh mesh = probe;
    mesh.quad(plane, plane + vec3(0.25F, 0, 0), plane + vec3(0.25F, 0.25F, 0), plane + vec3(0, 0.25F, 0));
    const VoxelField field = bake(mesh, 4);
    ASSERT_EQ(field.surface.origin, own.surface.origin);
    for (int z : {5, 6}) {
        for (int y : {5, 6, 7}) {
            for (int x : {5, 6, 7}) EXPECT_TRUE(field.surface.test({x, y, z})) << x << ' ' << y << ' ' << z;
        }
    }
    EXPECT_EQ(compare(mesh, field.surface).missed, 0U);
}

// Distance from point to triangle by its definition: the nearest of the plane's foot point, if inside, and of the three edges; long double.
double referenceDistance(const std::array<dvec3, 3>& t, const dvec3& p) {
    using Wide = glm::tvec3<long double>;
    const Wide q(p);
    const std::array<Wide, 3> c{Wide(t[0]), Wide(t[1]), Wide(t[2])};
    long double best = std::numeric_limits<long double>::max();
    bool inside = true;
    const Wide n = glm::cross(c[1] - c[0], c[2] - c[0]);
    for (size_t k = 0; k < 3; ++k) {
        const Wide a = c[k], e = c[(k + 1) % 3] - a;
        const long double ee = glm::dot(e, e);
        const long double s = ee > 0 ? std::clamp(glm::dot(q - a, e) / ee, 0.0L, 1.0L) : 0.0L;
        best = std::min(best, glm::length(q - a - s * e));
        inside = inside && glm::dot(glm::cross(e, q - a), n) > 0;
    }
    if (inside) best = std::min(best, std::abs(glm::dot(q - c[0], n)) / glm::length(n));
    return static_cast<double>(best);
}

void expectExactBand(const Mesh& mesh, int resolution, float band) {
    const VoxelField field = bake(mesh, resolution, band);
    const ivec3 points = field.surface.size + 1;
    ASSERT_EQ(field.distance.size(), static_cast<size_t>(points.x) * static_cast<size_t>(points.y) * static_cast<size_t>(points.z));
    double worst = 0;
    size_t k = 0;
    for (int z = 0; z < points.z; ++z) {
        for (int y = 0; y < points.y; ++y) {
            for (int x = 0; x < points.x; ++x, ++k) {
                const dvec3 p = dvec3(field.surface.origin) + static_cast<double>(field.surface.voxel) * dvec3(x, y, z);
                double nearest = static_cast<double>(field.band);
                for (size_t t = 0; t < mesh.indices.size() / 3; ++t) nearest = std::min(nearest, referenceDistance(corners(mesh, t), p));
                worst = std::max(worst, std::abs(nearest - std::abs(static_cast<double>(field.distance[k]))));
            }
        }
    }
    EXPECT_LT(worst, 1e-6 * static_cast<double>(field.surface.voxel * static_cast<float>(resolution)));
}

TEST(VoxelBand, DistanceIsExact) {
    expectExactBand(test::makeSphere(vec3(0), 1.0F, 6), 16, 0.0F);
    expectExactBand(test::makeBox(vec3(-1), vec3(1.0F, 0.37F, 0.11F)), 13, 1.5F);
    for (unsigned seed = 1; seed <= 3; ++seed) expectExactBand(test::makeJumble(seed, 35), 12, 0.6F);
}

TEST(VoxelBand, ClearanceIsWithinADiagonalOfTheDistance) {
    const Mesh mesh = test::makeJumble(7, 35);
    const VoxelField field = bake(mesh, 24, 0.3F);
    const auto voxel = static_cast<double>(field.surface.voxel);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> at(-1.5F, 1.5F);
    for (int k = 0; k < 3000; ++k) {
        const vec3 p(at(random), at(random), at(random));
        double nearest = static_cast<double>(field.band);
        for (size_t t = 0; t < mesh.indices.size() / 3; ++t) nearest = std::min(nearest, referenceDistance(corners(mesh, t), dvec3(p)));
        const auto clearance = static_cast<double>(field.clearance(p));
        EXPECT_LE(clearance, std::min(nearest + 1.7321 * voxel, static_cast<double>(field.band) * 1.00001));
        EXPECT_GE(clearance, nearest - 1.7321 * voxel);
        if (field.surface.contains(field.surface.cellOf(p)) && field.surface.test(field.surface.cellOf(p))) {
            EXPECT_LE(clearance, nearest + 1e-5 * voxel);
            EXPECT_LT(clearance, static_cast<double>(kContactVoxels) * voxel) << "no particle is spawned in a set voxel";
        }
    }
}

// Beside the walls and in the corners of a hollow box it is the distance to the nearest wall; beside a sphere, on both sides, it is exact
// to second order in voxels.
TEST(VoxelBand, ClearanceIsTheDistance) {
    std::mt19937 random(2);
    const auto inside = [&random](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
    const VoxelField box = bake(test::makeBox(vec3(-1), vec3(1.0F, 0.7F, 0.9F)), 40, 0.4F);
    const float voxel = box.surface.voxel;
    for (int k = 0; k < 3000; ++k) {
        const vec3 p(inside(-1, 1), inside(-1, 0.7F), inside(-1, 0.9F)), walls = glm::min(p + 1.0F, vec3(1.0F, 0.7F, 0.9F) - p);
        const float nearest = std::min({walls.x, walls.y, walls.z, box.band});
        if (nearest < 1.74F * voxel || nearest > box.band - 1.74F * voxel) continue;
        EXPECT_NEAR(box.clearance(p), nearest, 1e-3F * voxel) << p.x << " " << p.y << " " << p.z;
    }
    const VoxelField ball = bake(test::makeSphere(vec3(0.0F), 1.0F, 96), 40, 0.4F);
    for (int k = 0; k < 3000; ++k) {
        const vec3 p(inside(-1.4F, 1.4F), inside(-1.4F, 1.4F), inside(-1.4F, 1.4F));
        const float nearest = std::abs(glm::length(p) - 1);
        if (nearest < 1.74F * ball.surface.voxel || nearest > 0.3F) continue;
        EXPECT_NEAR(ball.clearance(p), nearest, 1.5F * ball.surface.voxel * ball.surface.voxel + 0.0006F);
    }
}

TEST(VoxelField, PaddingHoldsTheBand) {
    const VoxelField field = bake(test::makeSphere(vec3(3), 0.5F), 17, 0.2F);
    const ivec3 n = field.surface.size;
    for (int z = 0; z <= n.z; ++z) {
        for (int y = 0; y <= n.y; ++y) {
            for (int x = 0; x <= n.x; ++x) {
                if (x > 0 && y > 0 && z > 0 && x < n.x && y < n.y && z < n.z) continue;
                const auto k = static_cast<size_t>((z * (n.y + 1) + y) * (n.x + 1) + x);
                ASSERT_EQ(field.distance[k], field.band) << "no mesh may reach the border of the field";
            }
        }
    }
}

TEST(VoxelField, SameForAnyNumberOfThreads) {
    const Mesh mesh = test::makeJumble(3, 210);
    const VoxelField many = bake(mesh, 48);
    const Workers one(1);
    const JobsScope scope(one.jobs());
    const VoxelField alone = bake(mesh, 48);
    EXPECT_EQ(many.surface.bits, alone.surface.bits);
    EXPECT_EQ(many.distance, alone.distance);
}

TEST(VoxelField, SeveralMeshesAreOne) {
    const Mesh a = test::makeSphere(vec3(0), 0.5F, 9), b = test::makeBox(vec3(0.2F), vec3(0.9F));
    Mesh both = a;
    for (uint32_t i : b.indices) both.indices.push_back(i + static_cast<uint32_t>(a.positions.size()));
    both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
    const MeshView views[] = {a.view(), b.view()};
    VoxelFieldOptions options;
    options.resolution = 30;
    const Result<VoxelField> two = bakeVoxelField(views, options);
    ASSERT_TRUE(two);
    const VoxelField one = bake(both, 30);
    EXPECT_EQ(two->surface.bits, one.surface.bits);
    EXPECT_EQ(two->distance, one.distance);
}

std::string errorOf(const Mesh& mesh, VoxelFieldOptions options = {}) {
    const MeshView view = mesh.view();
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), options);
    return field ? "no error" : field.error().message;
}

void expectSays(const std::string& message, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is missing in: " << message;
}

TEST(VoxelField, BadInputIsNamed) {
    const Mesh good = test::makeBox(vec3(0), vec3(1));
    expectSays(errorOf(Mesh{}), {"no triangle"});
    EXPECT_FALSE(bakeVoxelField({}, {}));

    Mesh bad = good;
    bad.indices[4] = 4711;
    expectSays(errorOf(bad), {"4711", "36 vertices", "triangle 1"});

    bad = good;
    bad.indices.pop_back();
    expectSays(errorOf(bad), {"35 indices"});

    bad = good;
    bad.positions[3].x = std::numeric_limits<float>::quiet_NaN();
    bad.positions[8].z = -std::numeric_limits<float>::infinity();
    expectSays(errorOf(bad), {"2 of 36 vertices", "NaN or infinite"});

    bad = good;
    for (vec3& p : bad.positions) p = vec3(1, 2, 3);
    expectSays(errorOf(bad), {"no extent"});

    bad = good;
    for (vec3& p : bad.positions) p += vec3(1e6F, 0, 0);
    expectSays(errorOf(bad), {"origin"});

    VoxelFieldOptions options;
    for (int resolution : {-1, 0, 1, 2049, 5000}) {
        options.resolution = resolution;
        expectSays(errorOf(good, options), {"2..2048", std::to_string(resolution).c_str()});
    }
    options.resolution = 1024;
    expectSays(errorOf(good, options), {"GB", "resolution of"});
    options.resolution = 64;
    options.memoryLimit = 1 << 20;
    const std::string message = errorOf(good, options);
    expectSays(message, {"needs 3.6 MB", "1.0 MB allowed", "resolution of "});
    options.resolution = std::stoi(message.substr(message.find("resolution of ", 40) + 14));
    EXPECT_EQ(errorOf(good, options), "no error") << "the reported resolution must fit";
    ++options.resolution;
    expectSays(errorOf(good, options), {"allowed"});
    options.band = 1e6F;
    expectSays(errorOf(good, options), {"too wide"});
    options.band = std::numeric_limits<float>::quiet_NaN();
    expectSays(errorOf(good, options), {"band"});
}

// A flat mesh has an extent in two directions only; a vertex that no triangle uses is ignored.
TEST(VoxelField, FlatMeshesAndStrayVertices) {
    Mesh flat = test::makeSheet(vec3(0), vec3(0, 1, 0), 2.0F);
    flat.positions.push_back(vec3(1e3F));
    const VoxelField field = bake(flat, 20);
    EXPECT_NEAR(field.surface.voxel, 0.1F, 1e-6F);
    EXPECT_LT(field.surface.size.y, 15);
}

}  // namespace
}  // namespace rivulet::voxel_field_test
