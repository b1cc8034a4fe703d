// The limits that OpenGL and OpenCL guarantee, set on devices that allow more: work groups of 64 to 1,024, few groups in a dispatch, 8
// storage buffers of a kernel, small buffers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/parity/devices.h"
#include "tests/races/small_worlds.h"

namespace rivulet::device_limits_test {
namespace {

races::Answer run(Device& device, std::string_view name) {
    const auto& all = races::smallWorlds();
    const auto world = std::ranges::find_if(all, [&](const auto& w) { return name == w.name; });
    EXPECT_NE(world, all.end());
    return world->run(device);
}

class DeviceLimits : public ::testing::TestWithParam<const char*> {
  protected:
    TestGpu open(const TestGpuOptions& options = {}) {
        Result<TestGpu> gpu = makeTestGpu(GetParam(), options);
        if (gpu) return std::move(*gpu);
        [&] { GTEST_SKIP() << gpu.error().message; }();
        return {};
    }
};

TEST_P(DeviceLimits, AWorldWithTooLargeBuffersIsRefusedInASentence) {
    constexpr size_t kMost = size_t{1} << 20U;
    TestGpuOptions options;
    options.gl.mostBufferBytes = options.cl.mostBufferBytes = kMost;
    const TestGpu gpu = open(options);
    if (IsSkipped()) return;
    EXPECT_EQ(gpu.device->info().maxBufferBytes, kMost);
    const Result<Buffer> buffer = gpu.device->allocate(kMost + 1);
    ASSERT_FALSE(buffer);
    EXPECT_NE(buffer.error().message.find("fewer particles or coarser voxels"), std::string::npos) << buffer.error().message;
    FluidParams p;
    p.spacing = 0.01F;
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.5F)}};
    const auto world = FluidWorld::create(*gpu.device, p, {}, {});
    ASSERT_FALSE(world) << "125,000 particles of 16 bytes";
    EXPECT_NE(world.error().message.find("fewer particles"), std::string::npos) << world.error().message;
}

INSTANTIATE_TEST_SUITE_P(Devices, DeviceLimits, ::testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

// So no kernel depends on how many of its work items run at once.
class WorkGroups : public ::testing::TestWithParam<races::WorldOn> {};
TEST_P(WorkGroups, OfAnySizeGiveTheSameResults) {
    const auto& [device, world] = GetParam();
    races::Answer plain;
    for (const uint32_t size : {64U, 128U, 1024U}) {
        if (size == 128 && !races::full()) continue;
        SCOPED_TRACE(size);
        TestGpuOptions options;
        options.gl.localSize = options.cl.localSize = size;
        const Result<TestGpu> gpu = makeTestGpu(device, options);
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        races::Answer answer = world->run(*gpu->device);
        ASSERT_GT(answer.exact.size() + answer.near.size(), 4U);
        if (size == 64)
            plain = std::move(answer);
        else
            races::expectSame(plain, answer);
    }
}
bool inOtherGroups(std::string_view device, std::string_view world) {
    return races::full() || (device == "gl" && (world == "dfsph" || world == "voxels"));
}
INSTANTIATE_TEST_SUITE_P(Worlds, WorkGroups, ::testing::ValuesIn(races::worldsOn({"gl", "cl"}, inOtherGroups)),
                         [](const auto& row) { return races::nameOf(row.param); });

TEST(DeviceLimitsGl, ADispatchInPiecesGivesTheSameResults) {
    std::vector<races::Answer> answers[2];
    for (const size_t pieces : {0U, 1U}) {
        const Result<TestGpu> gpu = makeTestGpu("gl", {.gl = {.mostGroups = pieces == 1 ? 2 : SIZE_MAX}});
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        for (const char* world : {"dfsph", "voxels", "linkedLists"}) answers[pieces].push_back(run(*gpu->device, world));
    }
    for (size_t k = 0; k < answers[0].size(); ++k) {
        EXPECT_EQ(answers[0][k].exact == answers[1][k].exact, true) << "world " << k;
        EXPECT_EQ(answers[0][k].near.size(), answers[1][k].near.size());
    }
}

// OpenGL guarantees 8 storage buffers, on bindings 0 to 7: all kernels get along with them.
TEST(DeviceLimitsGl, AllWorldsNeedEightStorageBuffersAtMost) {
    const Result<TestGpu> gpu = makeTestGpu("gl", {.gl = {.mostBindings = 8}});
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    for (const races::SmallWorld& world : races::smallWorlds())
        if (races::full() ||
            std::string_view("dfsph pbf wcsph foam wetness walls bodiesDfsph flow").find(world.name) != std::string_view::npos)
            world.run(*gpu->device);  // fails by itself if a kernel is refused
}

TEST(DeviceLimitsGl, AKernelOfMoreBuffersThanADeviceAllowsIsRefusedInASentence) {
    TestGpuOptions options{.gl = {.mostBindings = 8}};
    std::string rows, sum;
    for (int k = 1; k <= 9; ++k) {
        rows += fmt::format(" RW({0}, B{0}, float, b{0})", k);
        sum += fmt::format(" + b{}[0]", k);
    }
    options.files.add("shaders/greedy.kernel", fmt::format("#include \"shaders/common/lang.h\"\n"
                                                           "STRUCT(None) {{ vec4 none; }};\n#define ARGS(RO, RW){}\nBUFFERS(None)\n"
                                                           "// gpu only\nKERNEL(greedy, None)\n{{ b1[THREAD_ID] = 1.0f{}; }}\n",
                                                           rows, sum));
    const Result<TestGpu> gpu = makeTestGpu("gl", options);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const Result<Kernel> greedy = gpu->device->kernel("greedy");
    ASSERT_FALSE(greedy);
    EXPECT_NE(greedy.error().message.find("greedy.kernel needs 9 storage buffers, but "), std::string::npos) << greedy.error().message;
    EXPECT_NE(greedy.error().message.find("allows 8; try --backend cpu"), std::string::npos) << greedy.error().message;
}

}  // namespace
}  // namespace rivulet::device_limits_test
