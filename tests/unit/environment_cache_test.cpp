// Cache of prepared environments: an entry read from disk equals the computed one bit for bit, and invalid entries are rejected.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "engine/render/environment_map.h"
#include "engine/render/made_sky.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::environment_cache_test {
namespace {

HdrImage sky(float clouds) {
    SkyLook look;
    look.clouds = clouds;
    return makeSky(look);
}

bool same(const Environment& a, const Environment& b) {
    if (a.width != b.width || a.mips.size() != b.mips.size()) return false;
    for (size_t k = 0; k < a.mips.size(); ++k)
        if (a.mips[k].size() != b.mips[k].size() || std::memcmp(a.mips[k].data(), b.mips[k].data(), a.mips[k].size() * sizeof(vec3)) != 0)
            return false;
    return std::memcmp(a.matte.data(), b.matte.data(), sizeof a.matte) == 0;
}

TEST(EnvironmentCache, ACachedResultIsIdenticalBitForBit) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    const HdrImage image = sky(0.5F);
    const Environment made = prefiltered(image);
    EXPECT_EQ(made.mips.back().size(), 1U);
    EXPECT_TRUE(same(cachedEnvironment(image, cache), made)) << "made and kept";
    ASSERT_EQ(scratch.contents().size(), 1U);
    EXPECT_TRUE(same(cachedEnvironment(image, cache), made)) << "read";
    EXPECT_TRUE(same(cachedEnvironment(image, DiskCache("")), made)) << "kept nowhere";
    // One texel more or less bright is another picture.
    HdrImage other = image;
    other.texels[7].y += 0.25F;
    EXPECT_TRUE(same(cachedEnvironment(other, cache), prefiltered(other)));
    EXPECT_FALSE(same(cachedEnvironment(other, cache), made));
    EXPECT_EQ(scratch.contents().size(), 2U);
}

// A sky is kept by its look: it is not made again to ask for it.
TEST(EnvironmentCache, ASkyIsKeptByItsLook) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    SkyLook look;
    look.clouds = 0.3F;
    const Environment made = prefiltered(makeSky(look));
    EXPECT_TRUE(same(cachedEnvironment(look, cache), made)) << "made and kept";
    EXPECT_TRUE(same(cachedEnvironment(look, cache), made)) << "read";
    ASSERT_EQ(scratch.contents().size(), 1U);
    look.horizon.y += 1.0e-6F;
    EXPECT_TRUE(same(cachedEnvironment(look, cache), prefiltered(makeSky(look))));
    EXPECT_EQ(scratch.contents().size(), 2U);
}

TEST(EnvironmentCache, ItIsTheCacheThatAnswers) {
    // A file that was of use is marked as used just now.
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    const HdrImage image = sky(0.2F);
    const Environment made = cachedEnvironment(image, cache);
    const std::filesystem::path file = scratch.path() / scratch.contents().at(0);
    const auto before = std::filesystem::last_write_time(file) - std::chrono::hours(1);
    std::filesystem::last_write_time(file, before);
    EXPECT_TRUE(same(cachedEnvironment(image, cache), made));
    EXPECT_GT(std::filesystem::last_write_time(file), before) << "it was not read";
}

TEST(EnvironmentCache, ADamagedFileIsReplaced) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    const HdrImage image = sky(0.8F);
    const Environment made = cachedEnvironment(image, cache);
    const std::filesystem::path file = scratch.path() / scratch.contents().at(0);
    const auto size = std::filesystem::file_size(file);
    {
        std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
        stream.seekp(static_cast<std::streamoff>(size / 2));
        stream.write("!?!?", 4);
    }
    EXPECT_TRUE(same(cachedEnvironment(image, cache), made));
    std::filesystem::resize_file(file, size / 3);
    EXPECT_TRUE(same(cachedEnvironment(image, cache), made));
    EXPECT_EQ(std::filesystem::file_size(file), size) << "and kept again";
}

}  // namespace
}  // namespace rivulet::testing::environment_cache_test
