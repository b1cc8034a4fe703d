// The rates of a device, which are measured with buffers as large as it allows; and the comparison of one that is lost.
#include "fluid/validate/gpu_rates.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/app/context_egl.h"
#include "engine/compute/device_cl.h"
#include "engine/core/timeline.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/backend.h"
#include "fluid/validate/gpu_check.h"
#include "fluid/validate/gpu_series.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::gpu_rates_test {
namespace {

constexpr size_t kMiB = size_t{1} << 20U;

TEST(GpuRates, BuffersAreAsLargeAsADeviceAllowsAndAPowerOfTwo) {
    EXPECT_EQ(copiedElements(false, SIZE_MAX), 1U << 24U);
    EXPECT_EQ(copiedElements(false, 256 * kMiB), 1U << 24U);
    EXPECT_EQ(copiedElements(false, 256 * kMiB - 1), 1U << 23U);
    EXPECT_EQ(copiedElements(false, 128 * kMiB), 1U << 23U) << "what OpenGL guarantees";
    EXPECT_EQ(copiedElements(false, 16 * kMiB), 1U << 20U);
    EXPECT_EQ(copiedElements(false, kMiB), 1U << 16U);
    EXPECT_EQ(copiedElements(false, kMiB / 4), 1U << 14U);
    EXPECT_EQ(copiedElements(false, kMiB / 4 - 1), 0U) << "too small to measure";
    EXPECT_EQ(copiedElements(false, 0), 0U);
    EXPECT_EQ(copiedElements(true, SIZE_MAX), 1U << 22U);
    EXPECT_EQ(copiedElements(true, kMiB), 1U << 16U);
}

void expectMeasured(Device& device, double bytes) {
    const Result<std::optional<DeviceRates>> rates = measureRates(device);
    ASSERT_TRUE(rates) << rates.error().message;
    ASSERT_TRUE(*rates);
    const DeviceRates& r = **rates;
    EXPECT_EQ(r.copied, bytes);
    for (const double rate : {r.bandwidth, r.arithmetic, r.integer, r.special, r.loads, r.rounds, r.dispatchMs, r.seconds}) {
        EXPECT_GT(rate, 0);
        EXPECT_LT(rate, 1.0e15);
    }
    for (const double rate : {r.fragments, r.filtered, r.fetches}) EXPECT_EQ(rate > 0, device.backend() == Backend::gl);
    EXPECT_EQ(device.health().state, DeviceHealth::works) << device.health().why;
}

TEST(GpuRates, OfADeviceThatAllowsSmallBuffersAloneAreMeasured) {
    const Result<ContextEgl> context = ContextEgl::create();
    if (!context && testing::mayLackOpenGl()) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(context) << context.error().message;
    const std::unique_ptr<Device> device = makeGlDevice(ShaderFiles::developer(), {}, {.mostBufferBytes = kMiB});
    expectMeasured(*device, kMiB);
}

// There is memory for no buffer of 1 MiB, and for one of 1/2 MiB.
TEST(GpuRates, BuffersThatMemoryDoesNotSufficeForAreHalved) {
    const auto made = makeClDevice(ShaderFiles::developer(), {}, {.memoryLimit = kMiB - 1, .mostBufferBytes = kMiB});
    if (!made && testing::mayLackOpenGl()) GTEST_SKIP() << made.error().message;
    ASSERT_TRUE(made) << made.error().message;
    expectMeasured(**made, kMiB / 4);
}

TEST(GpuRates, WithoutMemoryTheErrorSaysSoAndTheDeviceGoesOn) {
    const auto made = makeClDevice(ShaderFiles::developer(), {}, {.memoryLimit = 1000});
    if (!made && testing::mayLackOpenGl()) GTEST_SKIP() << made.error().message;
    ASSERT_TRUE(made) << made.error().message;
    const Result<std::optional<DeviceRates>> rates = measureRates(**made);
    ASSERT_FALSE(rates);
    EXPECT_TRUE(rates.error().memory) << rates.error().message;
    EXPECT_EQ((*made)->health().state, DeviceHealth::works) << (*made)->health().why;

    const auto tiny = makeClDevice(ShaderFiles::developer(), {}, {.mostBufferBytes = 1000});
    ASSERT_TRUE(tiny) << tiny.error().message;
    const Result<std::optional<DeviceRates>> none = measureRates(**tiny);
    ASSERT_FALSE(none);
    EXPECT_TRUE(none.error().memory) << none.error().message;
    EXPECT_NE(none.error().message.find("allows buffers of 1000 bytes, but 262144 are needed"), std::string::npos) << none.error().message;
}

TEST(GpuRates, MeasuringEndsInTime) {
    const auto made = makeClDevice(ShaderFiles::developer());
    if (!made && testing::mayLackOpenGl()) GTEST_SKIP() << made.error().message;
    ASSERT_TRUE(made) << made.error().message;
    const double start = hostSeconds();
    const Result<std::optional<DeviceRates>> never = measureRates(**made, start);
    ASSERT_TRUE(never) << never.error().message;
    EXPECT_FALSE(*never);
    const Result<ExaminedGpu> gpu = examineGpu(**made, "some device", start);
    ASSERT_TRUE(gpu) << gpu.error().message;
    EXPECT_FALSE(gpu->measured);
    EXPECT_TRUE(gpu->from.empty()) << "no prediction without rates";
    EXPECT_TRUE((*made)->kernels().empty()) << "not even a kernel is compiled";
}

TEST(GpuRates, StepsAreMeasuredWithoutThemAndHaveNoPrediction) {
    const auto made = makeClDevice(ShaderFiles::developer());
    if (!made && testing::mayLackOpenGl()) GTEST_SKIP() << made.error().message;
    ASSERT_TRUE(made) << made.error().message;
    const Result<SceneFile> scene = loadScene("dam_break.json", {});
    ASSERT_TRUE(scene) << scene.error().message;
    const Result<SeriesRow> row = measureSeries(namedGpu(**made, "some device"), *scene, "pbf", 8, 0, nullptr);
    ASSERT_TRUE(row) << row.error().message;
    EXPECT_GT(row->stepMs, 0);
    EXPECT_EQ(row->predictedStepMs, 0);
    EXPECT_EQ(row->frameMs, 0);
    EXPECT_TRUE(row->predictedPasses.empty());
}

// Without rates a GPU has a model by its name, and no other.
TEST(GpuRates, WithoutThemAGpuIsPredictedByItsNameAlone) {
    const std::unique_ptr<Device> cpu = makeCpu();  // not software in the sense of a GPU's API
    ASSERT_FALSE(cpu->info().software);
    EXPECT_EQ(namedGpu(*cpu, "NVIDIA GeForce RTX 3060/PCIe/SSE2").from, "RTX 3060, by its name");
    EXPECT_EQ(namedGpu(*cpu, "NVIDIA GeForce RTX 3060/PCIe/SSE2").model.name, "RTX 3060");
    EXPECT_EQ(namedGpu(*cpu, "a GPU that is not in the table").from, "");
}

// Here because it needs a device that is lost; program_gpu_test.cpp has devices that differ, or that do not compile a kernel.
TEST(GpuCheck, ALostDeviceIsOneFindingAndTheRestIsLeftOut) {
    for (const bool late : {false, true}) {  // a dispatch is refused; or one is accepted, and its failure is found afterwards
        SCOPED_TRACE(late);
        ClOptions options;
        (late ? options.eventFailsAfter : options.failAfter) = 40;
        const auto made = makeClDevice(ShaderFiles::developer(), {}, options);
        if (!made && testing::mayLackOpenGl()) GTEST_SKIP() << made.error().message;
        ASSERT_TRUE(made) << made.error().message;
        std::vector<std::string> leftOut;
        const std::vector<GpuFinding> found = checkDevice(**made, *makeCpu(), 1.0e300, leftOut);
        ASSERT_EQ(found.size(), 1U) << "no differences of results that are none";
        EXPECT_FALSE(found[0].passed());
        EXPECT_EQ(found[0].what, "wcsph");
        EXPECT_NE(found[0].error, "");
        EXPECT_EQ(found[0].sentence(), "cl: wcsph: " + found[0].error);
        EXPECT_EQ(leftOut.size(), 5U);
        EXPECT_EQ((*made)->health().state, DeviceHealth::lost);
    }
}

}  // namespace
}  // namespace rivulet::gpu_rates_test
