#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <stdexcept>
#include <system_error>

#include "engine/core/exception_error.h"
#include "engine/core/file.h"
#include "engine/core/input_file.h"
#include "engine/core/new_file.h"
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
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), "3", 0600, Sync::none)), "");
    EXPECT_EQ(static_cast<unsigned>(fs::status(path("a")).permissions()), 0640U) << "the older file's";
    ASSERT_EQ(errorOf(writeFileAtomic(path("private"), "1", 0600, Sync::none)), "");
    EXPECT_EQ(static_cast<unsigned>(fs::status(path("private")).permissions()), 0600U);
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
    Sample sample;
    EXPECT_EQ(errorOf(readJsonFile(path("large"), visiting(sample))), path("large") + " cannot be read: it is larger than 64 MiB");
}

// What is no regular file is refused at once: a pipe without a writer would be waited for, a device may have effects.
TEST_F(FileTest, OnlyRegularFilesAreRead) {
    ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
    fs::create_symlink(path("pipe"), path("link"));
    const int server = ::socket(AF_UNIX, SOCK_STREAM, 0);
    struct sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    path("socket").copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(server, reinterpret_cast<struct sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(errorOf(readFile(path("pipe"))), path("pipe") + " cannot be read: it is a pipe; write its data to a file first");
    EXPECT_EQ(errorOf(readFile(path("link"))), path("link") + " cannot be read: it is a pipe; write its data to a file first");
    EXPECT_EQ(errorOf(readFile(path("socket"))), path("socket") + " cannot be read: it is a socket; name a file");
    for (const std::string device : {"/dev/zero", "/dev/null", "/dev/tty"})
        EXPECT_EQ(errorOf(readFile(device)), device + " cannot be read: it is a device; name a file");
    for (const std::string shown : {"/proc/self/environ", "/proc/self/mem", "/proc/version", "/sys/kernel/mm/transparent_hugepage/enabled"})
        if (fs::exists(shown))
            EXPECT_EQ(errorOf(readFile(shown)),
                      shown + " cannot be read: it is on a virtual file system such as /proc or /sys; name a regular file");
    ::close(server);
    ASSERT_EQ(errorOf(writeFileAtomic(path("a"), "1")), "");
    fs::create_symlink(path("a"), path("to_a"));
    EXPECT_EQ(*readFile(path("to_a")), "1");
    EXPECT_TRUE(checkInput(path("to_a")));
    EXPECT_EQ(errorOf(checkInput(path("pipe"))), errorOf(readFile(path("pipe"))));
}

TEST_F(FileTest, JsonErrorsNameTheFile) {
    ASSERT_EQ(errorOf(writeFileAtomic(path("a.json"), "{\"fre\": 1}")), "");
    Sample sample;
    EXPECT_EQ(errorOf(readJsonFile(path("a.json"), visiting(sample))), path("a.json") + ":1:2: fre is not a parameter; did you mean free?");
}

// A NewFile has its name only when it is complete.
class NewFileTest : public FileTest {
  protected:
    std::string name() const { return path("a.rrec"); }
    // Begins a file beside an older one.
    NewFile begun() {
        EXPECT_EQ(errorOf(writeFileAtomic(name(), "old")), "");
        Result<NewFile> file = NewFile::open(name());
        EXPECT_TRUE(file);
        EXPECT_EQ(errorOf(file->write("new")), "");
        return std::move(*file);
    }
};

TEST_F(NewFileTest, TakesItsNameWhenItIsComplete) {
    {
        NewFile file = begun();
        EXPECT_EQ(*readFile(name()), "old");
        EXPECT_TRUE(file.name().ends_with("a.rrec")) << "other programs choose the format by the ending: " << file.name();
        ASSERT_EQ(errorOf(file.write(" file")), "");
        ASSERT_EQ(errorOf(file.commit()), "");
        EXPECT_EQ(*readFile(name()), "new file");
    }
    EXPECT_EQ(*readFile(name()), "new file");
    EXPECT_EQ(filesInFolder(), 1U);
}

TEST_F(NewFileTest, WithoutCommitTheOlderFileStays) {
    { const NewFile file = begun(); }
    EXPECT_EQ(*readFile(name()), "old");
    EXPECT_EQ(filesInFolder(), 1U);
    try {
        const NewFile file = begun();
        throw std::bad_alloc();
    } catch (const std::bad_alloc&) {
    }
    EXPECT_EQ(*readFile(name()), "old");
    EXPECT_EQ(filesInFolder(), 1U);
    NewFile moved = begun();
    moved = begun();  // the first one is given up
    EXPECT_EQ(filesInFolder(), 2U);
}

TEST_F(NewFileTest, AFailedWriteIsNeverCommitted) {
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    {
        NewFile file = begun();
        const rlimit small{1000, before.rlim_max};
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
        const Status written = file.write(std::string(5000, 'x'), "frame 7");
        ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
        EXPECT_EQ(errorOf(written), name() +
                                        ": frame 7 cannot be written: it exceeds the size that the system allows (ulimit -f); "
                                        "the older file is unchanged");
        EXPECT_NE(errorOf(file.write("y")), "");
        EXPECT_NE(errorOf(file.commit()), "") << "what follows a lost part makes no whole file";
    }
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(*readFile(name()), "old");
    EXPECT_EQ(filesInFolder(), 1U);
}

// For recordings, which can be read up to where they end.
TEST_F(NewFileTest, PublishesOnlyWhereNoFileWouldBeReplaced) {
    {
        NewFile file = begun();
        file.publish();
        EXPECT_EQ(*readFile(name()), "old");
    }
    EXPECT_EQ(*readFile(name()), "old");
    {
        Result<NewFile> file = NewFile::open(path("b.rrec"));
        ASSERT_TRUE(file);
        ASSERT_EQ(errorOf(file->write("first")), "");
        EXPECT_FALSE(fs::exists(path("b.rrec")));
        file->publish();
        EXPECT_EQ(*readFile(path("b.rrec")), "first");
        ASSERT_EQ(errorOf(file->write(" second")), "");
    }
    EXPECT_EQ(*readFile(path("b.rrec")), "first second") << "incomplete, and kept";
    EXPECT_EQ(filesInFolder(), 2U);
}

TEST_F(NewFileTest, ANameMayBeAsLongAsTheSystemAllows) {
    const std::string longest = path(std::string(250, 'n') + ".json");
    ASSERT_EQ(errorOf(writeFileAtomic(longest, "1")), "");
    ASSERT_EQ(errorOf(writeFileAtomic(longest, "2")), "");
    EXPECT_EQ(*readFile(longest), "2");
}

// A handler of signals removes the files of its own process, and a process that was forked without the program leaves them.
TEST_F(NewFileTest, SignalsRemoveTemporaryFiles) {
    const auto inChild = [](const std::function<void()>& work) {
        const pid_t child = ::fork();
        if (child == 0) {
            work();
            ::_exit(0);
        }
        int status = 0;
        ::waitpid(child, &status, 0);
        return status;
    };
    inChild([&] {
        const NewFile one = begun(), two = begun();
        std::signal(SIGTERM, [](int) {
            removeTemporaryFiles();
            ::_exit(0);
        });
        std::raise(SIGTERM);
    });
    EXPECT_EQ(*readFile(name()), "old");
    EXPECT_EQ(filesInFolder(), 1U);
    NewFile file = begun();
    inChild([] { removeTemporaryFiles(); });
    EXPECT_EQ(filesInFolder(), 2U);
    EXPECT_EQ(errorOf(file.commit()), "");
    EXPECT_EQ(*readFile(name()), "new");
}

// A host may have closed its standard streams: what it prints must not reach a file.
TEST_F(NewFileTest, FilesAreNeverStandardStreams) {
    ASSERT_EQ(errorOf(writeFileAtomic(path("in"), "1")), "");
    const pid_t child = ::fork();
    if (child == 0) {
        for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::close(stream);
        Result<NewFile> file = NewFile::open(name());
        const Result<Descriptor> input = openInput(path("in"));
        const bool written = file && file->write("data");
        (void)!::write(STDOUT_FILENO, "printed", 7);
        (void)!::write(STDERR_FILENO, "printed", 7);
        ::_exit(written && input && input->get() > STDERR_FILENO && file->commit() ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(*readFile(name()), "data");
}

TEST(ExceptionError, IsAPlainSentence) {
    const auto sentence = [](const auto& exception) { return rivulet::errorOf(std::make_exception_ptr(exception)).message; };
    const std::string memory = "out of memory; use fewer particles or coarser voxels";
    EXPECT_EQ(sentence(std::bad_alloc()), memory);
    EXPECT_EQ(sentence(std::length_error("vector::_M_default_append")), memory);
    EXPECT_EQ(sentence(fs::filesystem_error("status", "/gone", std::make_error_code(std::errc::not_a_directory))),
              "/gone cannot be used: a part of its path is not a folder");
    EXPECT_EQ(sentence(std::system_error(ENOSPC, std::generic_category())), "the system refused a request: the disk is full");
    EXPECT_EQ(sentence(std::runtime_error("no axis")), "an unexpected fault occurred: no axis");
    EXPECT_EQ(sentence(3), "an unexpected fault occurred");
}

}  // namespace rivulet::core_file_test
