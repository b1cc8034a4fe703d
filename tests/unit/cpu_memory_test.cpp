// Memory of the device cpu: buffers begin with zeros, wherever their memory was before; vectors in large pages are vectors.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/compute/device_cpu.h"
#include "engine/core/large_pages.h"

namespace rivulet {
namespace {

Buffer allocated(CpuDevice& device, size_t bytes) {
    Result<Buffer> made = device.allocate(bytes);
    EXPECT_TRUE(made);
    return made ? std::move(*made) : Buffer();
}

bool allZero(CpuDevice& device, const Buffer& buffer) {
    const std::vector<uint32_t> words = device.readAll<uint32_t>(buffer, buffer.bytes() / sizeof(uint32_t));
    return std::all_of(words.begin(), words.end(), [](uint32_t word) { return word == 0; });
}

TEST(CpuMemory, KeptMemoryIsUsedAgainAndBeginsWithZeros) {
    const std::unique_ptr<CpuDevice> device = makeCpuDevice({}, {.threads = 1});
    device->keepReleased();
    Buffer first = allocated(*device, 1 << 20), other = allocated(*device, 64);
    device->fill(first, 0xABCDEF01U);
    device->fill(other, 7);
    const uint64_t at = first.handle();
    first = Buffer();
    EXPECT_EQ(device->bytesAllocated(), 64U);
    const Buffer smaller = allocated(*device, 700'000), none = allocated(*device, 2 << 20);
    EXPECT_EQ(smaller.handle(), at);
    EXPECT_NE(none.handle(), at);
    EXPECT_EQ(smaller.bytes(), 700'000U);
    EXPECT_TRUE(allZero(*device, smaller));
    EXPECT_TRUE(allZero(*device, none));
    EXPECT_EQ(device->bytesAllocated(), 64U + 700'000U + (2U << 20U));
    EXPECT_FALSE(allZero(*device, other));
}

TEST(CpuMemory, LargeBuffersAreZeroFromTheirFirstToTheirLastByte) {
    const std::unique_ptr<CpuDevice> device = makeCpuDevice({}, {.threads = 1});
    for (int turn = 0; turn < 3; ++turn) {
        Buffer large = allocated(*device, 9'000'004);
        EXPECT_EQ(large.handle() % 64, 0U);
        EXPECT_TRUE(allZero(*device, large));
        device->fill(large, ~0U);
    }
}

TEST(CpuMemory, VectorsInLargePagesHoldWhatVectorsHold) {
    std::vector<double> v = {1, 2, 3};
    reserveLarge(v, 2'000'000);
    EXPECT_GE(v.capacity(), 2'000'000U);
    EXPECT_EQ(v, (std::vector<double>{1, 2, 3}));
    reserveLarge(v, 10);
    EXPECT_GE(v.capacity(), 2'000'000U);
    EXPECT_EQ(largeVector<int>(3'000'000), std::vector<int>(3'000'000));
    EXPECT_TRUE(largeVector<int>(0).empty());
}

}  // namespace
}  // namespace rivulet
