// The GPU's counting sort and prefix sum against the standard library's, on every GPU backend of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>

#include "shaders/fluid/grid/scan_params.h"
#include "shaders/fluid/world/step_params.h"
#include "tests/parity/devices.h"

namespace rivulet::sort_test {
namespace {

const Define kScanDefines[] = {{"LOCAL_SIZE", "256"}};

std::vector<uint32_t> scanOnDevice(Device& device, const Buffer& values, uint32_t count, Buffer& sums) {
    const ScanParams params{count, (count + SCAN_BLOCK - 1) / SCAN_BLOCK, 0, 0};
    Buffer blockSums = std::move(*device.allocate(params.blocks * sizeof(uint32_t)));
    device.run(*device.kernel("fluid/grid/scan_reduce", kScanDefines), params, {&values, &blockSums}, params.blocks * SCAN_THREADS);
    device.run(*device.kernel("fluid/grid/scan_blocks", kScanDefines), params, {&blockSums}, SCAN_THREADS);
    device.run(*device.kernel("fluid/grid/scan_apply", kScanDefines), params, {&values, &blockSums, &sums}, params.blocks * SCAN_THREADS);
    return device.readAll<uint32_t>(sums, count);
}

template <class T>
Buffer upload(Device& device, const std::vector<T>& items) {
    Buffer buffer = std::move(*device.allocate(items.size() * sizeof(T)));
    device.writeAll(buffer, std::span<const T>(items));
    return buffer;
}

struct Particles {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
};

// A grid of 12 x 8 x 10 cells of 0.1 m whose unpadded corner is at (-0.2, 0.3, 1).
StepParams gridParams(uint32_t count) {
    StepParams p{};
    p.gridOrigin = vec4(-0.3F, 0.2F, 0.9F, 0.0F);
    p.gridScale = vec4(10.0F);
    p.cellsX = 14;
    p.cellsY = 10;
    p.cellsZ = 12;
    p.cellCount = p.totalCells = 14 * 10 * 12;
    p.firstSample = UINT32_MAX;
    p.count = count;
    return p;
}

// The reference implements "strictly inside the unpadded cells" independently, cell by cell.
uint32_t referenceCell(const vec4& x, const StepParams& p) {
    const float g[3] = {(x.x - p.gridOrigin.x) * p.gridScale.x, (x.y - p.gridOrigin.y) * p.gridScale.x,
                        (x.z - p.gridOrigin.z) * p.gridScale.x};
    const int cells[3] = {p.cellsX, p.cellsY, p.cellsZ};
    for (int a = 0; a < 3; ++a)
        if (!std::isfinite(g[a]) || std::floor(g[a]) < 1 || std::floor(g[a]) > static_cast<float>(cells[a] - 2))
            return p.totalCells + 1;  // lost
    return static_cast<uint32_t>((std::floor(g[2]) * static_cast<float>(p.cellsY) + std::floor(g[1])) * static_cast<float>(p.cellsX) +
                                 std::floor(g[0]));
}

Particles randomParticles(uint32_t count, uint32_t seed) {
    std::mt19937 random(seed);
    Particles all;
    all.id.resize(count);
    std::iota(all.id.begin(), all.id.end(), 7U);
    std::shuffle(all.id.begin(), all.id.end(), random);
    const auto uniform = [&](float lo, float hi) { return lo + (hi - lo) * static_cast<float>(random() >> 8U) * 0x1p-24F; };
    for (uint32_t i = 0; i < count; ++i) {
        all.position.emplace_back(uniform(-0.2F, 1.0F), uniform(0.3F, 1.1F), uniform(1.0F, 2.0F), static_cast<float>(i));
        all.velocity.emplace_back(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), -static_cast<float>(i));
    }
    return all;
}

// Sorts on the device and compares with a stable sort by (cell, id). Returns how many particles were inside.
// `byId` false: any order within a cell is accepted.
uint32_t expectSorted(Device& device, const Particles& in, bool byId = true) {
    const uint32_t count = static_cast<uint32_t>(in.id.size());
    const StepParams params = gridParams(count);
    const uint32_t cells = params.totalCells;
    Buffer position = upload(device, in.position), velocity = upload(device, in.velocity), id = upload(device, in.id);
    const auto words = [&](size_t n) { return std::move(*device.allocate(n * sizeof(uint32_t))); };
    Buffer cellParticles = words(cells + 4), cellStart = words(cells + 4), cell = words(count), rank = words(count), order = words(count);
    Buffer positionOut = std::move(*device.allocate(count * sizeof(vec4))), velocityOut = std::move(*device.allocate(count * sizeof(vec4))),
           idOut = words(count);

    device.fill(cellParticles, 0);
    device.run(*device.kernel("fluid/grid/cell_count"), params, {&position, &id, &cellParticles, &cell, &rank}, count);
    const std::vector<uint32_t> starts = scanOnDevice(device, cellParticles, cells + 4, cellStart);
    device.run(*device.kernel("fluid/grid/cell_scatter"), params, {&cellStart, &cell, &rank, &order}, count);
    device.run(*device.kernel("fluid/grid/cell_sort"), params, {&cellStart, &id, &order}, cells);
    device.run(*device.kernel("fluid/grid/reorder"), params, {&order, &position, &velocity, &id, &positionOut, &velocityOut, &idOut},
               count);

    std::vector<uint32_t> reference(count);
    std::iota(reference.begin(), reference.end(), 0U);
    std::vector<uint32_t> cellOfParticle(count), expectedStarts(cells + 4, 0);
    for (uint32_t i = 0; i < count; ++i) {
        cellOfParticle[i] = referenceCell(in.position[i], params);
        ++expectedStarts[cellOfParticle[i] + 1];
    }
    std::partial_sum(expectedStarts.begin(), expectedStarts.end(), expectedStarts.begin());
    std::stable_sort(reference.begin(), reference.end(), [&](uint32_t a, uint32_t b) {
        return cellOfParticle[a] != cellOfParticle[b] ? cellOfParticle[a] < cellOfParticle[b] : in.id[a] < in.id[b];
    });

    EXPECT_EQ(starts, expectedStarts);
    EXPECT_EQ(device.readAll<uint32_t>(cell, count), cellOfParticle);
    const uint32_t inside = expectedStarts[cells];
    std::vector<uint32_t> got = device.readAll<uint32_t>(order, count);
    for (uint32_t slot = 0; slot < inside; ++slot)
        if (byId ? got[slot] != reference[slot] : got[slot] >= count || cellOfParticle[got[slot]] != cellOfParticle[reference[slot]]) {
            ADD_FAILURE() << "slot " << slot << " holds particle " << got[slot] << ", a stable sort by cell and id puts " << reference[slot]
                          << " there";
            break;
        }
    const std::vector<vec4> positions = device.readAll<vec4>(positionOut, count), velocities = device.readAll<vec4>(velocityOut, count);
    const std::vector<uint32_t> ids = device.readAll<uint32_t>(idOut, count);
    for (uint32_t slot = 0; slot < count; ++slot) {  // bit for bit, NaN too
        const uint32_t i = got[slot];
        if (i >= count) {
            ADD_FAILURE() << "slot " << slot << " holds no particle";
            return inside;
        }
        EXPECT_EQ(std::memcmp(&positions[slot], &in.position[i], sizeof(vec4)), 0) << slot;
        EXPECT_EQ(std::memcmp(&velocities[slot], &in.velocity[i], sizeof(vec4)), 0) << slot;
        EXPECT_EQ(ids[slot], in.id[i]) << slot;
    }
    std::sort(got.begin(), got.end());  // all particles outside the grid are present, in any order
    for (uint32_t i = 0; i < count; ++i) EXPECT_EQ(got[i], i);
    return inside;
}

class SortTest : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        Result<TestGpu> made = makeTestGpu(GetParam());
        if (!made) GTEST_SKIP() << made.error().message;
        gpu_ = std::move(*made);
        device_ = gpu_.device.get();
        for (const char* path : {"fluid/grid/cell_count", "fluid/grid/cell_scatter", "fluid/grid/cell_sort", "fluid/grid/reorder"}) {
            const auto kernel = device_->kernel(path);
            ASSERT_TRUE(kernel) << kernel.error().message;
        }
        for (const char* path : {"fluid/grid/scan_reduce", "fluid/grid/scan_blocks", "fluid/grid/scan_apply"}) {
            const auto kernel = device_->kernel(path, kScanDefines);
            ASSERT_TRUE(kernel) << kernel.error().message;
        }
    }
    TestGpu gpu_;
    Device* device_ = nullptr;
};

TEST_P(SortTest, prefixSumEqualsTheStandardLibrarys) {
    std::mt19937 random(1);
    // The last needs three rounds of the middle level.
    for (const uint32_t count : {1U, 3U, 4U, 255U, 1023U, 1024U, 1025U, 4099U, 1024U * 1024U, 2U * 1024U * 1024U + 5U}) {
        std::vector<uint32_t> values(count), expected(count);
        for (uint32_t& v : values) v = random() % 9;
        std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0U);
        Buffer in = upload(*device_, values);
        Buffer out = std::move(*device_->allocate(count * sizeof(uint32_t)));
        EXPECT_EQ(scanOnDevice(*device_, in, count, out), expected) << count;
    }
}

TEST_P(SortTest, orderIsThatOfAStableSortByCellAndId) {
    for (const uint32_t count : {0U, 1U, 2U, 63U, 64U, 65U, 1000U, 65537U}) {
        SCOPED_TRACE(count);
        EXPECT_EQ(expectSorted(*device_, randomParticles(count, count)), count);
    }
}

TEST_P(SortTest, allParticlesInOneCell) {
    // llvmpipe ends all loops of a shader after 65,535 rounds in total: there the larger cell stays partly unsorted, but no particle is
    // lost.
    const bool loopsEnd = device_->backend() == Backend::gl && device_->info().software;
    for (const uint32_t count : {1000U, 65537U}) {
        Particles all = randomParticles(count, count);
        for (vec4& x : all.position) x = vec4(0.45F, 0.75F, 1.55F, x.w);
        EXPECT_EQ(expectSorted(*device_, all, count == 1000 || !loopsEnd), count);
    }
}

TEST_P(SortTest, outsideAndNanParticlesAreSortedBehindTheGrid) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    Particles all = randomParticles(5000, 4);
    uint32_t lost = 0;
    const auto put = [&](uint32_t i, const vec4& x) {
        all.position[i] = x;
        ++lost;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const float bad : {nan, -nan, inf, -inf, 1.0e30F, -1.0e30F, 3.0e9F, 100.0F, -100.0F}) {
            vec4 x = all.position[0];
            x[axis] = bad;
            put(10 + 17 * lost, x);
        }
    const StepParams p = gridParams(0);
    for (int axis = 0; axis < 3; ++axis) {  // in the padding, just beyond the unpadded cells
        const int cells[3] = {p.cellsX, p.cellsY, p.cellsZ};
        vec4 low = all.position[0], high = low;
        low[axis] = p.gridOrigin[axis] + 0.0999F;
        high[axis] = p.gridOrigin[axis] + 0.1F * static_cast<float>(cells[axis] - 1) + 0.0001F;
        put(10 + 17 * lost, low);
        put(10 + 17 * lost, high);
    }
    EXPECT_EQ(expectSorted(*device_, all), 5000U - lost);

    for (vec4& x : all.position) x.y = nan;
    EXPECT_EQ(expectSorted(*device_, all), 0U);
}

TEST_P(SortTest, twoRunsGiveTheSameOrder) {
    // Ids against the particles' order, and cells so full that the atomics' order varies.
    Particles all = randomParticles(2000, 5);
    for (vec4& x : all.position) x = vec4(0.2F + 0.1F * x.x, 0.7F + 0.1F * x.y, 1.5F + 0.1F * x.z, x.w);
    for (int run = 0; run < 3; ++run) expectSorted(*device_, all);
}

INSTANTIATE_TEST_SUITE_P(Gpu, SortTest, testing::Values("cl", "gl"), [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace rivulet::sort_test
