// Mode depth against an oracle: the voxels in which lines through voxel centres meet triangles, and the connected regions of the rest.
#include "fluid/voxel/voxelize_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "engine/compute/device_cpu.h"
#include "engine/core/jobs.h"
#include "fluid/voxel/voxelize_surface.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_depth_test {
namespace {

using test::Mesh;

// `resolution` voxels on the longest side, the mesh's bounds centred.
VoxelGrid gridAmid(const Mesh& mesh, int resolution) {
    Bounds bounds;
    for (uint32_t k : mesh.indices) bounds.add(mesh.positions[k]);
    const vec3 size = bounds.size();
    VoxelGrid grid;
    grid.voxel = 1.00001F * std::max(size.x, std::max(size.y, size.z)) / static_cast<float>(resolution);
    grid.size = glm::max(ivec3(glm::ceil(size / grid.voxel)), ivec3(1));
    grid.origin = bounds.centre() - 0.5F * grid.voxel * vec3(grid.size);
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    return grid;
}

DepthVoxels voxelize(const Mesh& mesh, const VoxelGrid& grid, bool thesisOrder = false) {
    const auto cpu = makeCpuDevice({}, {});
    const MeshView view = mesh.view();
    Result<DepthVoxels> made = voxelizeDepth(*cpu, std::span(&view, 1), grid, {thesisOrder, {}});
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : DepthVoxels{};
}

struct Oracle {
    std::vector<uint8_t> surely, perhaps;
};

// Every line through voxels' centres against every triangle, in long double, by the three areas that the line's point cuts the
// projection into. Nearer than 1e-7 voxels to an edge, or to a face between voxels, it may go either way.
Oracle oracle(const Mesh& mesh, const VoxelGrid& grid) {
    using Wide = glm::tvec3<long double>;
    constexpr long double kUnsure = 1e-7L;
    Oracle o{std::vector<uint8_t>(grid.count()), std::vector<uint8_t>(grid.count())};
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        std::array<Wide, 3> corner;
        for (size_t k = 0; k < 3; ++k)
            corner[k] = (Wide(mesh.positions[mesh.indices[3 * t + k]]) - Wide(grid.origin)) / static_cast<long double>(grid.voxel);
        for (int axis = 0; axis < 3; ++axis) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto area = [&](const Wide& a, const Wide& b, const Wide& c) {
                return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
            };
            const auto apart = [&](const Wide& a, const Wide& b) { return std::hypot(b[u] - a[u], b[v] - a[v]); };
            const long double whole = area(corner[0], corner[1], corner[2]);
            const Wide low = glm::min(corner[0], glm::min(corner[1], corner[2])),
                       high = glm::max(corner[0], glm::max(corner[1], corner[2]));
            for (int j = std::max(0, static_cast<int>(low[v]) - 1); j < std::min<int>(grid.size[v], static_cast<int>(high[v]) + 2); ++j) {
                for (int i = std::max(0, static_cast<int>(low[u]) - 1); i < std::min<int>(grid.size[u], static_cast<int>(high[u]) + 2);
                     ++i) {
                    Wide p(0);
                    p[u] = i + 0.5L;
                    p[v] = j + 0.5L;
                    std::array<long double, 3> part{};  // opposite each corner
                    bool inside = true, near = true;
                    for (size_t k = 0; k < 3; ++k) {
                        const Wide &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
                        part[k] = whole < 0 ? -area(a, b, p) : area(a, b, p);
                        const long double unsure = kUnsure * std::max(kUnsure, apart(a, b));
                        inside = inside && part[k] > unsure;
                        near = near && part[k] > -unsure;
                    }
                    near =
                        near && p[u] > low[u] - kUnsure && p[u] < high[u] + kUnsure && p[v] > low[v] - kUnsure && p[v] < high[v] + kUnsure;
                    if (!near) continue;
                    const auto mark = [&](std::vector<uint8_t>& marks, long double depth) {
                        ivec3 c(0);
                        c[u] = i;
                        c[v] = j;
                        c[axis] = std::clamp(static_cast<int>(std::floor(depth)), 0, grid.size[axis] - 1);
                        marks[grid.index(c)] = 1;
                    };
                    if (!inside) {  // anywhere between the corners
                        for (long double d = std::floor(low[axis]) + 0.5L; d < high[axis] + 1; ++d) mark(o.perhaps, d);
                        mark(o.perhaps, low[axis] - kUnsure);
                        mark(o.perhaps, high[axis] + kUnsure);
                        continue;
                    }
                    const long double depth =
                        (part[0] * corner[0][axis] + part[1] * corner[1][axis] + part[2] * corner[2][axis]) / (part[0] + part[1] + part[2]);
                    const long double unsure = kUnsure + 1e-12L * (high[axis] - low[axis]) / std::abs(whole);
                    mark(o.perhaps, depth - unsure);
                    mark(o.perhaps, depth + unsure);
                    if (std::floor(depth - unsure) == std::floor(depth + unsure)) mark(o.surely, depth);
                }
            }
        }
    }
    return o;
}

void expectSameLabels(const VoxelLabels& a, const VoxelLabels& b) {
    EXPECT_EQ(a.outside, b.outside);
    EXPECT_EQ(a.surface, b.surface);
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (size_t k = 0; k < a.materials.size(); ++k) {
        EXPECT_EQ(a.materials[k].voxels, b.materials[k].voxels);
        EXPECT_EQ(a.materials[k].low, b.materials[k].low);
        EXPECT_EQ(a.materials[k].high, b.materials[k].high);
        EXPECT_DOUBLE_EQ(a.materials[k].volume, b.materials[k].volume);
    }
    EXPECT_EQ(a.rowStart, b.rowStart);
    ASSERT_EQ(a.runs.size(), b.runs.size());
    size_t differ = 0;
    for (size_t k = 0; k < a.runs.size(); ++k) differ += a.runs[k].x != b.runs[k].x || a.runs[k].label != b.runs[k].label ? 1 : 0;
    EXPECT_EQ(differ, 0U);
}

// Both orders give the surface of the oracle, and as labels the connected regions of the rest (another test compares labelRegions with a
// flood fill).
DepthVoxels expectRight(const Mesh& mesh, const VoxelGrid& grid) {
    const Oracle expected = oracle(mesh, grid);
    DepthVoxels own = voxelize(mesh, grid);
    const DepthVoxels thesis = voxelize(mesh, grid, true);
    size_t missed = 0, extra = 0, k = 0;
    for (int z = 0; z < grid.size.z; ++z) {
        for (int y = 0; y < grid.size.y; ++y) {
            for (int x = 0; x < grid.size.x; ++x, ++k) {
                const bool set = own.surface.test({x, y, z});
                missed += expected.surely[k] != 0 && !set ? 1 : 0;
                extra += expected.perhaps[k] == 0 && set ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(missed, 0U);
    EXPECT_EQ(extra, 0U);
    EXPECT_EQ(own.surface.bits, thesis.surface.bits);
    const VoxelLabels regions = labelRegions(own.surface, nullptr);
    expectSameLabels(own.labels, regions);
    expectSameLabels(thesis.labels, regions);
    EXPECT_EQ(
        own.labels.outside + own.labels.surface +
            [&] {
                size_t inside = 0;
                for (const VoxelMaterial& m : own.labels.materials) inside += m.voxels;
                return inside;
            }(),
        grid.count());
    return own;
}

DepthVoxels expectRight(const Mesh& mesh, int resolution) { return expectRight(mesh, gridAmid(mesh, resolution)); }

void append(Mesh& to, const Mesh& from) {
    for (uint32_t k : from.indices) to.indices.push_back(k + static_cast<uint32_t>(to.positions.size()));
    to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
}

TEST(VoxelDepth, FindsTheSurfaceAndJoinsTheRest) {
    expectRight(test::makeBox(vec3(-1), vec3(1.0F, 0.37F, 0.11F)), 21);
    expectRight(test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 1.0F, 12), 24);
    for (unsigned seed = 1; seed <= 6; ++seed) {
        SCOPED_TRACE(seed);
        expectRight(test::makeJumble(seed, 70), 17);
    }
    for (const vec3& normal : {vec3(1, 0, 0), vec3(1, 1, 0), vec3(1, 1, 1), vec3(0.3F, 1, 0.2F), vec3(1e-3F, 1, 0)})
        expectRight(test::makeSheet(vec3(0), normal, 1.0F), 24);
}

TEST(VoxelDepth, TestMeshes) {
    for (const char* name : {"generated/cube_with_fin.obj", "generated/thin_wall_cup.obj", "generated/sphere_degenerate.obj",
                             "generated/mobius.obj", "generated/huge_sphere.obj", "../../assets/meshes/spot.obj"}) {
        SCOPED_TRACE(name);
        const Mesh mesh = test::readObj(test::testMesh(name));
        expectRight(mesh, 30);
    }
}

// A closed mesh separates the voxels: no path through faces of voxels leads from inside to outside, at any tilt and resolution.
TEST(VoxelDepth, ClosedMeshesAreClosed) {
    for (int resolution : {5, 16, 33, 64, 81}) {
        for (int turn = 0; turn < 5; ++turn) {
            Mesh mesh = test::makeBox(vec3(-1), vec3(1, 0.8F, 0.9F));
            const float a = 0.31F * static_cast<float>(turn), b = 0.17F * static_cast<float>(turn);
            for (vec3& p : mesh.positions) {
                p = vec3(std::cos(a) * p.x - std::sin(a) * p.y, std::sin(a) * p.x + std::cos(a) * p.y, p.z);
                p = vec3(p.x, std::cos(b) * p.y - std::sin(b) * p.z, std::sin(b) * p.y + std::cos(b) * p.z);
            }
            const DepthVoxels made = voxelize(mesh, gridAmid(mesh, resolution));
            ASSERT_EQ(made.labels.materials.size(), 1U) << resolution << ' ' << turn;
            const double volume = 2.0 * 1.8 * 1.9, area = 2.0 * (2.0 * 1.8 + 2.0 * 1.9 + 1.8 * 1.9);
            EXPECT_LE(made.labels.materials[0].volume, volume);
            EXPECT_GE(made.labels.materials[0].volume, volume - 1.8 * static_cast<double>(made.surface.voxel) * area);
        }
    }
}

TEST(VoxelDepth, NestedShellsAreSeparateMaterials) {
    Mesh mesh;
    for (const float radius : {1.0F, 0.7F, 0.4F}) append(mesh, test::makeSphere(vec3(0), radius));
    append(mesh, test::makeBox(vec3(-0.1F), vec3(0.1F)));
    const DepthVoxels made = expectRight(mesh, 48);
    ASSERT_EQ(made.labels.materials.size(), 4U);
    const auto ball = [](double r) { return 4.0 / 3.0 * 3.14159265 * r * r * r; };
    EXPECT_NEAR(made.labels.materials[0].volume, ball(1.0) - ball(0.7), 0.3 * (ball(1.0) - ball(0.7)));
    EXPECT_NEAR(made.labels.materials[1].volume, ball(0.7) - ball(0.4), 0.3 * (ball(0.7) - ball(0.4)));
    EXPECT_EQ(made.labels.at(made.surface.size / 2), kFirstMaterial + 3);
}

// Slabs find voxels that are hidden in the six images of the whole box: a maze of walls and paths round them.
TEST(VoxelDepth, HiddenChannelsLeadOutside) {
    Mesh mesh = test::makeBox(vec3(0), vec3(8));
    for (int k = 1; k < 8; ++k) {  // shelves, each with a slot at alternating ends
        const float y = static_cast<float>(k) + 0.02F, x = k % 2 == 0 ? 0.0F : 0.6F;
        append(mesh, test::makeBox(vec3(x, y, 0), vec3(x + 7.4F, y + 0.05F, 8)));
    }
    const DepthVoxels closed = expectRight(mesh, 40);
    size_t largest = 0;
    for (const VoxelMaterial& m : closed.labels.materials) largest = std::max(largest, m.voxels);
    EXPECT_GT(largest, 40U * 40U * 25U) << "the path between the shelves is one region";
    mesh.indices.erase(mesh.indices.begin() + 6, mesh.indices.begin() + 12);  // the lid of the far side: all shelves open
    const DepthVoxels open = expectRight(mesh, 40);
    largest = 0;
    for (const VoxelMaterial& m : open.labels.materials) largest = std::max(largest, m.voxels);
    EXPECT_LT(largest, 40U * 40U);
}

// Every voxel that mode depth finds, mode surface finds too.
TEST(VoxelDepth, IsWithinTheSurface) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const Mesh mesh = test::makeJumble(seed, 140);
        VoxelGrid grid = gridAmid(mesh, 40);
        const DepthVoxels made = voxelize(mesh, grid);
        const MeshView view = mesh.view();
        voxelizeSurface(GridTriangles(std::span(&view, 1), grid), grid);
        size_t beyond = 0;
        for (size_t k = 0; k < grid.bits.size(); ++k) beyond += (made.surface.bits[k] & ~grid.bits[k]) != 0 ? 1 : 0;
        EXPECT_EQ(beyond, 0U);
    }
}

TEST(VoxelDepth, ThinGridsAndBothOrders) {
    for (const ivec3& size : {ivec3(1, 1, 1), ivec3(1, 9, 7), ivec3(20, 1, 3), ivec3(5, 6, 1), ivec3(33, 2, 9)}) {
        Mesh mesh = test::makeJumble(9, 21);
        for (vec3& p : mesh.positions) p = (p * 0.5F + 0.5F) * vec3(size);
        VoxelGrid grid{size, vec3(0), 1.0F, {}};
        grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
        expectRight(mesh, grid);
    }
}

TEST(VoxelDepth, SameForAnyNumberOfThreads) {
    const Mesh mesh = test::makeJumble(3, 210);
    const VoxelGrid grid = gridAmid(mesh, 48);
    const DepthVoxels many = voxelize(mesh, grid);
    const Workers one(1);
    const JobsScope scope(one.jobs());
    const DepthVoxels alone = voxelize(mesh, grid);
    EXPECT_EQ(many.surface.bits, alone.surface.bits);
    expectSameLabels(many.labels, alone.labels);
}

TEST(VoxelDepth, CanBeCancelled) {
    const Mesh mesh = test::makeSphere(vec3(0), 1.0F);
    const MeshView view = mesh.view();
    const auto cpu = makeCpuDevice({}, {});
    int calls = 0;
    const auto stop = [&](double) { return ++calls < 3; };
    const Result<DepthVoxels> made = voxelizeDepth(*cpu, std::span(&view, 1), gridAmid(mesh, 20), {true, stop});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().fault, Fault::failed);
    EXPECT_NE(made.error().message.find("cancelled"), std::string::npos);
    EXPECT_EQ(calls, 3);
}

// Spot, and Spot without the soles of its feet: one hole makes the whole interior outside.
TEST(VoxelDepth, OneHoleMakesTheInteriorOutside) {
    const auto largest = [](const DepthVoxels& made) {
        size_t most = 0;
        for (const VoxelMaterial& m : made.labels.materials) most = std::max(most, m.voxels);
        return static_cast<double>(most) / static_cast<double>(made.surface.count());
    };
    const Mesh whole = test::readObj(test::spotMesh());
    float lowest = whole.positions[0].y;
    for (const vec3& p : whole.positions) lowest = std::min(lowest, p.y);
    Mesh open = whole;
    open.indices.clear();
    for (size_t i = 0; i + 2 < whole.indices.size(); i += 3) {
        const auto y = [&](size_t corner) { return whole.positions[whole.indices[i + corner]].y; };
        if (std::max({y(0), y(1), y(2)}) > lowest + 0.05F)
            open.indices.insert(open.indices.end(), {whole.indices[i], whole.indices[i + 1], whole.indices[i + 2]});
    }
    ASSERT_LT(open.indices.size(), whole.indices.size());
    EXPECT_LT(largest(voxelize(open, gridAmid(open, 128))), 0.01);
    EXPECT_GT(largest(voxelize(whole, gridAmid(whole, 128))), 0.15);
}

}  // namespace
}  // namespace rivulet::voxel_depth_test
