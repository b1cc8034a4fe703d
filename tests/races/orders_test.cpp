// Results do not depend on the order of work items and groups: on each device the small worlds come to the same in other orders, which also
// shows that no work item waits for another one of its dispatch.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/parity/devices.h"
#include "tests/races/orders.h"
#include "tests/races/small_worlds.h"

namespace rivulet::orders_test {
namespace {

using races::Order;
using Kind = races::Order::Kind;

bool isPermutation(std::vector<uint32_t> numbers) {
    std::ranges::sort(numbers);
    for (size_t k = 0; k < numbers.size(); ++k)
        if (numbers[k] != k) return false;
    return true;
}

// The formula that the shaders have too.
TEST(OrdersOfItems, AreEachAPermutationOfAnyNumber) {
    std::vector<Order> orders = {{Kind::backwards}, {Kind::interleaved}};
    for (const uint32_t seed : {0U, 1U, 2U, 3U, 12345U, 0x80000000U, UINT32_MAX}) orders.push_back({Kind::shuffled, seed});
    std::vector<uint32_t> counts(1100);
    std::iota(counts.begin(), counts.end(), 1U);
    counts.insert(counts.end(), {4095, 4096, 4097, 65535, 65537, 100000});
    for (const Order& order : orders) {
        SCOPED_TRACE(order.name());
        for (const uint32_t count : counts) {
            std::vector<uint32_t> items(count);
            for (uint32_t k = 0; k < count; ++k) items[k] = order.item(k, count);
            ASSERT_TRUE(isPermutation(items)) << count << " items";
        }
    }
}

// Of random permutations 1 neighbour in `count / 2` stays one, and 1 item keeps its place.
TEST(OrdersOfItems, AreShuffledDifferentlyByEachSeed) {
    for (const uint32_t count : {64U, 100U, 1024U}) {
        std::vector<std::vector<uint32_t>> seen;
        size_t kept = 0, neighbours = 0;
        for (uint32_t seed = 0; seed < 100; ++seed) {
            std::vector<uint32_t> items(count);
            for (uint32_t k = 0; k < count; ++k) {
                items[k] = Order{Kind::shuffled, seed}.item(k, count);
                kept += items[k] == k ? 1 : 0;
                if (k > 0) neighbours += items[k] - items[k - 1] + 1 <= 2 ? 1 : 0;
            }
            seen.push_back(std::move(items));
        }
        std::ranges::sort(seen);
        EXPECT_EQ(std::ranges::adjacent_find(seen), seen.end()) << "two seeds give the same order of " << count << " items";
        EXPECT_LT(kept, 4U * 100) << count;
        EXPECT_LT(neighbours, 10U * 100) << count;
    }
}

// A group's items stay together; groups have an order, and the items of each have one.
class OrdersOnGpus : public ::testing::TestWithParam<const char*> {};
TEST_P(OrdersOnGpus, RunEachItemOnce) {
    for (const Order& order : {Order{Kind::backwards}, Order{Kind::interleaved}, Order{Kind::shuffled, 1}, Order{Kind::shuffled, 2}}) {
        SCOPED_TRACE(order.name());
        Result<ShaderFiles> files = races::shadersIn(order);
        ASSERT_TRUE(files) << files.error().message;
        TestGpuOptions options;
        options.files = std::move(*files);
        options.files.add("shaders/numbers.kernel",
                          "#include \"shaders/common/lang.h\"\nSTRUCT(None) { vec4 none; };\n"
                          "#define ARGS(RO, RW) RW(1, Items, uint, items)\nBUFFERS(None)\n"
                          "#if defined(__OPENCL_C_VERSION__)\n#define BUILT_IN get_global_id(0)\n"
                          "#else\n#define BUILT_IN gl_GlobalInvocationID.x\n#endif\n"
                          "// gpu only\nKERNEL(numbers, None)\n{ items[BUILT_IN] = THREAD_ID; }\n");
        const Result<TestGpu> gpu = makeTestGpu(GetParam(), options);
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        const Result<Kernel> numbers = gpu->device->kernel("numbers");
        ASSERT_TRUE(numbers) << numbers.error().message;
        for (const uint32_t groups : {1U, 2U, 3U, 7U, 64U, 100U}) {
            SCOPED_TRACE(groups);
            constexpr uint32_t kSize = 64;  // of a group, by default
            const uint32_t count = groups * kSize;
            Buffer items = std::move(*gpu->device->allocate(count * sizeof(uint32_t)));
            gpu->device->run(*numbers, vec4(0.0F), {&items}, count);
            const std::vector<uint32_t> at = gpu->device->readAll<uint32_t>(items, count);
            EXPECT_TRUE(isPermutation(at));
            size_t kept = 0;
            for (uint32_t k = 0; k < count; ++k) {
                EXPECT_EQ(at[k] / kSize, order.item(k / kSize, groups)) << "the group of " << k;
                kept += at[k] == k ? 1 : 0;
            }
            EXPECT_LT(kept, count / 8);
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Devices, OrdersOnGpus, ::testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

class Orders : public ::testing::TestWithParam<races::WorldOn> {
  protected:
    // In that order; none: as they are numbered.
    static Result<TestGpu> open(const std::optional<Order>& order) {
        const std::string name = GetParam().device;
        if (name == "cpu") {
            TestGpu cpu;
            cpu.device = order ? races::cpuIn(*order) : makeTestCpu(1, Isa::generic);
            return cpu;
        }
        TestGpuOptions options;
        if (order) {
            Result<ShaderFiles> files = races::shadersIn(*order);
            if (!files) {
                ADD_FAILURE() << files.error().message;
                return files.error();
            }
            options.files = std::move(*files);
        }
        return makeTestGpu(name, options);
    }
};

// Without RIVULET_RACES=full: nearly all worlds on the cpu, some on a GPU, where each order compiles all kernels again.
bool inOtherOrders(std::string_view device, std::string_view world) {
    if (races::full()) return true;
    if (device == "cpu") return world != "sheet" && world != "rain";
    return world == "dfsph" || (device == "gl" && (world == "voxels" || world == "queries" || world == "bodiesTouch"));
}

TEST_P(Orders, GiveTheSameResults) {
    const auto& [device, world] = GetParam();
    const Result<uint32_t> seed = races::orderSeed();
    ASSERT_TRUE(seed) << seed.error().message;
    races::Answer answer;
    {
        Result<TestGpu> plain = open({});
        if (!plain) GTEST_SKIP() << plain.error().message;
        answer = world->run(*plain->device);
    }
    ASSERT_GT(answer.exact.size() + answer.near.size(), 4U);
    for (const Order& order : {Order{Kind::backwards}, Order{Kind::interleaved}, Order{Kind::shuffled, *seed}}) {
        // Each order costs a GPU seconds: what the interleaved one finds, the shuffled one nearly always finds too.
        if (order.kind == Kind::interleaved && !races::full() && device != std::string_view("cpu")) continue;
        SCOPED_TRACE(order.name());
        Result<TestGpu> other = open(order);
        ASSERT_TRUE(other) << other.error().message;
        races::expectSame(answer, world->run(*other->device));
    }
}
INSTANTIATE_TEST_SUITE_P(Worlds, Orders, ::testing::ValuesIn(races::worldsOn({"cpu", "gl", "cl"}, inOtherOrders)),
                         [](const auto& row) { return races::nameOf(row.param); });

// Nothing depends on what a compiler makes of NaN: not the water, and not a world in which one particle is NaN.
class NanHabits : public ::testing::TestWithParam<races::WorldOn> {};
TEST_P(NanHabits, GiveTheSameResults) {
    const auto& [device, world] = GetParam();
    races::Answer answer;
    {
        const Result<TestGpu> plain = makeTestGpu(device);
        if (!plain) GTEST_SKIP() << plain.error().message;
        answer = world->run(*plain->device);
    }
    for (const races::NanHabit habit : {races::NanHabit::second, races::NanHabit::spreads, races::NanHabit::inverts}) {
        SCOPED_TRACE(static_cast<int>(habit));
        Result<ShaderFiles> files = races::shadersWith(habit);
        ASSERT_TRUE(files) << files.error().message;
        TestGpuOptions options;
        options.files = std::move(*files);
        const Result<TestGpu> other = makeTestGpu(device, options);
        ASSERT_TRUE(other) << other.error().message;
        const races::Answer changed = world->run(*other->device);
        // Another min is another text, of which a compiler rounds a sum or two in another way.
        ASSERT_EQ(changed.exact.size(), answer.exact.size());
        for (size_t k = 0; k < answer.exact.size(); ++k) ASSERT_NEAR(answer.exact[k], changed.exact[k], 1.0e-5) << "value " << k;
        races::expectSame({{}, answer.near, answer.within}, {{}, changed.near});
    }
}
bool withOtherNan(std::string_view device, std::string_view world) {
    if (!races::full()) return device == "gl" && world == "lost";  // OpenCL compiles for minutes
    return world == "lost" || world == "walls" || world == "flow";
}
INSTANTIATE_TEST_SUITE_P(Worlds, NanHabits, ::testing::ValuesIn(races::worldsOn({"gl", "cl"}, withOtherNan)),
                         [](const auto& row) { return races::nameOf(row.param); });

}  // namespace
}  // namespace rivulet::orders_test
