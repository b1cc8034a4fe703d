// Device cl on the OpenCL devices of this machine; and the error without one.
#include "engine/compute/device_cl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <thread>

namespace rivulet::device_cl_test {
namespace {

namespace fs = std::filesystem;

struct FactorParams {
    uint32_t count;
    float factor;
    float pad0, pad1;
};

constexpr const char* kScale = R"(#include "shaders/common/lang.h"
STRUCT(FactorParams) { uint count; float factor; float pad0; float pad1; };
#undef ARGS
#define ARGS(RO, RW) \
    RO(1, In, float, in_) \
    RW(2, Out, float, out_)
BUFFERS(FactorParams)
KERNEL(scale, FactorParams)
{
    uint i = THREAD_ID;
    if (i >= PARAMS.count) return;
    out_[i] = in_[i] * PARAMS.factor + TO_FLOAT(OFFSET);
}
)";

class ClDeviceTest : public testing::Test {
  protected:
    void SetUp() override {
        root_ = fs::temp_directory_path() / (std::string("rivulet_cl_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(root_ / "shaders/test");
        file("scale", kScale);
        Result<std::unique_ptr<Device>> made =
            makeClDevice(ShaderFiles(root_.string()), Log{[this](LogLevel, std::string_view text) { said_ += text; }});
        if (!made) GTEST_SKIP() << made.error().message;
        device_ = std::move(*made);
    }
    void TearDown() override {
        EXPECT_EQ(said_, "");
        if (device_) {
            EXPECT_EQ(device_->bytesAllocated(), 0U) << "every Buffer gives its memory back";
        }
        device_.reset();
        std::error_code ignored;
        fs::remove_all(root_, ignored);
    }
    void file(const std::string& name, const std::string& text) const {
        std::ofstream(root_ / "shaders/test" / (name + ".kernel")) << text;
    }
    Kernel scaleBy(const char* offset) {
        const Define defines[] = {{"OFFSET", offset}};
        const auto kernel = device_->kernel("test/scale", defines);
        EXPECT_TRUE(kernel) << (kernel ? "" : kernel.error().message);
        return kernel ? *kernel : Kernel{};
    }
    Buffer floats(const std::vector<float>& values) {
        Buffer buffer = std::move(*device_->allocate(values.size() * sizeof(float)));
        device_->writeAll(buffer, std::span<const float>(values));
        return buffer;
    }
    fs::path root_;
    std::string said_;
    std::unique_ptr<Device> device_;
};

TEST_F(ClDeviceTest, infoNamesTheDevice) {
    EXPECT_EQ(device_->backend(), Backend::cl);
    EXPECT_FALSE(device_->info().name.empty());
    EXPECT_NE(device_->info().driver.find("OpenCL"), std::string::npos);
    EXPECT_GE(device_->info().maxBufferBytes, size_t{64} << 20U);
    const std::vector<ClDeviceListing> all = listClDevices();
    ASSERT_FALSE(all.empty());
    EXPECT_NE(all[0].sentence.find(device_->info().name), std::string::npos);
}

TEST_F(ClDeviceTest, memoryIsZeroAndHoldsWhatIsWritten) {
    Buffer buffer = std::move(*device_->allocate(40));
    EXPECT_EQ(buffer.bytes(), 40U);
    EXPECT_EQ(device_->bytesAllocated(), 40U);
    EXPECT_EQ(device_->readAll<uint32_t>(buffer, 10), std::vector<uint32_t>(10, 0));
    const uint32_t words[] = {1, 2, 3};
    device_->write(buffer, std::as_bytes(std::span(words)), 8);
    EXPECT_EQ(device_->readAll<uint32_t>(buffer, 6), (std::vector<uint32_t>{0, 0, 1, 2, 3, 0}));
    uint32_t one = 0;
    device_->read(buffer, std::as_writable_bytes(std::span(&one, 1)), 12);
    EXPECT_EQ(one, 2U);
    Buffer other = std::move(*device_->allocate(20));
    device_->fill(other, 0xA5A5A5A5U);
    device_->copy(other, buffer, 12);
    EXPECT_EQ(device_->readAll<uint32_t>(buffer, 4), (std::vector<uint32_t>{0xA5A5A5A5U, 0xA5A5A5A5U, 0xA5A5A5A5U, 2}));
}

TEST_F(ClDeviceTest, emptyBuffersAndEmptyWorkAreNoErrors) {
    const auto made = device_->allocate(0);
    ASSERT_TRUE(made);
    Buffer none = std::move(*device_->allocate(0));
    EXPECT_TRUE(static_cast<bool>(none));
    EXPECT_EQ(none.bytes(), 0U);
    device_->fill(none, 7);
    device_->write(none, {});
    EXPECT_TRUE(device_->readAll<float>(none, 0).empty());
    Buffer some = floats({1});
    device_->copy(none, some, 0);
    device_->run(scaleBy("0"), FactorParams{0, 2, 0, 0}, {&none, &none}, 0);
    bool called = false;
    device_->readLater(none, 0, [&](std::span<const std::byte> bytes) { called = bytes.empty(); });
    device_->finish();
    device_->poll();
    EXPECT_TRUE(called);
}

TEST_F(ClDeviceTest, tooLargeABufferIsAnErrorWithSizes) {
    const auto made = device_->allocate(device_->info().maxBufferBytes + 1);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().fault, Fault::failed);
    EXPECT_NE(made.error().message.find(std::to_string(device_->info().maxBufferBytes >> 20U) + " MiB"), std::string::npos)
        << made.error().message;
    EXPECT_EQ(device_->bytesAllocated(), 0U);
}

TEST_F(ClDeviceTest, samePathAndDefinesGiveTheSameKernel) {
    const Define ab[] = {{"OFFSET", "1"}, {"UNUSED", "2"}};
    const Define ba[] = {{"UNUSED", "2"}, {"OFFSET", "1"}};
    EXPECT_EQ(device_->kernel("test/scale", ab)->index, device_->kernel("test/scale", ba)->index);
    EXPECT_EQ(scaleBy("1").index, scaleBy("1").index);
    EXPECT_NE(scaleBy("1").index, scaleBy("2").index);
}

TEST_F(ClDeviceTest, dispatchesSeeWhatCameBeforeAndTheirOwnParameters) {
    // More parameter blocks than the device caches, a thread count that is no multiple of the work group, and no wait between dispatches.
    const uint32_t count = 1001;
    std::vector<float> expected(count);
    std::iota(expected.begin(), expected.end(), 0.0F);
    Buffer a = floats(expected), b = std::move(*device_->allocate(count * sizeof(float)));
    const Kernel plusOne = scaleBy("1"), plusTwo = scaleBy("2");
    for (int k = 0; k < 200; ++k) {
        const float factor = 1.0F + 0.0001F * static_cast<float>(k % 77);
        const FactorParams params{count - (k == 100 ? 500 : 0), factor, 0, 0};
        device_->run(k % 2 ? plusOne : plusTwo, params, {&a, &b}, count);
        std::swap(a, b);
        if (k % 50 == 0) {
            const std::vector<float> some(10, static_cast<float>(k));
            device_->writeAll(a, std::span<const float>(some));
        }
    }
    // The same, in order, on the host. Where the kernel stopped early (k = 100) the other buffer's older values stay.
    std::vector<float> x(count), y(count, 0.0F);
    std::iota(x.begin(), x.end(), 0.0F);
    for (int k = 0; k < 200; ++k) {
        const float factor = 1.0F + 0.0001F * static_cast<float>(k % 77);
        for (uint32_t i = 0; i < count - (k == 100 ? 500 : 0); ++i) y[i] = x[i] * factor + (k % 2 ? 1.0F : 2.0F);
        std::swap(x, y);
        if (k % 50 == 0) std::fill(x.begin(), x.begin() + 10, static_cast<float>(k));
    }
    const std::vector<float> got = device_->readAll<float>(a, count);
    for (uint32_t i = 0; i < count; ++i) ASSERT_NEAR(got[i], x[i], 1.0e-4F * std::abs(x[i])) << i;  // OpenCL may fuse the two operations
}

TEST_F(ClDeviceTest, threadsBeyondTheCountWriteNothing) {
    Buffer in = floats(std::vector<float>(70, 1.0F)), out = floats(std::vector<float>(128, -1.0F));
    device_->run(scaleBy("0"), FactorParams{70, 3, 0, 0}, {&in, &out}, 70);
    const std::vector<float> got = device_->readAll<float>(out, 128);
    for (uint32_t i = 0; i < 128; ++i) EXPECT_EQ(got[i], i < 70 ? 3.0F : -1.0F) << i;
}

TEST_F(ClDeviceTest, readLaterDeliversTheValuesOfItsTimeInOrder) {
    Buffer in = floats({1, 2, 3}), out = std::move(*device_->allocate(12));
    std::vector<float> delivered;
    for (int k = 1; k <= 5; ++k) {
        device_->run(scaleBy("0"), FactorParams{3, static_cast<float>(k), 0, 0}, {&in, &out}, 3);
        device_->readLater(out, 8, [&](std::span<const std::byte> bytes) {
            ASSERT_EQ(bytes.size(), 8U);
            float two[2];
            std::memcpy(two, bytes.data(), 8);
            delivered.push_back(two[1]);
            if (delivered.size() == 1) device_->readLater(out, 4, [&](std::span<const std::byte>) { delivered.push_back(-1); });
        });
        EXPECT_TRUE(delivered.empty()) << "only poll() delivers";
    }
    device_->finish();
    EXPECT_TRUE(delivered.empty()) << "only poll() delivers";
    device_->poll();
    EXPECT_EQ(delivered, (std::vector<float>{2, 4, 6, 8, 10}));
    device_->finish();
    device_->poll();
    EXPECT_EQ(delivered.size(), 6U);
    device_->readLater(out, 4, [&](std::span<const std::byte>) { ADD_FAILURE() << "a device that ends delivers nothing"; });
}

TEST_F(ClDeviceTest, readLaterReadsFromAnOffset) {
    const Buffer b = floats({1, 2, 3, 4});
    std::vector<float> got(2);
    device_->readLater(
        b, 8, [&](std::span<const std::byte> bytes) { std::memcpy(got.data(), bytes.data(), bytes.size()); }, 4);
    device_->finish();
    device_->poll();
    EXPECT_EQ(got, (std::vector<float>{2, 3}));
}

TEST_F(ClDeviceTest, timesAreSummedByKernelOnce) {
    Buffer in = floats(std::vector<float>(100000, 1.0F)), out = std::move(*device_->allocate(400000));
    for (int k = 0; k < 3; ++k) device_->run(scaleBy("0"), FactorParams{100000, 2, 0, 0}, {&in, &out}, 100000);
    device_->finish();
    const std::vector<PassTime> times = device_->takeTimes();
    ASSERT_EQ(times.size(), 1U);
    EXPECT_EQ(times[0].name, "test/scale");
    EXPECT_EQ(times[0].calls, 3);
    EXPECT_GT(times[0].ms, 0);
    EXPECT_TRUE(device_->takeTimes().empty());
}

TEST_F(ClDeviceTest, compileErrorsNameTheFileAndLineTheyComeFrom) {
    std::ofstream(root_ / "shaders/test/part.h") << "// one\nFN float broken(float x) { return x + undeclared; }\n";
    file("bad",
         "#include \"shaders/common/lang.h\"\nSTRUCT(P) { vec4 a; };\n#undef ARGS\n#define ARGS(RO, RW) RW(1, Out, float, "
         "out_)\nBUFFERS(P)\n"
         "#include \"shaders/test/part.h\"\nKERNEL(bad, P)\n{\n    out_[0] = broken(1.0f);\n}\n");
    const auto kernel = device_->kernel("test/bad");
    ASSERT_FALSE(kernel);
    EXPECT_NE(kernel.error().message.find("shaders/test/part.h:2"), std::string::npos) << kernel.error().message;
    EXPECT_NE(kernel.error().message.find("undeclared"), std::string::npos) << kernel.error().message;

    file("other", std::string(kScale));
    const Define offset[] = {{"OFFSET", "0"}};
    const auto misnamed = device_->kernel("test/other", offset);
    ASSERT_FALSE(misnamed);
    EXPECT_NE(misnamed.error().message.find("KERNEL(other"), std::string::npos) << misnamed.error().message;
    EXPECT_FALSE(device_->kernel("test/none"));
}

// A cached program of an earlier start runs as built; one whose source has changed is not used.
TEST_F(ClDeviceTest, aCachedProgramBehavesAsItsSource) {
    const std::string cache = (root_ / "cache").string();
    const auto scaled = [&](const char* offset) {
        Result<std::unique_ptr<Device>> made = makeClDevice(ShaderFiles(root_.string()), {}, {.cache = cache});
        EXPECT_TRUE(made);
        const Define defines[] = {{"OFFSET", offset}};
        Buffer in = std::move(*(*made)->allocate(12)), out = std::move(*(*made)->allocate(12));
        const float values[] = {1, 2, 3};
        (*made)->writeAll(in, std::span<const float>(values));
        const auto kernel = (*made)->kernel("test/scale", defines);
        EXPECT_TRUE(kernel) << (kernel ? "" : kernel.error().message);
        (*made)->run(*kernel, FactorParams{3, 2, 0, 0}, {&in, &out}, 3);
        return (*made)->readAll<float>(out, 3);
    };
    const auto files = [&] { return std::distance(fs::directory_iterator(cache), fs::directory_iterator()); };
    for (int start = 0; start < 2; ++start) {
        EXPECT_EQ(scaled("1"), (std::vector<float>{3, 5, 7}));
        EXPECT_EQ(scaled("2"), (std::vector<float>{4, 6, 8}));
        EXPECT_EQ(files(), 2) << "one for each set of defines, found by the second start";
    }
    std::string other = kScale;
    other.replace(other.find("* PARAMS.factor"), 1, "-");
    file("scale", other);
    EXPECT_EQ(scaled("1"), (std::vector<float>{0, 1, 2}));
    EXPECT_EQ(files(), 3);
    // A complete file with this key, but its content is not a program: the driver rejects it, and it is replaced.
    std::string key;
    for (const auto& entry : fs::directory_iterator(cache)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(stream), {}};
        uint64_t length = 0;
        std::memcpy(&length, text.data() + 8, sizeof length);
        const std::string one = text.substr(32, length);
        if (one.find("in_[i] - PARAMS.factor") != std::string::npos) key = one;
    }
    ASSERT_FALSE(key.empty());
    const std::string junk = "this is no program";
    DiskCache(cache).keep(key, std::as_bytes(std::span(junk)));
    EXPECT_EQ(scaled("1"), (std::vector<float>{0, 1, 2}));
    ASSERT_TRUE(DiskCache(cache).find(key));
    EXPECT_GT(DiskCache(cache).find(key)->size(), junk.size());
    // An error in the source is reported with file and line, independent of the cache.
    file("scale", std::string(kScale) + "\n\nnonsense\n");
    Result<std::unique_ptr<Device>> made = makeClDevice(ShaderFiles(root_.string()), {}, {.cache = cache});
    const Define defines[] = {{"OFFSET", "1"}};
    const auto wrong = (*made)->kernel("test/scale", defines);
    ASSERT_FALSE(wrong);
    EXPECT_NE(wrong.error().message.find("shaders/test/scale.kernel:16"), std::string::npos) << wrong.error().message;
    EXPECT_EQ(files(), 3);
}

TEST_F(ClDeviceTest, aLogIsNoLongerThanAScreenAndHasNoWarnings) {
    std::string text =
        "#include \"shaders/common/lang.h\"\nSTRUCT(P) { vec4 a; };\n#undef ARGS\n#define ARGS(RO, RW) RW(1, Out, float, out_)\n"
        "BUFFERS(P)\nKERNEL(many, P)\n{\n    int x = 1.5f == 1.5f ? \"text\" : 2;\n";
    for (int k = 0; k < 15; ++k) text += "    out_[0] = missing" + std::to_string(k) + ";\n";
    file("many", text + "}\n");
    const auto kernel = device_->kernel("test/many");
    ASSERT_FALSE(kernel);
    const std::string& said = kernel.error().message;
    EXPECT_NE(said.find("shaders/test/many.kernel:9"), std::string::npos) << said;
    EXPECT_EQ(said.find("warning:"), std::string::npos) << said;
    EXPECT_LE(std::count(said.begin(), said.end(), '\n'), 42) << said;
}

// A failed allocation is reported, and the device keeps working. After a refused dispatch the device is lost for good.
TEST_F(ClDeviceTest, healthReportsTheFailedCommand) {
    EXPECT_EQ(device_->health().state, DeviceHealth::works);
    Result<std::unique_ptr<Device>> small = makeClDevice(ShaderFiles(root_.string()), {}, {.memoryLimit = 100});
    ASSERT_TRUE(small);
    {
        Buffer fits = std::move(*(*small)->allocate(64));
        EXPECT_EQ((*small)->health().state, DeviceHealth::works);
        EXPECT_FALSE((*small)->allocate(64));
        EXPECT_EQ((*small)->health().state, DeviceHealth::full);
        (*small)->fill(fits, 7);
        EXPECT_EQ((*small)->readAll<uint32_t>(fits, 16), std::vector<uint32_t>(16, 7));
        EXPECT_EQ((*small)->health().state, DeviceHealth::full);
    }
    std::vector<std::string> said;
    Result<std::unique_ptr<Device>> doomed =
        makeClDevice(ShaderFiles(root_.string()), {[&](LogLevel, std::string_view text) { said.emplace_back(text); }}, {.failAfter = 2});
    ASSERT_TRUE(doomed);
    {
        const Define offset[] = {{"OFFSET", "0"}};
        const Kernel scale = *(*doomed)->kernel("test/scale", offset);
        Buffer in = std::move(*(*doomed)->allocate(12)), out = std::move(*(*doomed)->allocate(12));
        for (int k = 0; k < 2; ++k) (*doomed)->run(scale, FactorParams{3, 2, 0, 0}, {&in, &out}, 3);
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::works);
        for (int k = 0; k < 5; ++k) (*doomed)->run(scale, FactorParams{3, 2, 0, 0}, {&in, &out}, 3);
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::lost);
        EXPECT_NE((*doomed)->health().why.find("test/scale"), std::string::npos) << (*doomed)->health().why;
        (void)(*doomed)->readAll<float>(out, 3);
        (*doomed)->finish();
        (*doomed)->poll();
        EXPECT_FALSE((*doomed)->allocate(12));
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::lost);
        EXPECT_EQ(said.size(), 1U);
    }
    EXPECT_EQ((*doomed)->bytesAllocated(), 0U);
}

// A dispatch that fails while it runs is reported later, through its event: once, with the kernel's name.
TEST_F(ClDeviceTest, anEventThatFailsIsALostDevice) {
    std::vector<std::string> said;
    Result<std::unique_ptr<Device>> doomed = makeClDevice(
        ShaderFiles(root_.string()), {[&](LogLevel, std::string_view text) { said.emplace_back(text); }}, {.eventFailsAfter = 2});
    ASSERT_TRUE(doomed);
    const Define offset[] = {{"OFFSET", "0"}};
    const Kernel scale = *(*doomed)->kernel("test/scale", offset);
    std::vector<PassSpan> spans;
    (*doomed)->onSpan([&](const PassSpan& span) { spans.push_back(span); });
    {
        Buffer in = std::move(*(*doomed)->allocate(12)), out = std::move(*(*doomed)->allocate(12));
        for (int k = 0; k < 2; ++k) (*doomed)->run(scale, FactorParams{3, 2, 0, 0}, {&in, &out}, 3);
        (*doomed)->finish();
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::works);
        for (int k = 0; k < 3; ++k) (*doomed)->run(scale, FactorParams{3, 2, 0, 0}, {&in, &out}, 3);
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::works) << "nobody has heard of it";
        (*doomed)->finish();
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::lost);
        EXPECT_EQ((*doomed)->health().why, "could not run test/scale: CL_OUT_OF_RESOURCES");
        (*doomed)->forgiveFull();
        EXPECT_EQ((*doomed)->health().state, DeviceHealth::lost) << "only what was too large can be let go of";
        (*doomed)->poll();
        EXPECT_EQ(said.size(), 1U);
        ASSERT_EQ((*doomed)->takeTimes().size(), 1U);
        EXPECT_EQ(spans.size(), 4U) << "what failed took no time";
    }
}

// A span lies between the host's times before and after the dispatch, also a second later, because the clocks are synchronised again.
TEST_F(ClDeviceTest, spansAreOnTheHostsClock) {
    Buffer in = floats(std::vector<float>(1000, 1.0F)), out = std::move(*device_->allocate(4000));
    std::vector<PassSpan> spans;
    device_->onSpan([&](const PassSpan& span) { spans.push_back(span); });
    const Kernel scale = scaleBy("0");
    double last = hostSeconds();
    for (int k = 0; k < 5; ++k) {
        const double before = hostSeconds();
        device_->run(scale, FactorParams{1000, 2, 0, 0}, {&in, &out}, 1000);
        device_->finish();
        const double after = hostSeconds();
        ASSERT_EQ(spans.size(), static_cast<size_t>(k) + 1);
        constexpr double kClock = 0.005;  // s, between a write's end and the host that waits for it
        EXPECT_GT(spans.back().begin, before - kClock);
        EXPECT_LT(spans.back().end, after + kClock);
        EXPECT_GE(spans.back().end, spans.back().begin);
        EXPECT_GT(spans.back().begin, last - kClock) << "in order";
        last = spans.back().end;
        std::this_thread::sleep_for(std::chrono::milliseconds(600));
    }
}

TEST_F(ClDeviceTest, aDeviceIsFoundByNumberOrByAPartOfAName) {
    const ClDeviceListing first = listClDevices()[0];
    for (const std::string& text : {std::string(), std::string("1"), first.name, first.platform}) {
        EXPECT_TRUE(checkClDevice(text)) << text;
        const auto made = makeClDevice(ShaderFiles::developer(), {}, {.device = text});
        ASSERT_TRUE(made) << text;
        EXPECT_EQ((*made)->info().name, first.name);
    }
    const auto none = makeClDevice(ShaderFiles::developer(), {}, {.device = "no such device"});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().fault, Fault::badInput);
    EXPECT_NE(none.error().message.find("1 " + first.name), std::string::npos) << none.error().message;
    EXPECT_FALSE(checkClDevice("no such device"));
}

TEST_F(ClDeviceTest, workGroupsLargerThanTheDeviceAllowsAreRefused) {
    const Define defines[] = {{"LOCAL_SIZE", "65536"}, {"OFFSET", "0"}};
    EXPECT_FALSE(device_->kernel("test/scale", defines));
}

TEST_F(ClDeviceTest, aDispatchThatDoesNotFitItsKernelIsAProgrammersMistake) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const Kernel scale = scaleBy("0");
    const Buffer one = floats({1});
    EXPECT_DEATH(device_->run(scale, FactorParams{}, {&one}, 1), "pass a buffer for every row");
    EXPECT_DEATH(device_->run(Kernel{}, FactorParams{}, {&one, &one}, 1), "get the kernel from this device");
}

// Each in a process of its own: the OpenCL loader looks for drivers once.
TEST(ClDeviceDeathTest, withoutADriverAMessageSaysSo) {
    testing::FLAGS_gtest_death_test_style = "threadsafe";
    const fs::path folder = fs::temp_directory_path() / "rivulet_no_opencl";
    fs::create_directories(folder / "empty");
    fs::create_directories(folder / "broken");
    std::ofstream(folder / "broken/gone.icd") << "/nowhere/libgone.so\n";
    std::ofstream(folder / "broken/odd.icd") << "libm.so.6\n";  // a library that is not a driver
    std::ofstream(folder / "broken/blank.icd") << "";
    for (const char* name : {"empty", "broken", "missing"})
        EXPECT_EXIT(
            {
                setenv("OCL_ICD_VENDORS", (folder / name).c_str(), 1);
                const auto made = makeClDevice(ShaderFiles::developer());
                std::fprintf(stderr, "%s", made ? "a device" : made.error().message.c_str());
                std::exit(!made && made.error().fault == Fault::failed && listClDevices().empty() ? 0 : 1);
            },
            testing::ExitedWithCode(0), "no working OpenCL driver.*--backend cpu")
            << name;
    fs::remove_all(folder);
}

}  // namespace
}  // namespace rivulet::device_cl_test
