// Results do not depend on the order of work items and groups: on each device the small worlds come to the same in other orders, which also
// shows that no work item waits for another one of its dispatch.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tests/parity/devices.h"
#include "tests/races/orders.h"
#include "tests/races/small_worlds.h"

namespace rivulet::orders_test {
namespace {

using races::Order;

size_t different(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return std::max(a.size(), b.size());
    size_t count = 0;
    for (size_t k = 0; k < a.size(); ++k) count += std::bit_cast<uint32_t>(a[k]) != std::bit_cast<uint32_t>(b[k]) ? 1 : 0;
    return count;
}

void expectSame(const races::Answer& plain, const races::Answer& other) {
    EXPECT_EQ(different(plain.exact, other.exact), 0U) << "of " << plain.exact.size() << " values";
    ASSERT_EQ(plain.near.size(), other.near.size());
    float largest = 0;
    for (const float v : plain.near) largest = std::max(largest, std::abs(v));
    for (size_t k = 0; k < plain.near.size(); ++k)
        EXPECT_NEAR(plain.near[k], other.near[k], plain.within * double{largest}) << "value " << k;
}

class Orders : public ::testing::TestWithParam<std::tuple<const char*, const char*>> {
  protected:
    // In that order; none: as they are numbered.
    Result<TestGpu> open(std::optional<Order> order) {
        const std::string name = std::get<0>(GetParam());
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

// Without RIVULET_RACES=full: all worlds on the cpu, some on a GPU, where each order compiles all kernels again.
bool isQuick(std::string_view device, std::string_view world) {
    if (device == "cpu") return world != "sheet" && world != "rain";
    return world == "dfsph" || (device == "gl" && (world == "voxels" || world == "queries"));
}

TEST_P(Orders, GiveTheSameResults) {
    if (!races::full() && !isQuick(std::get<0>(GetParam()), std::get<1>(GetParam()))) return;
    const auto& all = races::smallWorlds();
    const auto world = std::ranges::find_if(all, [](const auto& w) { return std::string_view(w.name) == std::get<1>(GetParam()); });
    ASSERT_NE(world, all.end());
    if (!world->onCpu && std::get<0>(GetParam()) == std::string_view("cpu")) GTEST_SKIP() << "the cpu has no such kernels";
    races::Answer answer;
    {
        Result<TestGpu> plain = open({});
        if (!plain) GTEST_SKIP() << plain.error().message;
        answer = world->run(*plain->device);
    }
    for (const Order order : {Order::backwards, Order::interleaved}) {
        SCOPED_TRACE(order == Order::backwards ? "backwards" : "interleaved");
        Result<TestGpu> other = open(order);
        ASSERT_TRUE(other) << other.error().message;
        expectSame(answer, world->run(*other->device));
    }
}

// Nothing depends on what a compiler makes of NaN: not the water, and not a world in which one particle is NaN.
class NanHabits : public ::testing::TestWithParam<const char*> {};
TEST_P(NanHabits, GiveTheSameResults) {
    if (!races::full() && GetParam() == std::string("cl")) return;  // which compiles each again, for minutes
    const auto& all = races::smallWorlds();
    for (const char* name : {"lost", "walls", "flow"}) {
        if (!races::full() && name != std::string("lost")) continue;
        SCOPED_TRACE(name);
        const auto world = std::ranges::find_if(all, [&](const auto& w) { return std::string_view(w.name) == name; });
        ASSERT_NE(world, all.end());
        races::Answer answer;
        {
            const Result<TestGpu> plain = makeTestGpu(GetParam());
            if (!plain) GTEST_SKIP() << plain.error().message;
            answer = world->run(*plain->device);
        }
        for (const races::NanHabit habit : {races::NanHabit::second, races::NanHabit::spreads, races::NanHabit::inverts}) {
            SCOPED_TRACE(static_cast<int>(habit));
            Result<ShaderFiles> files = races::shadersWith(habit);
            ASSERT_TRUE(files) << files.error().message;
            TestGpuOptions options;
            options.files = std::move(*files);
            const Result<TestGpu> other = makeTestGpu(GetParam(), options);
            ASSERT_TRUE(other) << other.error().message;
            const races::Answer changed = world->run(*other->device);
            // Another min is another text, of which a compiler rounds a sum or two in another way.
            ASSERT_EQ(changed.exact.size(), answer.exact.size());
            for (size_t k = 0; k < answer.exact.size(); ++k) ASSERT_NEAR(answer.exact[k], changed.exact[k], 1.0e-5) << "value " << k;
            expectSame({{}, answer.near, answer.within}, {{}, changed.near});
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Devices, NanHabits, ::testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

std::vector<const char*> names() {
    std::vector<const char*> all;
    for (const races::SmallWorld& world : races::smallWorlds()) all.push_back(world.name);
    return all;
}
INSTANTIATE_TEST_SUITE_P(Worlds, Orders, ::testing::Combine(::testing::Values("cpu", "gl", "cl"), ::testing::ValuesIn(names())),
                         [](const auto& row) { return std::string(std::get<0>(row.param)) + "_" + std::get<1>(row.param); });

}  // namespace
}  // namespace rivulet::orders_test
