// The record of a run, against numbers known beforehand.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "fluid/session/run_stats.h"

namespace rivulet::program_run_stats_test {
namespace {

constexpr float kSpacing = 0.02F;

// Particles at rest spacing from the low corner of the box up to `size`.
std::vector<vec4> lattice(const vec3& low, const vec3& size) {
    std::vector<vec4> points;
    for (float x = 0.5F * kSpacing; x < size.x; x += kSpacing)
        for (float y = 0.5F * kSpacing; y < size.y; y += kSpacing)
            for (float z = 0.5F * kSpacing; z < size.z; z += kSpacing) points.emplace_back(low + vec3(x, y, z), 1.0F);
    return points;
}

BoxParams boxOf(const vec3& min, const vec3& max) {
    BoxParams box;
    box.min = min;
    box.max = max;
    return box;
}

TEST(BulkFront, OfABlockIsItsFace) {
    BoxParams box = boxOf(vec3(0), vec3(2, 1, 0.4F));
    for (float length : {0.2F, 0.4F, 0.52F, 0.98F, 1.5F}) {
        std::optional<double> front = bulkFront(lattice(box.min, {length, 0.3F, 0.4F}), box, kSpacing);
        ASSERT_TRUE(front);
        // The crossing lies between the centres of two slabs of 2 spacings: the face is known to one spacing.
        EXPECT_NEAR(*front, static_cast<double>(length), 1.01 * static_cast<double>(kSpacing));
    }
    // It moves with the face, not in jumps of a slab.
    double before = 0;
    for (int i = 0; i < 12; ++i) {
        double front = *bulkFront(lattice(box.min, {0.5F + 0.02F * static_cast<float>(i), 0.3F, 0.4F}), box, kSpacing);
        if (i > 0) {
            EXPECT_GT(front, before);
            EXPECT_LT(front - before, 0.031);
        }
        before = front;
    }
}

TEST(BulkFront, IsFoundForAnyPositionOfTheBox) {
    vec3 low(-3, 2, 5);
    double front = *bulkFront(lattice(low, {0.5F, 0.1F, 0.4F}), boxOf(low, low + vec3(2, 1, 0.4F)), kSpacing);
    EXPECT_NEAR(front, -2.5, 0.021);
}

TEST(BulkFront, SprayDoesNotCarryIt) {
    BoxParams box = boxOf(vec3(0), vec3(2, 1, 0.4F));
    std::vector<vec4> points = lattice(box.min, {0.5F, 0.3F, 0.4F});
    double still = *bulkFront(points, box, kSpacing);
    points.emplace_back(1.9F, 0.01F, 0.2F, 1.0F);                                         // a drop far ahead
    for (const vec4& p : lattice({1, 0.5F, 0}, {0.3F, 0.1F, 0.4F})) points.push_back(p);  // a sheet in the air
    points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0, 0, 1);
    EXPECT_EQ(*bulkFront(points, box, kSpacing), still);
}

TEST(BulkFront, EdgesOfItsRange) {
    BoxParams box = boxOf(vec3(0), vec3(1, 1, 0.4F));
    EXPECT_FALSE(bulkFront({}, box, kSpacing));
    EXPECT_FALSE(bulkFront(lattice({0, 0.5F, 0}, {1, 0.2F, 0.4F}), box, kSpacing)) << "nothing lies on the floor";
    EXPECT_NEAR(*bulkFront(lattice(box.min, {1, 0.1F, 0.4F}), box, kSpacing), 1.0, 0.021) << "it has reached the far wall";
    EXPECT_FALSE(bulkFront(lattice(box.min, {0.5F, 0.1F, 0.4F}), box, 0));
    EXPECT_FALSE(bulkFront(lattice(box.min, {0.5F, 0.1F, 0.4F}), boxOf(vec3(0), vec3(1e5F, 1, 1e5F)), kSpacing));
}

TEST(InSetVoxel, ReadsTheBits) {
    VoxelGrid grid;
    grid.size = ivec3(5, 4, 3);
    grid.origin = vec3(-1, 2, 0.5F);
    grid.voxel = 0.25F;
    grid.bits.assign(8, 0);
    std::mt19937 random(7);
    std::vector<bool> set(60);
    for (int z = 0; z < 3; ++z)
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 5; ++x) {
                bool on = random() % 2 == 0;
                set[static_cast<size_t>((z * 4 + y) * 5 + x)] = on;
                if (on) grid.set({x, y, z});
            }
    for (int z = 0; z < 3; ++z)
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 5; ++x) {
                vec3 middle = grid.origin + grid.voxel * (vec3(x, y, z) + 0.5F);
                EXPECT_EQ(inSetVoxel(grid, vec4(middle, 1)), set[static_cast<size_t>((z * 4 + y) * 5 + x)]);
            }
    std::fill(grid.bits.begin(), grid.bits.end(), uint8_t{255});
    EXPECT_FALSE(inSetVoxel(grid, vec4(-1.01F, 2.1F, 0.6F, 1)));
    EXPECT_FALSE(inSetVoxel(grid, vec4(0.26F, 2.1F, 0.6F, 1)));
    EXPECT_FALSE(inSetVoxel(grid, vec4(1e30F, 2.1F, 0.6F, 1)));
    EXPECT_FALSE(inSetVoxel(grid, vec4(std::numeric_limits<float>::quiet_NaN(), 2.1F, 0.6F, 1)));
    EXPECT_FALSE(inSetVoxel(VoxelGrid{}, vec4(0)));
}

TEST(SpreadOf, MedianAndNearestRank) {
    EXPECT_EQ(spreadOf({}).count, 0U);
    EXPECT_EQ(spreadOf({3}).median, 3);
    EXPECT_EQ(spreadOf({3}).p95, 3);
    EXPECT_EQ(spreadOf({4, 1, 3, 2}).median, 2.5);
    std::vector<double> hundred;
    for (int i = 100; i >= 1; --i) hundred.push_back(i);
    Spread spread = spreadOf(hundred);
    EXPECT_EQ(spread.min, 1);
    EXPECT_EQ(spread.median, 50.5);
    EXPECT_EQ(spread.p95, 95);
    EXPECT_EQ(spread.max, 100);
}

// A day of frames: the quantiles of what is kept are those of all, and the least and the largest value are not lost.
TEST(SamplesOf, ALongRunKeepsItsSpread) {
    Samples samples;
    constexpr int kCount = 5'000'000;
    for (int k = 0; k < kCount; ++k) samples.add(k == 777'777 ? -1 : k == 3'333'333 ? 2 : (k * 7919LL % 1'000'003) / 1'000'003.0);
    const Spread spread = samples.spread();
    EXPECT_EQ(spread.count, static_cast<size_t>(kCount));
    EXPECT_EQ(spread.min, -1);
    EXPECT_EQ(spread.max, 2);
    EXPECT_NEAR(spread.median, 0.5, 0.01);
    EXPECT_NEAR(spread.p95, 0.95, 0.01);
    Samples few;
    for (const double value : {4.0, 1.0, 3.0, 2.0}) few.add(value);
    EXPECT_EQ(few.spread().median, 2.5);
}

TEST(RunStatsJson, HasNoNumberThatJsonHasNot) {
    RunStats stats;
    stats.scene = "a \"name\"\n";
    stats.kinetic = std::numeric_limits<double>::quiet_NaN();
    stats.potential = std::numeric_limits<double>::infinity();
    std::string text = writeRunStats(stats);
    EXPECT_NE(text.find("\"centreOfMass\": null"), std::string::npos) << text;
    EXPECT_NE(text.find(R"("a \"name\"\n")"), std::string::npos) << text;
    EXPECT_NE(text.find("\"kinetic\": null"), std::string::npos) << text;
    EXPECT_NE(text.find("\"potential\": null"), std::string::npos) << text;
}

}  // namespace
}  // namespace rivulet::program_run_stats_test
