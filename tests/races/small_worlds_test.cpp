// The small worlds on each device: what they run is counted. Under oclgrind (run.sh) races, reads out of bounds and uninitialised values
// are found.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <set>

#include "tests/parity/devices.h"
#include "tests/races/counting_device.h"
#include "tests/races/small_worlds.h"

namespace rivulet::small_worlds_test {
namespace {

// Not run by a small world. map_tiles is the cpu's form of map_quads; cell_of is the cpu's share of a step while OpenGL draws
// (fluid/session/cooperation.cpp), on a GPU device cell_count does the same; those of bench measure a device.
const std::set<std::string> kMissing = {"bench/rate_copy", "bench/rate_math", "flow/map_tiles", "fluid/grid/cell_of"};

size_t dispatchesOf(const CountingDevice& device) {
    size_t all = 0;
    for (const auto& [variant, count] : device.ran()) all += count.dispatches;
    return all;
}

class SmallWorlds : public ::testing::TestWithParam<const char*> {};

TEST_P(SmallWorlds, RunTheKernelsOfAGpu) {
    TestGpuOptions options;
    options.cl.cache = "";  // the key of the cache does not name oclgrind's options
    Result<TestGpu> gpu = makeTestGpu(GetParam(), options);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    CountingDevice device(*gpu->device);
    for (const races::SmallWorld& world : races::smallWorlds()) {
        if (!races::chosen(world)) continue;
        SCOPED_TRACE(world.name);
        std::printf("world %s\n", world.name);
        std::fflush(stdout);
        const size_t before = dispatchesOf(device);
        const races::Answer answer = world.run(device);
        EXPECT_GT(answer.exact.size() + answer.near.size(), 4U);
        EXPECT_GT(dispatchesOf(device), before);  // else it has no particles
    }
    EXPECT_EQ(gpu->device->health().state, DeviceHealth::works) << gpu->device->health().why;
    std::set<std::string> kernels;
    size_t dispatches = 0, items = 0;
    const auto ran = device.ran();
    for (const auto& [variant, count] : ran) {
        kernels.insert(variant.substr(0, variant.find(';')));
        dispatches += count.dispatches;
        items += count.items;
    }
    std::printf("%s: %zu kernels in %zu variants, %zu dispatches of %zu work items\n", gpu->device->info().name.c_str(), kernels.size(),
                ran.size(), dispatches, items);
    if (races::someChosen()) {
        for (const auto& [variant, count] : ran) std::printf("ran %s %zu %zu\n", variant.c_str(), count.dispatches, count.items);
        return;
    }
    const std::filesystem::path shaders = std::filesystem::path(RIVULET_SOURCE_DIR) / "shaders";
    for (const auto& file : std::filesystem::recursive_directory_iterator(shaders)) {
        if (file.path().extension() != ".kernel") continue;
        const std::string path = std::filesystem::relative(file.path(), shaders).replace_extension().string();
        EXPECT_NE(kernels.contains(path), kMissing.contains(path)) << path << " is run by no small world, or need no longer be in kMissing";
    }
}

// Minutes: only with RIVULET_RACES=full, as tests/races/run.sh sets it.
std::vector<const char*> devices() { return races::full() ? std::vector<const char*>{"gl", "cl"} : std::vector<const char*>(); }
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SmallWorlds);
INSTANTIATE_TEST_SUITE_P(Devices, SmallWorlds, ::testing::ValuesIn(devices()), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::small_worlds_test
