// Mode depth gives the same bits and labels on cpu, gl and cl.
#include <gtest/gtest.h>

#include "fluid/voxel/voxelize_depth.h"
#include "tests/parity/devices.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_depth_devices_test {
namespace {

using test::Mesh;

DepthVoxels voxelize(Device& device, const Mesh& mesh, const ivec3& size, bool thesisOrder) {
    VoxelGrid grid{size, vec3(0), 1.0F, {}};
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    const MeshView view = mesh.view();
    Result<DepthVoxels> made = voxelizeDepth(device, std::span(&view, 1), grid, {thesisOrder, {}});
    EXPECT_TRUE(made) << made.error().message;
    return made ? std::move(*made) : DepthVoxels{};
}

// Scales the mesh so that its bounds are those of the grid.
Mesh stretched(Mesh mesh, const ivec3& size) {
    Bounds bounds;
    for (const vec3& p : mesh.positions) bounds.add(p);
    for (vec3& p : mesh.positions) p = glm::clamp((p - bounds.min) / bounds.size() * vec3(size), vec3(0), vec3(size));
    return mesh;
}

class VoxelDepthDevices : public testing::TestWithParam<const char*> {};

TEST_P(VoxelDepthDevices, GiveTheBitsOfTheCpu) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const auto cpu = makeTestCpu();
    struct Case {
        Mesh mesh;
        ivec3 size;
    };
    std::vector<Case> cases;
    for (unsigned seed = 1; seed <= 8; ++seed) cases.push_back({test::makeJumble(seed, 350), ivec3(41, 33, 27)});
    cases.push_back({test::makeSphere(vec3(0), 1.0F, 40), ivec3(96, 96, 96)});
    cases.push_back({test::makeBox(vec3(-1), vec3(1)), ivec3(64, 32, 16)});                      // faces between voxels
    cases.push_back({test::makeSheet(vec3(0), vec3(0.3F, 1, 0.2F), 1.0F), ivec3(700, 40, 90)});  // a triangle of many jobs
    cases.push_back({test::makeJumble(11, 70), ivec3(1, 1, 5)});
    for (size_t k = 0; k < cases.size(); ++k) {
        SCOPED_TRACE(k);
        const ivec3& size = cases[k].size;
        const Mesh mesh = stretched(cases[k].mesh, size);
        for (bool thesis : {false, true}) {
            if (thesis && size.x > 50) continue;
            const DepthVoxels here = voxelize(*cpu, mesh, size, thesis), there = voxelize(*gpu->device, mesh, size, thesis);
            EXPECT_GT(here.labels.surface, 0U);
            EXPECT_EQ(here.surface.bits, there.surface.bits);
            EXPECT_EQ(here.labels.rowStart, there.labels.rowStart);
            ASSERT_EQ(here.labels.runs.size(), there.labels.runs.size());
            size_t differ = 0;
            for (size_t r = 0; r < here.labels.runs.size(); ++r) differ += here.labels.runs[r].label != there.labels.runs[r].label ? 1 : 0;
            EXPECT_EQ(differ, 0U);
            EXPECT_EQ(here.boxes, there.boxes);
            EXPECT_EQ(here.pixels, there.pixels);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Gpu, VoxelDepthDevices, testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::voxel_depth_devices_test
