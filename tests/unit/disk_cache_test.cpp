// The disk cache returns complete entries, and never a damaged one or that of another key.
#include "engine/compute/disk_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/unit/program_runner.h"

namespace rivulet::testing::disk_cache_test {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytesOf(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::string fileText(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void writeText(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary | std::ios::trunc) << text; }

TEST(DiskCacheTest, AnEntryIsFoundByItsExactKeyOnly) {
    const Scratch scratch;
    const DiskCache cache((scratch.path() / "not/there/yet").string());
    EXPECT_FALSE(cache.find("a"));
    const std::string program("\0binary\0\xff", 9);
    cache.keep("a", bytesOf(program));
    ASSERT_TRUE(cache.find("a"));
    EXPECT_EQ(*cache.find("a"), bytesOf(program));
    EXPECT_FALSE(cache.find("b"));
    EXPECT_FALSE(cache.find("a "));
    EXPECT_FALSE(cache.find(""));
    cache.keep("a", bytesOf("newer"));
    EXPECT_EQ(*cache.find("a"), bytesOf("newer"));
    EXPECT_TRUE(DiskCache(cache).find("a")) << "another start finds it, too";
}

// A damaged file is a miss without an error, and the next entry replaces it.
TEST(DiskCacheTest, EveryDamageIsAMiss) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    const std::string key = "source\noptions\ndevice\n";
    cache.keep(key, bytesOf("a program of some length"));
    const std::string path = cache.pathOf(key), whole = fileText(path);
    ASSERT_GT(whole.size(), key.size());
    for (size_t length = 0; length < whole.size(); ++length) {
        writeText(path, whole.substr(0, length));
        EXPECT_FALSE(cache.find(key)) << "cut to " << length;
    }
    for (size_t at = 0; at < whole.size(); ++at) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
        writeText(path, damaged);
        EXPECT_FALSE(cache.find(key)) << "byte " << at;
    }
    writeText(path, whole + "more");
    EXPECT_FALSE(cache.find(key));
    // Lengths that would reach far beyond the file.
    std::string huge = whole;
    std::memset(huge.data() + 8, 0xff, 16);
    writeText(path, huge);
    EXPECT_FALSE(cache.find(key));
    cache.keep(key, bytesOf("good again"));
    EXPECT_EQ(*cache.find(key), bytesOf("good again"));
}

// Two keys with the same hash: the file stores the whole key.
TEST(DiskCacheTest, AnothersFileUnderThisNameIsAMiss) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    cache.keep("theirs", bytesOf("their program"));
    fs::rename(cache.pathOf("theirs"), cache.pathOf("mine"));
    EXPECT_FALSE(cache.find("mine"));
}

// Kernels' binaries of another user are not run: neither from a folder nor from a file that others may have written.
TEST(DiskCacheTest, WhatOthersMayHaveWrittenIsNotRead) {
    const Scratch scratch;
    std::vector<std::string> notices;
    const Log log{[&](LogLevel, std::string_view text) { notices.emplace_back(text); }};
    const std::string folder = (scratch.path() / "rivulet/cl").string();
    DiskCache(folder, log).keep("key", bytesOf("program"));
    const std::string path = DiskCache(folder).pathOf("key");
    struct stat status {};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
    ASSERT_EQ(::stat(folder.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0700U);
    EXPECT_TRUE(DiskCache(folder, log).find("key"));
    EXPECT_TRUE(notices.empty());

    ASSERT_EQ(::chmod(path.c_str(), 0666), 0);
    const DiskCache cache(folder, log);
    EXPECT_FALSE(cache.find("key"));
    ASSERT_EQ(notices.size(), 1U);
    EXPECT_NE(notices[0].find(path), std::string::npos) << notices[0];
    cache.keep("key", bytesOf("program"));
    EXPECT_TRUE(cache.find("key"));
    EXPECT_EQ(notices.size(), 1U);

    ASSERT_EQ(::chmod(folder.c_str(), 0777), 0);
    const DiskCache open(folder, log);
    ASSERT_EQ(notices.size(), 2U);
    EXPECT_NE(notices[1].find(folder), std::string::npos) << notices[1];
    EXPECT_FALSE(open.find("key"));
    open.keep("other", bytesOf("program"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
    EXPECT_EQ(notices.size(), 2U);
}

TEST(DiskCacheTest, AFolderThatCannotBeIsNoTrouble) {
    const Scratch scratch;
    const std::string file = scratch.file("a_file", "text");
    for (const std::string& folder : {std::string(), file, std::string("/proc/none/of/this"), std::string("/dev/null")}) {
        const DiskCache cache(folder);
        cache.keep("key", bytesOf("program"));
        EXPECT_FALSE(cache.find("key")) << folder;
    }
    EXPECT_EQ(fileText(file), "text");
    const DiskCache cache(scratch.path().string());
    fs::create_directory(cache.pathOf("key"));  // in the file's place
    cache.keep("key", bytesOf("program"));
    EXPECT_FALSE(cache.find("key"));
}

TEST(DiskCacheTest, TheLeastRecentlyUsedEntryIsDeletedFirst) {
    const Scratch scratch;
    const DiskCache cache(scratch.path().string());
    const auto now = fs::file_time_type::clock::now();
    const size_t most = DiskCache::kMostFiles;
    for (size_t k = 0; k < most; ++k) {
        const std::string key = "key " + std::to_string(k);
        cache.keep(key, bytesOf("program"));
        fs::last_write_time(cache.pathOf(key), now - std::chrono::hours(static_cast<long>(2 * most - k)));
    }
    writeText(scratch.file("half.kept.1-0.tmp"), "what a crash has left");
    fs::last_write_time(scratch.file("half.kept.1-0.tmp"), now - std::chrono::hours(2));
    writeText(scratch.file("somebody's.txt"), "not ours");
    fs::last_write_time(scratch.file("somebody's.txt"), now - std::chrono::hours(9999));
    EXPECT_TRUE(cache.find("key 0"));  // and that was a use
    cache.keep("one more", bytesOf("program"));
    EXPECT_TRUE(cache.find("one more"));
    EXPECT_TRUE(cache.find("key 0"));
    EXPECT_FALSE(cache.find("key 1"));
    EXPECT_TRUE(cache.find("key 2"));
    EXPECT_TRUE(fs::exists(scratch.file("somebody's.txt")));
    EXPECT_FALSE(fs::exists(scratch.file("half.kept.1-0.tmp")));
    // By bytes, too: two of 24 MiB and one of 17 are more than 64 MiB.
    cache.keep("large 1", std::vector<std::byte>(size_t{24} << 20U));
    fs::last_write_time(cache.pathOf("large 1"), now - std::chrono::hours(3));
    cache.keep("large 2", std::vector<std::byte>(size_t{24} << 20U));
    cache.keep("large 3", std::vector<std::byte>(size_t{17} << 20U));
    EXPECT_FALSE(cache.find("large 1"));
    EXPECT_TRUE(cache.find("large 2"));
    EXPECT_TRUE(cache.find("large 3"));
    EXPECT_TRUE(cache.find("one more"));
}

}  // namespace
}  // namespace rivulet::testing::disk_cache_test
