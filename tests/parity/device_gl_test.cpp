// Device gl meets the contract of Device, tested with kernels of the test.
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/compute/kernel_source.h"
#include "engine/gpu/device_gl.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::device_gl_test {
namespace {

struct alignas(16) ScaleParams {
    uint32_t count;
    float factor;
    float padding[2] = {};
};

constexpr const char* kScale = R"(#include "shaders/common/lang.h"
STRUCT(ScaleParams) { uint count; float factor; float padA; float padB; };
#define ARGS(RO, RW) \
    RO(1, In, float, in_)  /* anything */ \
    RW(2, Out, float, out_)
BUFFERS(ScaleParams)
KERNEL(scale, ScaleParams) {
    uint i = THREAD_ID;
    if (i >= PARAMS.count) return;
    out_[i] = in_[i] * PARAMS.factor + TO_FLOAT(EXTRA);
}
)";

class DeviceGl : public GpuTest {
  protected:
    void SetUp() override {
        GpuTest::SetUp();
        if (HasFatalFailure()) return;
        writeFile("shaders/test/scale.kernel", kScale);
        device_ = makeGlDevice(ShaderFiles(root()), Log{[this](LogLevel, std::string_view text) { told_ += text; }});
    }
    void TearDown() override {
        device_.reset();
        GpuTest::TearDown();
        EXPECT_EQ(told_, "");
    }
    Buffer make(const std::vector<float>& items) {
        Result<Buffer> buffer = device_->allocate(items.size() * sizeof(float));
        EXPECT_TRUE(buffer);
        device_->writeAll(*buffer, std::span(items));
        return std::move(*buffer);
    }
    Kernel scale(std::vector<Define> defines = {{"EXTRA", "0"}}) {
        Result<Kernel> kernel = device_->kernel("test/scale", defines);
        EXPECT_TRUE(kernel) << kernel.error().message;
        return *kernel;
    }
    std::unique_ptr<Device> device_;
    std::string told_;
};

TEST_F(DeviceGl, InfoNamesTheDevice) {
    EXPECT_EQ(device_->backend(), Backend::gl);
    EXPECT_EQ(device_->info().name, context_->renderer());
    EXPECT_GE(device_->info().driver.substr(0, 3), "4.5");
    EXPECT_EQ(device_->info().software, context_->software());
    EXPECT_TRUE(isSoftwareRenderer("llvmpipe (LLVM 15.0.6, 256 bits)"));
    EXPECT_FALSE(isSoftwareRenderer("NVIDIA H200/PCIe/SSE2"));
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    EXPECT_EQ(device_->info().maxBufferBytes, static_cast<size_t>(most));
}

TEST_F(DeviceGl, RunsAKernelOverExactlyItsThreads) {
    std::vector<float> values(1000);
    for (size_t k = 0; k < values.size(); ++k) values[k] = static_cast<float>(k);
    const Buffer in = make(values), out = make(std::vector<float>(values.size(), -1));
    const Kernel kernel = scale({{"EXTRA", "3"}});
    device_->run(kernel, ScaleParams{777, 0.5F}, {&in, &out}, 777);
    const std::vector<float> got = device_->readAll<float>(out, values.size());
    for (size_t k = 0; k < 777; ++k) ASSERT_EQ(got[k], values[k] * 0.5F + 3);
    for (size_t k = 777; k < got.size(); ++k) ASSERT_EQ(got[k], -1.0F);
    device_->run(kernel, ScaleParams{777, 9.0F}, {&in, &out}, 0);
    EXPECT_EQ(device_->readAll<float>(out, 1)[0], 3.0F) << "no threads: nothing happens";
}

TEST_F(DeviceGl, TheSamePathAndDefinesAreTheSameKernel) {
    EXPECT_EQ(scale({{"EXTRA", "1"}, {"LOCAL_SIZE", "128"}}).index, scale({{"LOCAL_SIZE", "128"}, {"EXTRA", "1"}}).index);
    EXPECT_NE(scale({{"EXTRA", "1"}}).index, scale({{"EXTRA", "2"}}).index);
}

TEST_F(DeviceGl, DispatchesSeeWhatEarlierOnesDidEachWithItsOwnParameters) {
    Buffer a = make({1}), b = make({0});
    const Kernel kernel = scale();
    float expected = 1;
    // Large parameter blocks, enough to fill the device's pages several times.
    std::array<ScaleParams, 64> block{};
    for (int k = 0; k < 400; ++k) {
        block[0] = {1, k % 2 == 0 ? 2.0F : 0.5F + static_cast<float>(k) * 1.0e-6F};
        const Buffer* buffers[] = {&a, &b};
        device_->dispatch(kernel, std::as_bytes(std::span(block)), buffers, 1);
        a.swap(b);
        expected *= block[0].factor;
    }
    EXPECT_EQ(device_->readAll<float>(a, 1)[0], expected);
}

TEST_F(DeviceGl, MoreThreadsThanADispatchHoldsAreStillNumberedInOneRow) {
    const uint32_t count = 65535 * 64 + 1000;  // GL guarantees 65535 groups of 64
    Result<Buffer> in = device_->allocate(size_t{count} * 4), out = device_->allocate(size_t{count} * 4);
    ASSERT_TRUE(in && out);
    device_->fill(*in, 0x3F800000U);  // 1.0f
    device_->run(scale(), ScaleParams{count, 2.0F}, {&*in, &*out}, count);
    std::vector<float> got = device_->readAll<float>(*out, count);
    EXPECT_TRUE(std::all_of(got.begin(), got.end(), [](float v) { return v == 2.0F; }));
    device_->run(scale(), ScaleParams{10, 5.0F}, {&*in, &*out}, 10);
    got = device_->readAll<float>(*out, 11);
    EXPECT_EQ(got[0], 5.0F) << "the next dispatch counts from 0 again";
    EXPECT_EQ(got[10], 2.0F);
}

TEST_F(DeviceGl, AllocatesZeroesAndCountsBytes) {
    const size_t before = device_->bytesAllocated();
    {
        Result<Buffer> some = device_->allocate(1000), none = device_->allocate(0);
        ASSERT_TRUE(some && none);
        EXPECT_EQ(device_->bytesAllocated(), before + 1000);
        EXPECT_EQ(device_->readAll<uint8_t>(*some, 1000), std::vector<uint8_t>(1000, 0));
        EXPECT_TRUE(*none);
        EXPECT_EQ(none->bytes(), 0U);
        EXPECT_TRUE(glIsBuffer(static_cast<GLuint>(some->handle())));
        device_->fill(*none, 1);
        device_->write(*none, {});
    }
    EXPECT_EQ(device_->bytesAllocated(), before);
}

TEST_F(DeviceGl, CopiesFillsAndWritesInOrder) {
    Buffer a = make({1, 2, 3, 4}), b = make({0, 0, 0, 0});
    device_->copy(a, b, 8);
    device_->fill(a, 0);
    const float nine = 9;
    device_->write(b, std::as_bytes(std::span(&nine, 1)), 12);
    EXPECT_EQ(device_->readAll<float>(b, 4), (std::vector<float>{1, 2, 0, 9}));
    EXPECT_EQ(device_->readAll<float>(a, 4), (std::vector<float>{0, 0, 0, 0}));
}

// A GPU is many dispatches behind the host. Drivers exist in which glNamedBufferSubData overtakes them.
TEST_F(DeviceGl, WhatIsWrittenIsReadByTheNextDispatchAndByNoneBefore) {
    for (const uint32_t count : {1U, 20000U, 1500000U}) {
        Buffer in = make(std::vector<float>(count, -1.0F));
        std::vector<Buffer> out;
        const int rounds = count > 100000 ? 4 : 40;
        for (int k = 0; k < rounds; ++k) out.push_back(make(std::vector<float>(count, 0.0F)));
        for (int k = 0; k < rounds; ++k) {
            const std::vector<float> all(count, static_cast<float>(k));
            device_->writeAll<float>(in, all);
            device_->run(scale(), ScaleParams{count, 2.0F}, {&in, &out[static_cast<size_t>(k)]}, count);
        }
        for (int k = 0; k < rounds; ++k) {
            const std::vector<float> got = device_->readAll<float>(out[static_cast<size_t>(k)], count);
            EXPECT_TRUE(std::ranges::all_of(got, [&](float v) { return v == 2.0F * static_cast<float>(k); }))
                << count << " words, round " << k << ": " << got[0];
        }
    }
}

TEST_F(DeviceGl, ATooLargeBufferIsRefusedWithBothSizes) {
    const size_t most = device_->info().maxBufferBytes;
    const Result<Buffer> buffer = device_->allocate(most + 1);
    ASSERT_FALSE(buffer);
    EXPECT_NE(buffer.error().message.find(std::to_string(most)), std::string::npos) << buffer.error().message;
    EXPECT_NE(buffer.error().message.find(std::to_string(most + 1)), std::string::npos) << buffer.error().message;
    EXPECT_EQ(buffer.error().fault, Fault::failed);
    EXPECT_EQ(device_->bytesAllocated(), 0U);
}

TEST_F(DeviceGl, ReadLaterReadsFromAnOffset) {
    const Buffer b = make({1, 2, 3, 4});
    std::vector<float> got(2);
    device_->readLater(
        b, 8, [&](std::span<const std::byte> bytes) { std::memcpy(got.data(), bytes.data(), bytes.size()); }, 4);
    device_->finish();
    device_->poll();
    EXPECT_EQ(got, (std::vector<float>{2, 3}));
}

TEST_F(DeviceGl, ReadLaterHandsOverTheValueAsOfTheCall) {
    Buffer a = make({1});
    const Buffer b = make({0});
    const Kernel kernel = scale();
    std::vector<float> delivered;
    const auto keep = [&](std::span<const std::byte> bytes) {
        ASSERT_EQ(bytes.size(), sizeof(float));
        float value = 0;
        std::memcpy(&value, bytes.data(), sizeof value);
        delivered.push_back(value);
    };
    for (int k = 0; k < 10; ++k) {
        const auto value = static_cast<float>(k);
        device_->write(a, std::as_bytes(std::span(&value, 1)));
        device_->run(kernel, ScaleParams{1, 10.0F}, {&a, &b}, 1);
        device_->readLater(b, sizeof(float), keep);
        EXPECT_TRUE(delivered.empty()) << "only poll() delivers";
    }
    device_->run(kernel, ScaleParams{1, -1.0F}, {&a, &b}, 1);
    device_->finish();
    device_->poll();
    ASSERT_EQ(delivered.size(), 10U);
    for (int k = 0; k < 10; ++k) EXPECT_EQ(delivered[static_cast<size_t>(k)], 10.0F * static_cast<float>(k));
    bool again = false;
    device_->readLater(b, 0, [&](std::span<const std::byte> bytes) { again = bytes.empty(); });
    device_->finish();
    device_->poll();
    EXPECT_TRUE(again);
}

TEST_F(DeviceGl, TimesAreSummedByKernel) {
    const Buffer in = make(std::vector<float>(200000, 1)), out = make(std::vector<float>(200000, 1));
    const Kernel kernel = scale();
    EXPECT_TRUE(device_->takeTimes().empty());
    for (int k = 0; k < 3; ++k) device_->run(kernel, ScaleParams{200000, 2.0F}, {&in, &out}, 200000);
    device_->finish();
    const std::vector<PassTime> times = device_->takeTimes();
    ASSERT_EQ(times.size(), 1U);
    EXPECT_EQ(times[0].name, "test/scale");
    EXPECT_EQ(times[0].calls, 3);
    EXPECT_GT(times[0].ms, 0.0);
    EXPECT_LT(times[0].ms, 5000.0);
    EXPECT_TRUE(device_->takeTimes().empty());
}

TEST_F(DeviceGl, AKernelThatDoesNotCompileNamesFileAndLine) {
    const Result<Kernel> undefined = device_->kernel("test/scale", {});  // EXTRA is missing
    ASSERT_FALSE(undefined);
    EXPECT_NE(undefined.error().message.find("shaders/test/scale.kernel:10"), std::string::npos) << undefined.error().message;
    const Result<Kernel> missing = device_->kernel("test/nowhere");
    ASSERT_FALSE(missing);
    EXPECT_NE(missing.error().message.find("shaders/test/nowhere.kernel"), std::string::npos) << missing.error().message;
    const std::vector<Define> huge = {{"EXTRA", "0"}, {"LOCAL_SIZE", "100000"}};
    const Result<Kernel> tooWide = device_->kernel("test/scale", huge);
    ASSERT_FALSE(tooWide);
    EXPECT_NE(tooWide.error().message.find("100000"), std::string::npos) << tooWide.error().message;
}

TEST_F(DeviceGl, AThousandBuffersLeaveNothingBehind) {
    size_t before = 0;
    for (int k = 0; k < 1000; ++k) {
        if (k == 20) before = residentBytes();  // by now the driver has made its permanent allocations
        Result<Buffer> buffer = device_->allocate(size_t{1} << 20U);
        ASSERT_TRUE(buffer);
        const auto name = static_cast<GLuint>(buffer->handle());
        buffer = Buffer();
        EXPECT_FALSE(glIsBuffer(name));
    }
    EXPECT_EQ(device_->bytesAllocated(), 0U);
    EXPECT_LT(residentBytes(), before + (size_t{512} << 20U)) << "1 GB went through";
}

}  // namespace
}  // namespace rivulet::device_gl_test
