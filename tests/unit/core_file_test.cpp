#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "engine/core/file.h"
#include "tests/unit/core_sample.h"

namespace rivulet::core_file_test {

namespace {

namespace fs = std::filesystem;

// A folder of the test's own, gone afterwards.
class FileTest : public ::testing::Test {
  protected:
    FileTest() { fs::create_directories(folder_); }
    ~FileTest() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    size_t filesInFolder() const { return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }

  private:
    fs::path folder_ = fs::temp_directory_path() / ("rivulet_file_test_" + std::to_string(::getpid()));
};

std::string errorOf(const Status& status) { return status ? "" : status.error().message; }
std::string errorOf(const Result<std::string>& result) { return result ? "" : result.error().message; }

}  // namespace

TEST_F(FileTest, WritesAndReadsWholeFiles) {
    const std::string bytes("a\0b\n", 4);
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), bytes)), "");
    EXPECT_EQ(*readFile(path("a")), bytes);
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), "")), "");
    EXPECT_EQ(*readFile(path("a")), "");
    EXPECT_EQ(filesInFolder(), 1U) << "no temporary file stays";
}

TEST_F(FileTest, AnExistingFileKeepsItsModeAndALinkStaysALink) {
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), "1")), "");
    ASSERT_EQ(::chmod(path("a").c_str(), 0640), 0);
    fs::create_symlink(path("a"), path("link"));
    ASSERT_EQ(errorOf(writeFileAtomic(path("link"), "2")), "");
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(*readFile(path("a")), "2");
    EXPECT_EQ(static_cast<unsigned>(fs::status(path("a")).permissions()), 0640U);
}

TEST_F(FileTest, AFailedWriteReportsTheReasonAndLeavesNoFile) {
    EXPECT_EQ(errorOf(writeFileAtomic(path("none/a"), "x")), path("none/a") + " cannot be written: its folder does not exist");
    EXPECT_EQ(errorOf(writeFileAtomic(path(""), "x")), path("") + " cannot be written: it is a folder");
    const std::string longName = path(std::string(300, 'n'));
    EXPECT_EQ(errorOf(writeFileAtomic(longName, "x")), longName + " cannot be written: its name is too long");
    EXPECT_EQ(filesInFolder(), 0U);
    const Status full = writeFileAtomic("/dev/full", "x");
    EXPECT_EQ(errorOf(full), "/dev/full cannot be written: the disk is full");
    EXPECT_EQ(full.error().fault, Fault::failed);
    EXPECT_TRUE(fs::is_character_file("/dev/full")) << "a device is written into, never replaced";
}

TEST_F(FileTest, ADiskThatFillsUpLeavesTheOldFile) {
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), "old")), "");
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{4096, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status written = writeFileAtomic(path("a"), std::string(100000, 'x'));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_NE(errorOf(written), "");
    EXPECT_EQ(*readFile(path("a")), "old");
    EXPECT_EQ(filesInFolder(), 1U);
}

TEST_F(FileTest, AFolderWithoutPermissionIsNotWritten) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    fs::create_directory(path("locked"));
    fs::permissions(path("locked"), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(errorOf(writeFileAtomic(path("locked/a"), "x")), path("locked/a") + " cannot be written: permission is denied");
}

TEST_F(FileTest, AFailedReadReportsTheReason) {
    EXPECT_EQ(errorOf(readFile(path("none"))), path("none") + " cannot be read: it does not exist");
    EXPECT_EQ(errorOf(readFile(path(""))), path("") + " cannot be read: it is a folder");
    EXPECT_EQ(errorOf(readFile(path("none/a"))), path("none/a") + " cannot be read: it does not exist");
    EXPECT_EQ(readFile(path("none")).error().fault, Fault::badInput);
}

TEST_F(FileTest, ReadsAreBounded) {
    std::ofstream(path("large")).close();
    fs::resize_file(path("large"), uintmax_t{100} << 20U);  // takes no space on the disk
    EXPECT_EQ(errorOf(readFile(path("large"), size_t{64} << 20U)), path("large") + " cannot be read: it is larger than 64 MiB");
    EXPECT_EQ(errorOf(readFile("/dev/zero", size_t{1} << 20U)), "/dev/zero cannot be read: it is larger than 1 MiB");
    Sample sample;
    EXPECT_EQ(errorOf(readJsonFile(path("large"), visiting(sample))), path("large") + " cannot be read: it is larger than 64 MiB");
}

TEST_F(FileTest, JsonErrorsNameTheFile) {
    ASSERT_EQ(errorOf(writeFileAtomic(path("a.json"), "{\"fre\": 1}")), "");
    Sample sample;
    EXPECT_EQ(errorOf(readJsonFile(path("a.json"), visiting(sample))), path("a.json") + ":1:2: fre is not a parameter; did you mean free?");
}

}  // namespace rivulet::core_file_test
