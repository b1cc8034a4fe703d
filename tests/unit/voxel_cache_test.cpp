// The cache of baked fields: it returns the same bits as the baker, in any state of the folder.
#include "fluid/voxel/voxel_cache.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include "fluid/voxel/voxel_file.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_cache_test {
namespace {

namespace fs = std::filesystem;

// Sets or removes a variable for the lifetime of the object.
class Variable {
  public:
    Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
        if (const char* before = std::getenv(name)) before_ = before;
        set(value);
    }
    ~Variable() { set(before_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    void set(const std::optional<std::string>& value) { value ? ::setenv(name_, value->c_str(), 1) : ::unsetenv(name_); }
    const char* name_;
    std::optional<std::string> before_;
};

class VoxelCache : public ::testing::Test {
  protected:
    fs::path folder() const { return scratch_.path() / "rivulet/voxels"; }
    std::vector<fs::path> files() const {
        std::vector<fs::path> all;
        std::error_code none;
        for (fs::directory_iterator at(folder(), none), end; at != end; ++at) all.push_back(at->path());
        return all;
    }
    fs::path onlyFile() const {
        const std::vector<fs::path> all = files();
        EXPECT_EQ(all.size(), 1U);
        return all.empty() ? fs::path() : all[0];
    }
    Result<VoxelField> get(const test::Mesh& mesh) { return get({{mesh.view()}}); }
    Result<VoxelField> get(const std::vector<MeshView>& meshes) { return cachedVoxelField(meshes, options_, log_); }
    Result<VoxelField> bake(const test::Mesh& mesh) const {
        const MeshView view = mesh.view();
        return bakeVoxelField({&view, 1}, options_);
    }
    // Reads the field, expects this number of notices and the baked result.
    void expectRight(size_t notices) {
        const Result<VoxelField> got = get(mesh_), baked = bake(mesh_);
        ASSERT_TRUE(got) << got.error().message;
        EXPECT_EQ(got->surface.size, baked->surface.size);
        EXPECT_EQ(got->surface.origin, baked->surface.origin);
        EXPECT_EQ(got->surface.voxel, baked->surface.voxel);
        EXPECT_EQ(got->band, baked->band);
        EXPECT_TRUE(baked->closed);
        EXPECT_EQ(got->closed, baked->closed);
        EXPECT_TRUE(got->surface.bits == baked->surface.bits);
        EXPECT_TRUE(got->distance == baked->distance);
        EXPECT_TRUE(got->normal == baked->normal);
        EXPECT_EQ(notices_.size(), notices) << (notices_.empty() ? "" : notices_.back());
        notices_.clear();
    }

    testing::Scratch scratch_;
    Variable home_{"XDG_CACHE_HOME", scratch_.path().string()};
    test::Mesh mesh_ = test::makeSphere(vec3(0.1F, 0.2F, 0.3F), 0.5F, 8);
    VoxelFieldOptions options_{.resolution = 16};
    std::vector<std::string> notices_;
    Log log_{[this](LogLevel, std::string_view text) { notices_.emplace_back(text); }};
};

TEST_F(VoxelCache, TheSecondTimeIsReadFromTheDisk) {
    expectRight(0);
    const fs::path path = onlyFile();
    expectRight(0);
    EXPECT_EQ(onlyFile(), path);

    // The file is read: another value there gives another value here.
    Result<VoxelFile> file = readVoxelFile(path.string());
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_NE(file->band->distance[5], 0.0F);
    file->band->distance[5] = 0;
    ASSERT_TRUE(writeVoxelFile(path.string(), *file));
    const Result<VoxelField> got = get(mesh_);
    ASSERT_TRUE(got);
    EXPECT_EQ(got->distance[5], 0.0F);
}

TEST_F(VoxelCache, AnyInputThatChangesTheFieldChangesTheFile) {
    size_t expected = 1;
    expectRight(0);
    const auto isNew = [&](const char* what) {
        EXPECT_EQ(files().size(), ++expected) << what;
        expected = files().size();
    };
    options_.resolution = 17;
    ASSERT_TRUE(get(mesh_));
    isNew("resolution");
    options_.band = 0.3F;
    ASSERT_TRUE(get(mesh_));
    isNew("band");
    options_.padding = 0.4F;
    ASSERT_TRUE(get(mesh_));
    isNew("padding");
    test::Mesh moved = mesh_;
    moved.positions[7].x = std::nextafter(moved.positions[7].x, 1.0F);
    ASSERT_TRUE(get(moved));
    isNew("one vertex by the least there is");
    test::Mesh turned = mesh_;
    std::swap(turned.indices[0], turned.indices[1]);
    ASSERT_TRUE(get(turned));
    isNew("one triangle's sense");
    const test::Mesh box = test::makeBox(vec3(0), vec3(1));
    ASSERT_TRUE(get({mesh_.view(), box.view()}));
    isNew("two meshes");
    ASSERT_TRUE(get({box.view(), mesh_.view()}));
    isNew("in the other order");
}

TEST_F(VoxelCache, ADamagedFileIsBakedAgain) {
    expectRight(0);
    const fs::path path = onlyFile();
    const auto size = fs::file_size(path);
    const auto spoil = [&](const char* what, const auto& how) {
        SCOPED_TRACE(what);
        how();
        expectRight(1);
        EXPECT_EQ(fs::file_size(onlyFile()), size) << "it was repaired";
        expectRight(0);
    };
    spoil("cut off", [&] { fs::resize_file(path, size / 2); });
    spoil("empty", [&] { fs::resize_file(path, 0); });
    spoil("of another kind", [&] { std::ofstream(path) << "no voxels at all"; });
    spoil("one byte", [&] { std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(500).put('\x55'); });
    spoil("without a band", [&] {
        Result<VoxelFile> file = readVoxelFile(path.string());
        file->band.reset();
        ASSERT_TRUE(writeVoxelFile(path.string(), *file));
    });
    spoil("with a band too narrow for particles", [&] {
        Result<VoxelFile> file = readVoxelFile(path.string());
        file->band->band *= 0.25F;
        for (float& d : file->band->distance) d *= 0.25F;
        ASSERT_TRUE(writeVoxelFile(path.string(), *file));
    });
}

// An intact file of other voxels under this name.
TEST_F(VoxelCache, AnEntryOfAnotherMeshIsBakedAgain) {
    const test::Mesh other = test::makeBox(vec3(-0.3F), vec3(0.7F));
    ASSERT_TRUE(get(other));
    const fs::path theirs = onlyFile();
    expectRight(0);
    for (const fs::path& path : files())
        if (path != theirs) fs::copy_file(theirs, path, fs::copy_options::overwrite_existing);
    expectRight(1);
    expectRight(0);

    // The same mesh at another resolution, and voxels of a file that states no key.
    fs::remove(theirs);
    const fs::path mine = onlyFile();
    Result<VoxelFile> coarse = readVoxelFile(mine.string());
    ASSERT_TRUE(coarse) << coarse.error().message;
    coarse->key.clear();
    ASSERT_TRUE(writeVoxelFile(mine.string(), *coarse));
    expectRight(1);
    options_.resolution = 17;
    expectRight(0);
    for (const fs::path& path : files())
        if (path != mine) fs::copy_file(mine, path, fs::copy_options::overwrite_existing);
    expectRight(1);
    EXPECT_EQ(files().size(), 2U);
}

// Permissions of a file, as ls -l shows them.
unsigned modeOf(const fs::path& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 0777U : 0U;
}

constexpr uid_t kSomebody = 54321;

TEST_F(VoxelCache, OnlyThisUserCanReadAndWriteIt) {
    const mode_t before = ::umask(0);
    expectRight(0);
    ::umask(before);
    EXPECT_EQ(modeOf(folder()), 0700U);
    EXPECT_EQ(modeOf(folder().parent_path()), 0700U);
    EXPECT_EQ(modeOf(onlyFile()), 0600U);
    // A folder that others could read, as older versions made it.
    ASSERT_EQ(::chmod(folder().c_str(), 0755), 0);
    expectRight(0);
    EXPECT_EQ(modeOf(folder()), 0700U);
}

TEST_F(VoxelCache, AnEntryThatOthersMayHaveWrittenIsBakedAgain) {
    expectRight(0);
    const fs::path path = onlyFile();
    const auto distrusted = [&](const char* what) {
        SCOPED_TRACE(what);
        expectRight(1);
        EXPECT_EQ(modeOf(onlyFile()), 0600U);
        expectRight(0);
    };
    for (const mode_t mode : {0666U, 0620U, 0602U}) {
        ASSERT_EQ(::chmod(path.c_str(), mode), 0);
        distrusted("others may write");
    }
    if (::geteuid() == 0) {  // only root can give a file away
        ASSERT_EQ(::chown(path.c_str(), kSomebody, kSomebody), 0);
        distrusted("another user's");
    }
    const fs::path elsewhere = scratch_.path() / "elsewhere.rvox";
    fs::rename(path, elsewhere);
    fs::create_symlink(elsewhere, path);
    distrusted("a link");
    EXPECT_FALSE(fs::is_symlink(path));
    fs::remove(path);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    distrusted("a pipe");
}

TEST_F(VoxelCache, AFolderThatOthersMayWriteToIsNotUsed) {
    expectRight(0);
    const fs::path path = onlyFile();
    // A wrong field, which would be believed if it were read.
    Result<VoxelFile> file = readVoxelFile(path.string());
    ASSERT_TRUE(file);
    ASSERT_NE(file->band->distance[5], 0.0F);
    file->band->distance[5] = 0;
    ASSERT_TRUE(writeVoxelFile(path.string(), *file));
    const auto refused = [&](const std::string& mentions) {
        const Result<VoxelField> got = get(mesh_), baked = bake(mesh_);
        ASSERT_TRUE(got) << got.error().message;
        EXPECT_TRUE(got->distance == baked->distance);
        ASSERT_EQ(notices_.size(), 1U);
        EXPECT_NE(notices_[0].find(mentions), std::string::npos) << notices_[0];
        EXPECT_NE(notices_[0].find("XDG_CACHE_HOME"), std::string::npos) << notices_[0];
        notices_.clear();
        EXPECT_EQ(readVoxelFile(path.string())->band->distance[5], file->band->distance[5]) << "nothing was written";
    };
    for (const fs::path& open : {folder(), folder().parent_path()}) {
        for (const mode_t mode : {0777U, 0773U, 0702U}) {
            ASSERT_EQ(::chmod(open.c_str(), mode), 0);
            refused(open.string() + " may be written to by other users");
        }
        ASSERT_EQ(::chmod(open.c_str(), 0700), 0);
        if (::geteuid() != 0) continue;
        ASSERT_EQ(::chown(open.c_str(), kSomebody, kSomebody), 0);
        refused(open.string() + " belongs to another user");
        ASSERT_EQ(::chown(open.c_str(), 0, 0), 0);
    }
    ASSERT_TRUE(get(mesh_));
    EXPECT_TRUE(notices_.empty()) << "its own folder is used again";
    // With an umask of 002 programs made folders that a user's group may write to.
    for (const fs::path& open : {folder(), folder().parent_path()}) {
        ASSERT_EQ(::chmod(open.c_str(), 0775), 0);
        ASSERT_TRUE(get(mesh_));
        EXPECT_TRUE(notices_.empty());
        EXPECT_EQ(fs::status(open).permissions() & fs::perms::group_write, fs::perms::none);
    }
}

TEST_F(VoxelCache, ACacheThatCannotBeWrittenIsANotice) {
    const Variable file("XDG_CACHE_HOME", scratch_.file("blocker", "a file, not a folder"));
    expectRight(1);
    const Variable device("XDG_CACHE_HOME", "/proc");
    expectRight(1);
    EXPECT_EQ(scratch_.contents(), std::vector<std::string>{"blocker"});
}

TEST_F(VoxelCache, AFolderInTheFilesPlaceIsANotice) {
    expectRight(0);
    const fs::path path = onlyFile();
    fs::remove(path);
    fs::create_directory(path);
    const Result<VoxelField> got = get(mesh_);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_GE(notices_.size(), 1U);
}

TEST_F(VoxelCache, AFullDiskIsANotice) {
    struct rlimit before {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{512, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const Result<VoxelField> got = get(mesh_);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    ASSERT_TRUE(got) << got.error().message;
    EXPECT_EQ(notices_.size(), 1U);
    EXPECT_TRUE(files().empty()) << "no partial file remains";
}

TEST_F(VoxelCache, TheVariablesChooseTheFolder) {
    const Variable userHome("HOME", "/home/somebody");
    EXPECT_EQ(voxelCacheFolder(), folder().string());
    for (const std::optional<std::string>& none :
         {std::optional<std::string>(), std::optional<std::string>(""), std::optional<std::string>("relative")}) {
        const Variable cache("XDG_CACHE_HOME", none);
        EXPECT_EQ(voxelCacheFolder(), "/home/somebody/.cache/rivulet/voxels");
        const Variable noHome("HOME", std::nullopt);
        EXPECT_EQ(voxelCacheFolder(), "");
        expectRight(0);
    }
    EXPECT_TRUE(files().empty());
}

TEST_F(VoxelCache, ErrorsAreThoseOfTheBaker) {
    test::Mesh broken = mesh_;
    broken.indices[4] = 99999;
    const Result<VoxelField> got = get(broken), baked = bake(broken);
    ASSERT_FALSE(got);
    EXPECT_EQ(got.error().message, baked.error().message);
    EXPECT_TRUE(files().empty());

    expectRight(0);
    options_.memoryLimit = 1000;
    const Result<VoxelField> tooMuch = get(mesh_);
    ASSERT_FALSE(tooMuch) << "a cached field takes memory too";
    EXPECT_EQ(tooMuch.error().message, bake(mesh_).error().message);
    EXPECT_TRUE(notices_.empty());
}

TEST_F(VoxelCache, ConcurrentUseGivesTheSameField) {
    const Result<VoxelField> baked = bake(mesh_);
    std::vector<std::thread> threads;
    std::atomic<int> right = 0;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            const MeshView view = mesh_.view();
            for (int k = 0; k < 20; ++k) {
                std::error_code ignored;
                for (const fs::path& path : files())
                    if (k % 3 == 0) fs::remove(path, ignored);
                const Result<VoxelField> got = cachedVoxelField({&view, 1}, options_, {});
                right += got && got->distance == baked->distance && got->surface.bits == baked->surface.bits ? 1 : 0;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right, 80);
    EXPECT_EQ(onlyFile().extension(), ".rvox");
}

TEST_F(VoxelCache, TheLeastRecentlyUsedFileIsRemoved) {
    fs::create_directories(folder());
    const auto now = fs::file_time_type::clock::now();
    const auto make = [&](const char* name, size_t bytes, std::chrono::minutes age) {
        std::ofstream(folder() / name).close();
        fs::resize_file(folder() / name, bytes);  // takes no space on the disk
        fs::last_write_time(folder() / name, now - age);
    };
    const size_t most = kVoxelCacheBytes * 6 / 10;
    make("older.rvox", most, std::chrono::minutes(30));
    make("newer.rvox", most, std::chrono::minutes(20));
    make("crashed.rvox.1-0.tmp", 10, std::chrono::minutes(600));
    make("at_work.rvox.2-0.tmp", 10, std::chrono::minutes(0));
    make("notes.txt", 10, std::chrono::minutes(6000));
    expectRight(0);
    EXPECT_FALSE(fs::exists(folder() / "older.rvox"));
    EXPECT_TRUE(fs::exists(folder() / "newer.rvox"));
    EXPECT_FALSE(fs::exists(folder() / "crashed.rvox.1-0.tmp"));
    EXPECT_TRUE(fs::exists(folder() / "at_work.rvox.2-0.tmp"));
    EXPECT_TRUE(fs::exists(folder() / "notes.txt")) << "not a cache file";
    EXPECT_EQ(files().size(), 4U);

    // Reading counts as use.
    make("newer.rvox", most, std::chrono::minutes(20));
    for (const fs::path& path : files())
        if (path.stem().string().size() == 32) fs::last_write_time(path, now - std::chrono::minutes(60));
    expectRight(0);
    make("another.rvox", most, std::chrono::minutes(10));
    options_.resolution = 17;
    expectRight(0);
    EXPECT_FALSE(fs::exists(folder() / "newer.rvox"));
    options_.resolution = 16;
    EXPECT_EQ(files().size(), 5U) << "both fields, another.rvox and the two foreign files";
}

}  // namespace
}  // namespace rivulet::voxel_cache_test
