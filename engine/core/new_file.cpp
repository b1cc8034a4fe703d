#include "engine/core/new_file.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <mutex>

#include "engine/core/file_system.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

// The names of temporary files. Global, because a signal handler takes no argument.
using Place = std::atomic<const char*>;
using Text = std::unique_ptr<char[]>;
constexpr size_t kMost = 256;  // of those that a signal removes
std::array<Place, kMost> temporaries = {};
std::atomic<ProcessId> owner = 0;  // of the list: a process that was forked must not remove these files
std::mutex changing;               // of `owner`, among threads
static_assert(Place::is_always_lock_free && std::atomic<ProcessId>::is_always_lock_free);

// Nothing: all places are taken.
Place* enlist(const char* name) {
    const ProcessId self = processId();
    const std::lock_guard lock(changing);
    if (owner.exchange(self) != self)  // a forked process begins anew
        for (Place& place : temporaries) place = nullptr;
    for (Place& place : temporaries) {
        const char* none = nullptr;
        if (place.compare_exchange_strong(none, name)) return &place;
    }
    return nullptr;
}

// A hidden name, which no pattern of output files matches. It keeps the extension: ffmpeg chooses the format by it.
std::string nameBeside(const fs::path& target, int attempt) {
    constexpr size_t kEnd = 100;  // bytes: the whole must not be too long for a name
    std::string end = target.filename().string();
    if (end.size() > kEnd) end.erase(0, end.size() - kEnd);
    return (target.parent_path() / fmt::format(".rivulet-{}-{}-{}", processId(), attempt, end)).string();
}

}  // namespace

struct NewFile::Impl {
    std::string path;        // as given
    std::string target;      // its links followed
    std::string temporary;   // empty: the file has its name
    Text listed;             // `temporary`, for the signal handler
    Place* place = nullptr;  // of `listed`
    Descriptor file;
    bool older = false;  // a file of the name exists
    int error = 0;       // of a write that failed

    ~Impl() {
        if (temporary.empty()) return;
        (void)file.close();  // Windows removes no open file
        removeFile(temporary.c_str());
        forget();
    }

    void forget() {
        const char* name = listed.get();
        if (place != nullptr && !place->compare_exchange_strong(name, nullptr)) (void)listed.release();  // the handler is reading it
        place = nullptr;
        listed.reset();
        temporary.clear();
    }

    // 0, or errno.
    int create(unsigned mode) {
        for (int attempt = 0;; ++attempt) {
            temporary = nameBeside(target, attempt);
            listed = std::make_unique<char[]>(temporary.size() + 1);
            temporary.copy(listed.get(), temporary.size());
            place = enlist(listed.get());
            file = openDescriptor(temporary, O_WRONLY | O_CREAT | O_EXCL, mode);
            if (file.valid()) break;
            const int failure = errno;
            forget();
            if (failure != EEXIST) return failure;
        }
        if (older) (void)setMode(file, mode);
        return 0;
    }
};

std::optional<int> descriptorOf(const std::string& path) {
    if (path == "/dev/stdout") return 1;
    if (path == "/dev/stderr") return 2;
    for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
        if (!path.starts_with(folder)) continue;
        int number = 0;
        const char* const end = path.data() + path.size();
        const auto [at, error] = std::from_chars(path.data() + folder.size(), end, number);
        if (error == std::errc() && at == end && number >= 0) return number;
    }
    return std::nullopt;
}

NewFile::NewFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NewFile::NewFile(NewFile&&) noexcept = default;
NewFile& NewFile::operator=(NewFile&&) noexcept = default;
NewFile::~NewFile() = default;

Error NewFile::cannotWrite(int error, std::string_view part) const {
    return failed(fmt::format("{}{}{} cannot be written: {}{}", impl_->path, part.empty() ? "" : ": ", part,
                              error == ENOENT ? "its folder is gone" : reasonOf(error),
                              impl_->older ? "; the older file is unchanged" : ""));
}

Result<NewFile> NewFile::open(const std::string& path, unsigned mode) {
    NewFile made(std::make_unique<Impl>());
    Impl& to = *made.impl_;
    to.path = to.target = path;
    const auto refused = [&](std::string_view why) { return failed(fmt::format("{} cannot be written: {}", path, why)); };
    if (const std::optional<int> open = descriptorOf(path)) {
        to.file = duplicateOf(*open);
        return to.file.valid() ? Result<NewFile>(std::move(made)) : refused(reasonOf(errno));
    }
    const FileFacts facts = factsOf(path);
    const bool exists = facts.kind != FileFacts::Kind::none;
    if (!exists && facts.error != ENOENT) return refused(reasonOf(facts.error));
    if (facts.kind == FileFacts::Kind::folder) return refused(reasonOf(EISDIR));
    if (exists && facts.kind != FileFacts::Kind::regular) {
        to.file = openDescriptor(path, O_WRONLY);
        return to.file.valid() ? Result<NewFile>(std::move(made)) : refused(reasonOf(errno));
    }
    const fs::path folder = fs::path(path).parent_path();
    if (fs::path(path).filename().empty()) return refused("it is the name of a folder");
    if (exists) {
        const std::optional<std::string> whole = followed(path);
        if (!whole) return refused(reasonOf(errno));
        to.target = *whole;
        if (const int error = mayWrite(path); error != 0) return refused(reasonOf(error));
        to.older = true;
    }
    if (const int error = to.create(exists ? facts.mode : mode); error != 0) {
        std::error_code ignored;
        if (error == ENOENT)
            return refused(folder.empty() || fs::exists(folder, ignored) ? "no file can be made in its folder"
                                                                         : "its folder does not exist");
        return refused(reasonOf(error));
    }
    return made;
}

Status NewFile::write(std::string_view bytes, std::string_view part) {
    Impl& to = *impl_;
    while (to.error == 0 && !bytes.empty()) {
        const std::ptrdiff_t written = writeSome(to.file, bytes.data(), bytes.size());
        if (written >= 0)
            bytes.remove_prefix(static_cast<size_t>(written));
        else
            to.error = errno;
    }
    return to.error == 0 ? ok() : Status(cannotWrite(to.error, part));
}

Status NewFile::commit(Sync sync) {
    Impl& to = *impl_;
    const int unsynced = to.error == 0 && sync == Sync::disk ? syncToDisk(to.file) : 0;
    if (unsynced != EINVAL && unsynced != ENOTSUP) to.error = std::max(to.error, unsynced);  // a pipe has no disk
    if (const int closed = to.file.close(); closed != 0 && to.error == 0) to.error = closed;
    if (to.error == 0 && !to.temporary.empty()) {
        to.error = replaceFile(to.temporary, to.target);
        if (to.error == 0) to.forget();
    }
    if (to.error != 0) return cannotWrite(to.error);
    if (sync == Sync::disk) syncFolderOf(to.target);
    return ok();
}

void NewFile::publish() {
    Impl& to = *impl_;
    if (to.temporary.empty() || to.older || to.error != 0) return;
    if (nameFile(to.temporary, to.target) == 0) to.forget();  // a file system that cannot keeps the temporary name
}

const std::string& NewFile::name() const { return impl_->temporary.empty() ? impl_->target : impl_->temporary; }

void removeTemporaryFiles() noexcept {
    if (owner != processId()) return;
    for (Place& place : temporaries)
        if (const char* name = place.exchange(nullptr); name != nullptr) removeFile(name);
}

}  // namespace rivulet
