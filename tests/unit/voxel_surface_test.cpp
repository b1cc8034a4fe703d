// Surface voxels against an independent oracle: all thirteen separating axes in long double, at every voxel near every triangle.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/jobs.h"
#include "fluid/voxel/voxelize_surface.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_surface_test {
namespace {

using test::gridAround;
using test::gridOf;
using test::Mesh;
using Real = long double;

struct Vec {
    Real x, y, z;
    Vec operator-(const Vec& o) const { return {x - o.x, y - o.y, z - o.z}; }
};
Vec cross(const Vec& a, const Vec& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec wide(const vec3& p) { return {p.x, p.y, p.z}; }

// A triangle's axes with the interval it spans on each, all computed once. Corners relative to the grid's origin, in the mesh's unit.
class Oracle {
  public:
    Oracle(const Vec& a, const Vec& b, const Vec& c) {
        for (const Vec& axis : {Vec{1, 0, 0}, Vec{0, 1, 0}, Vec{0, 0, 1}}) {
            add(axis, {dot(axis, a), dot(axis, b), dot(axis, c)});
            // Both corners of an edge have one coordinate on the axes across it.
            for (const auto& [e, from, other] : {std::tuple{b - a, a, c}, std::tuple{c - b, b, a}, std::tuple{a - c, c, b}}) {
                const Vec over = cross(axis, e);
                add(over, {dot(over, from), dot(over, from), dot(over, from) + dot(over, other - from)});
            }
        }
        const Vec normal = cross(b - a, c - a);
        add(normal, {dot(normal, a), dot(normal, a), dot(normal, a)});
    }
    // Largest gap between triangle and box over all axes, in voxels; 0 or less: none separates them.
    Real gap(const ivec3& c, Real voxel) const {
        Real most = -1e30L;
        for (const Row& r : rows_) {
            const Real centre = voxel * (r.axis.x * (c.x + 0.5L) + r.axis.y * (c.y + 0.5L) + r.axis.z * (c.z + 0.5L));
            const Real half = 0.5L * voxel * (std::abs(r.axis.x) + std::abs(r.axis.y) + std::abs(r.axis.z));
            most = std::max({most, (r.low - (centre + half)) / (half + half), (centre - half - r.high) / (half + half)});
        }
        return most;
    }

  private:
    struct Row {
        Vec axis;
        Real low, high;
    };
    void add(const Vec& axis, std::initializer_list<Real> corners) {
        if (axis.x == 0 && axis.y == 0 && axis.z == 0) return;
        rows_.push_back({axis, std::min(corners), std::max(corners)});
    }
    std::vector<Row> rows_;
};

void voxelize(const Mesh& mesh, VoxelGrid& grid) {
    const MeshView view = mesh.view();
    voxelizeSurface(GridTriangles(std::span(&view, 1), grid), grid);
}

// Touching counts, so what is not apart must be set; what is more than 1e-9 voxels apart must not. `rounding`, in voxels: of the oracle; 0
// if the corners are exact in the grid, so that every case is decided.
void expectCovered(const Mesh& mesh, VoxelGrid grid, const std::string& name, Real rounding = 1e-12L) {
    voxelize(mesh, grid);
    std::vector<Real> gap(grid.count(), 1.0L);
    const Vec origin = wide(grid.origin);
    const auto voxel = static_cast<Real>(grid.voxel);
    for (size_t t = 0; t < mesh.indices.size(); t += 3) {
        const Vec a = wide(mesh.positions[mesh.indices[t]]) - origin, b = wide(mesh.positions[mesh.indices[t + 1]]) - origin,
                  c = wide(mesh.positions[mesh.indices[t + 2]]) - origin;
        const Oracle oracle(a, b, c);
        const auto range = [&](Real p, Real q, Real r, int size) {
            const Real low = std::floor(std::min({p, q, r}) / voxel) - 1, high = std::floor(std::max({p, q, r}) / voxel) + 1;
            return std::pair{static_cast<int>(std::clamp<Real>(low, 0, size)), static_cast<int>(std::clamp<Real>(high, -1, size - 1))};
        };
        const auto [x0, x1] = range(a.x, b.x, c.x, grid.size.x);
        const auto [y0, y1] = range(a.y, b.y, c.y, grid.size.y);
        const auto [z0, z1] = range(a.z, b.z, c.z, grid.size.z);
        for (int z = z0; z <= z1; ++z)
            for (int y = y0; y <= y1; ++y)
                for (int x = x0; x <= x1; ++x) {
                    Real& least = gap[grid.index({x, y, z})];
                    if (least > 0) least = std::min(least, oracle.gap({x, y, z}, voxel));
                }
    }
    size_t missed = 0, extra = 0, set = 0;
    for (size_t k = 0; k < grid.count(); ++k) {
        const bool bit = ((grid.bits[k >> 3U] >> (k & 7U)) & 1U) != 0;
        set += bit ? 1 : 0;
        missed += !bit && gap[k] <= -rounding ? 1 : 0;
        missed += !bit && rounding == 0 && gap[k] <= 0 ? 1 : 0;
        extra += bit && gap[k] > 1e-9L + rounding ? 1 : 0;
    }
    EXPECT_GT(set, 0U) << name;
    EXPECT_EQ(missed, 0U) << name << ": of " << set;
    EXPECT_EQ(extra, 0U) << name << ": of " << set;
}

TEST(VoxelOverlap, TrianglesOfEveryShape) {
    for (unsigned seed = 11; seed <= 16; ++seed) {
        const Mesh jumble = test::makeJumble(seed, 84);
        expectCovered(jumble, gridAround(jumble, 24), "jumble");
        expectCovered(jumble, gridOf(ivec3(11, 19, 7), vec3(-0.4F, -0.3F, -0.2F), 0.037F), "part of a jumble");
    }
    for (const vec3& normal : {vec3(1, 0, 0), vec3(1, 1, 0), vec3(1, 1, 1), vec3(0.3F, 1, 0.2F), vec3(1e-3F, 1, 0)}) {
        const Mesh sheet = test::makeSheet(vec3(0.1F, 0.2F, 0.3F), normal, 1.0F);
        expectCovered(sheet, gridAround(sheet, 40, 1.0F), "sheet");
    }
}

TEST(VoxelOverlap, NeedlesOfEveryThickness) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    const auto point = [&] { return vec3(at(random), at(random), at(random)); };
    for (int k = 0; k < 40; ++k) {
        Mesh needle;
        const vec3 a = point(), b = point();
        const float thick = std::pow(10.0F, -static_cast<float>(k % 8));  // the last are below the resolution of floats
        needle.triangle(a, b, a + thick * point());
        needle.triangle(a, b, 0.5F * (a + b) + thick * point());
        expectCovered(needle, gridOf(ivec3(96), vec3(-1.0F), 2.0F / 96.0F), "needle of " + std::to_string(thick));
    }
    // Along one axis, within rounding of it.
    for (int axis = 0; axis < 3; ++axis) {
        Mesh needle;
        vec3 along(0.0F), aside(0.0F);
        along[axis] = 1.0F;
        aside[(axis + 1) % 3] = 1e-7F;
        needle.triangle(-0.9F * along + 0.1F, 0.9F * along + 0.1F + aside, 0.1F - aside);
        expectCovered(needle, gridOf(ivec3(64), vec3(-1.0F), 1.0F / 32.0F), "needle along an axis");
    }
}

TEST(VoxelOverlap, CornersExactlyOnTheGrid) {
    // Multiples of a quarter of a voxel: every touch is exact, and every case is decided.
    std::mt19937 random(9);
    std::uniform_int_distribution<int> quarter(0, 32);
    const auto along = [&](int step) { return 0.25F * static_cast<float>(quarter(random) & -step); };
    const auto point = [&](int step) { return vec3(along(step), along(step), along(step)); };
    for (int k = 0; k < 300; ++k) {
        Mesh mesh;
        const int step = k % 3 == 0 ? 4 : (k % 3 == 1 ? 2 : 1);
        mesh.triangle(point(step), point(step), point(step));
        expectCovered(mesh, gridOf(ivec3(9), vec3(0.0F), 1.0F), "corners on the grid", 0.0L);
        expectCovered(mesh, gridOf(ivec3(9), vec3(-0.5F), 1.0F), "corners amid the grid", 0.0L);
    }
}

TEST(VoxelOverlap, TestMeshes) {
    for (const std::filesystem::path& path : test::testMeshes()) {
        const Mesh mesh = test::readObj(path);
        const bool large = mesh.indices.size() > 60000;
        expectCovered(mesh, gridAround(mesh, large ? 72 : 29), path.stem());
        if (!large) expectCovered(mesh, gridAround(mesh, 64, 0.3F), path.stem());
    }
}

TEST(VoxelOverlap, TheSameForAnyNumberOfThreads) {
    const Mesh mesh = test::makeJumble(3, 500);
    VoxelGrid one = gridAround(mesh, 50), many = one;
    {
        const Workers single(1);
        const JobsScope scope(single.jobs());
        voxelize(mesh, one);
    }
    voxelize(mesh, many);
    EXPECT_EQ(one.bits, many.bits);
}

}  // namespace
}  // namespace rivulet::voxel_surface_test
