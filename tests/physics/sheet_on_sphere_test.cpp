// Thesis 4.3.3: a sheet and a column fall onto a sphere voxelised at 128^3; no particle's centre is ever in a set voxel. Checked by brute
// force from the bits, in double, independently of the collision code.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/compute/device_cpu.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet::sheet_on_sphere_test {
namespace {

// Bit k of byte b is voxel 8 b + k, x fastest (see voxel_grid.h; read here from the bytes).
bool voxelIsSet(const VoxelGrid& grid, const vec4& p) {
    long cell[3];
    const long size[3] = {grid.size.x, grid.size.y, grid.size.z};
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = std::lround(std::floor((double{p[axis]} - double{grid.origin[axis]}) / double{grid.voxel}));
        if (cell[axis] < 0 || cell[axis] >= size[axis]) return false;
    }
    const long k = (cell[2] * size[1] + cell[1]) * size[0] + cell[0];
    return (grid.bits[static_cast<size_t>(k / 8)] & (1 << (k % 8))) != 0;
}

TEST(SheetOnSphere, NoCentreIsEverInASetVoxel) {
    Result<SceneFile> scene = loadScene(std::string(RIVULET_SOURCE_DIR) + "/assets/scenes/sheet_on_sphere.json", {});
    ASSERT_TRUE(scene) << scene.error().message;
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    auto session = Session::create(*scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    const VoxelGrid& grid = (*session)->field().surface;
    const uint32_t n = world.particles().count;
    ASSERT_EQ(n, 3072U);
    size_t set = 0;
    for (uint8_t byte : grid.bits) set += static_cast<size_t>(__builtin_popcount(byte));
    ASSERT_GT(set, 20000U) << "a sphere of 128 voxels has some pi 128^2 of them on its surface";

    const vec3 centre = vec3(0.5F, 0.28F, 0.5F);
    bool touched = false;
    for (int frame = 0; frame < 60; ++frame) {
        (*session)->step(1.0 / kFramesPerSecond, true);
        size_t inside = 0;
        for (const vec4& x : device->readAll<vec4>(*world.particles().position, n)) {
            inside += voxelIsSet(grid, x) ? 1 : 0;
            const float distance = glm::length(vec3(x) - centre);
            touched = touched || distance < 0.225F + world.params().spacing;
            inside += distance < 0.22F ? 1 : 0;  // and none is within the sphere
        }
        ASSERT_EQ(inside, 0U) << "frame " << frame;
    }
    EXPECT_TRUE(touched) << "the water reached the sphere";
    EXPECT_EQ(world.stats().lost, 0U);
}

}  // namespace
}  // namespace rivulet::sheet_on_sphere_test
