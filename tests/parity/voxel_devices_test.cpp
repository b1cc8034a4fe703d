// Surface and solid voxels: the same bits on gl and cl as on the host, and on the cpu with one thread and two.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "fluid/voxel/voxelize_solid.h"
#include "fluid/voxel/voxelize_surface.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_devices_test {
namespace {

struct Voxels {
    std::vector<uint8_t> surface, solid;
};

Voxels onHost(const test::Mesh& mesh, VoxelGrid grid) {
    const MeshView view = mesh.view();
    VoxelGrid solid = grid;
    voxelizeSurface(GridTriangles(std::span(&view, 1), grid), grid);
    voxelizeSolid(cleanMesh(std::span(&view, 1)), solid);
    return {grid.bits, solid.bits};
}

Voxels onDevice(Device& device, const test::Mesh& mesh, VoxelGrid grid) {
    const MeshView view = mesh.view();
    VoxelGrid solid = grid;
    const Status surfaceDone = voxelizeSurface(device, GridTriangles(std::span(&view, 1), grid), grid);
    EXPECT_TRUE(surfaceDone) << (surfaceDone ? "" : surfaceDone.error().message);
    const Status solidDone = voxelizeSolid(device, cleanMesh(std::span(&view, 1)), solid);
    EXPECT_TRUE(solidDone) << (solidDone ? "" : solidDone.error().message);
    return {grid.bits, solid.bits};
}

size_t setBits(const std::vector<uint8_t>& bits) {
    size_t set = 0;
    for (uint8_t byte : bits) set += static_cast<size_t>(std::popcount(byte));
    return set;
}

void expectSame(Device& device, const test::Mesh& mesh, const VoxelGrid& grid, const std::string& name) {
    const Voxels host = onHost(mesh, grid), there = onDevice(device, mesh, grid);
    EXPECT_GT(setBits(host.surface), 0U) << name;
    EXPECT_EQ(host.surface == there.surface, true) << name << ": " << setBits(host.surface) << " against " << setBits(there.surface);
    EXPECT_EQ(host.solid == there.solid, true) << name << ": " << setBits(host.solid) << " against " << setBits(there.solid);
}

test::Mesh holed(const test::Mesh& mesh, size_t every) {
    test::Mesh m = mesh;
    m.indices.clear();
    for (size_t t = 0; t < mesh.indices.size() / 3; ++t)
        if (t % every != 0) m.indices.insert(m.indices.end(), mesh.indices.begin() + 3 * t, mesh.indices.begin() + 3 * t + 3);
    return m;
}

class VoxelDevices : public ::testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (const std::string name = GetParam(); name.starts_with("cpu")) {
            gpu_.device = makeTestCpu(name == "cpu1" ? 1 : 2);
            return;
        }
        Result<TestGpu> made = makeTestGpu(GetParam());
        if (!made) GTEST_SKIP() << made.error().message;
        gpu_ = std::move(*made);
    }
    Device& device() { return *gpu_.device; }

  private:
    TestGpu gpu_;
};

TEST_P(VoxelDevices, GeneratedMeshes) {
    const test::Mesh ball = test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 1.0F, 16);
    for (int resolution : {1, 2, 5, 31, 32, 70}) expectSame(device(), ball, test::gridAround(ball, resolution), "ball");
    expectSame(device(), holed(ball, 9), test::gridAround(ball, 45), "ball with holes");
    const test::Mesh box = test::makeBox(vec3(0), vec3(1, 0.5F, 0.25F));
    for (int resolution : {8, 64, 300}) expectSame(device(), box, test::gridAround(box, resolution), "box");
    for (unsigned seed = 1; seed <= 3; ++seed) {
        const test::Mesh jumble = test::makeJumble(seed, 60);
        expectSame(device(), jumble, test::gridAround(jumble, 40), "jumble");
        expectSame(device(), jumble, test::gridOf(ivec3(17, 9, 23), vec3(-0.3F, -0.2F, -0.1F), 0.02F), "part of a jumble");
    }
}

// Corners at multiples of half a voxel: edges and planes pass through middles of voxels but for rounding, so that a compiler which
// contracts a * b + c sets other bits. PoCL contracts wherever a text does not forbid it.
TEST_P(VoxelDevices, EdgesThroughMiddlesOfVoxels) {
    constexpr int kEdge = 40;
    const VoxelGrid grid = test::gridOf(ivec3(kEdge), vec3(0), 1.0F);
    std::mt19937 random(7);
    for (int trial = 0; trial < 6; ++trial) {
        test::Mesh mesh;
        for (uint32_t k = 0; k < 3 * 24; ++k) {
            const auto along = [&random] { return static_cast<float>(random() % (2 * kEdge + 1)) / 2.0F; };
            mesh.positions.emplace_back(along(), along(), along());
            mesh.indices.push_back(k);
        }
        expectSame(device(), mesh, grid, "lattice");
    }
}

TEST_P(VoxelDevices, ManyLayersOfOneColumn) {
    // More crossings than the kernel's counters can hold: 400 nested boxes.
    test::Mesh nested;
    for (int k = 0; k < 400; ++k) {
        const float edge = 1.0F - 0.002F * static_cast<float>(k);
        const test::Mesh box = test::makeBox(vec3(-edge), vec3(edge));
        for (uint32_t i : box.indices) nested.indices.push_back(i + static_cast<uint32_t>(nested.positions.size()));
        nested.positions.insert(nested.positions.end(), box.positions.begin(), box.positions.end());
    }
    expectSame(device(), nested, test::gridAround(nested, 20), "nested boxes");
}

TEST_P(VoxelDevices, TestMeshes) {
    for (const std::filesystem::path& path : test::testMeshes()) {
        const test::Mesh mesh = test::readObj(path);
        expectSame(device(), mesh, test::gridAround(mesh, 37), path.stem());
    }
}

TEST_P(VoxelDevices, BitsThatWereSetStaySet) {
    const test::Mesh ball = test::makeSphere(vec3(0), 1.0F, 8);
    VoxelGrid grid = test::gridAround(ball, 16);
    std::fill(grid.bits.begin(), grid.bits.end(), uint8_t{0x11});
    const MeshView view = ball.view();
    VoxelGrid host = grid;
    voxelizeSurface(GridTriangles(std::span(&view, 1), host), host);
    ASSERT_TRUE(voxelizeSurface(device(), GridTriangles(std::span(&view, 1), grid), grid));
    EXPECT_EQ(grid.bits, host.bits);
    for (uint8_t byte : grid.bits) ASSERT_EQ(byte & 0x11U, 0x11U);
}

INSTANTIATE_TEST_SUITE_P(Devices, VoxelDevices, ::testing::Values("cpu1", "cpu2", "gl", "cl"),
                         [](const auto& p) { return std::string(p.param); });

}  // namespace
}  // namespace rivulet::voxel_devices_test
