#include "engine/scene/import_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <new>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/descriptor.h"
#include "engine/core/readable_bytes.h"
#include "engine/scene/model_wire.h"

namespace rivulet {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kName = "rivulet_import";

// The file that is read, for errors: "the mesh 'a.obj' ..."
struct Subject {
    const std::string& as;
    const std::string& path;

    Error error(std::string_view phrase) const {
        return badInput(fmt::format("the {} '{}' {}", as == "image" ? "image" : "mesh", path, phrase));
    }
};

Error notStarted(const std::string& program, int why) {
    return failed(fmt::format("the program {}, which reads models and pictures, cannot be started: {}; install Rivulet again", program,
                              std::generic_category().message(why)));
}

// A running child and the end of the pipe that it writes to. A child that is still running is killed.
class Child {
  public:
    Child(pid_t pid, int output) : pid_(pid), output_(output) {}
    ~Child() {
        ::close(output_);
        if (pid_ <= 0) return;
        int status = 0;
        (void)::kill(pid_, SIGKILL);
        while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
        }
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    enum class End { closed, late, tooLong };
    // Receives all that the child writes until it closes its end.
    End read(std::string& answer, Clock::time_point deadline, size_t most) const {
        for (size_t filled = 0;;) {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
            if (left <= 0) return End::late;
            pollfd ready{output_, POLLIN, 0};
            const int polled = ::poll(&ready, 1, static_cast<int>(std::min<long long>(left, 1000)));
            if (polled == 0 || (polled < 0 && errno == EINTR)) continue;
            if (filled == answer.size()) answer.resize(filled + std::clamp(filled, kFirst, kStep));
            const ssize_t got = ::read(output_, answer.data() + filled, answer.size() - filled);
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) {
                answer.resize(filled);
                return End::closed;
            }
            filled += static_cast<size_t>(got);
            if (filled > most) return End::tooLong;
        }
    }
    // The status of waitpid; 0 if the process collects its children elsewhere. Empty: it has closed its output and does not end.
    std::optional<int> wait(Clock::time_point deadline) {
        int status = 0;
        pid_t done = 0;
        while ((done = ::waitpid(pid_, &status, WNOHANG)) == 0 || (done < 0 && errno == EINTR)) {
            if (Clock::now() >= deadline) return std::nullopt;
            ::usleep(200);
        }
        pid_ = -1;
        return done > 0 ? status : 0;
    }

  private:
    static constexpr size_t kFirst = size_t{1} << 16U, kStep = size_t{64} << 20U;
    pid_t pid_;
    int output_;
};

// The environment of the child: this one, and large pages for its memory. assimp 5.2 fills 16 MB for any OBJ file, and 4,096 pages of 4 kB
// cost 53 ms of processor time on the machine of decision 29.
std::vector<char*> childEnvironment() {
    static char largePages[] = "GLIBC_TUNABLES=glibc.malloc.hugetlb=1";
    std::vector<char*> all;
    bool given = false;
    for (char** variable = environ; variable != nullptr && *variable != nullptr; ++variable) {
        given = given || std::string_view(*variable).starts_with("GLIBC_TUNABLES=");
        all.push_back(*variable);
    }
    if (!given) all.push_back(largePages);
    all.push_back(nullptr);
    return all;
}

// 0, or an error number. The child has /dev/null as its input and error output, `output` as its output, and no other open file.
int start(const std::string& program, const std::vector<std::string>& arguments, int output, pid_t& pid) {
    std::vector<char*> words;
    words.push_back(const_cast<char*>(program.c_str()));
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    const std::vector<char*> environment = childEnvironment();
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);  // first: `output` may be one of the three
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    sigset_t all{}, none{};
    sigfillset(&all);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    const int error = ::posix_spawn(&pid, program.c_str(), &files, &attributes, words.data(), environment.data());
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    return error;
}

constexpr const char* kTooSlow =
    "takes too long to read; the file is damaged, or has faces of very many corners or too many faces: simplify it, or export it again";

// Why a child with this status has not answered; null: it has.
const char* deathOf(int status) {
    if (status == 0) return nullptr;
    switch (WIFSIGNALED(status) ? WTERMSIG(status) : 0) {
        case SIGXCPU:
            return kTooSlow;
        case SIGINT:
        case SIGTERM:
        case SIGHUP:
            return "was not read: its reader was interrupted";
        case SIGKILL:
            return "was not read: its reader was killed, perhaps because memory was short; close other programs, or simplify it";
        default:
            return "cannot be read: its reader crashed; the file is damaged or nested too deeply: export it again, for example as OBJ";
    }
}

}  // namespace

std::string importProgram() {
    std::error_code error;
    const fs::path own = fs::read_symlink("/proc/self/exe", error);
    if (own.empty()) return {};
    const fs::path program = own.parent_path() / kName;
    return ::access(program.c_str(), X_OK) == 0 ? program.string() : std::string();
}

Result<Model> importThrough(const std::string& program, const std::string& as, const std::string& path, const ImportLimits& limits) try {
    const Subject about{as, path};
    if (program.empty())
        return failed(
            fmt::format("models and pictures are read by the program {}, which is not beside this program; install Rivulet again", kName));
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return notStarted(program, errno);
    Descriptor reading(ends[0]), writing(ends[1]);
    (void)::fcntl(writing.get(), F_SETPIPE_SZ, 1 << 20);  // fewer switches between the two processes
    const auto deadline = Clock::now() + limits.wall;
    pid_t pid = -1;
    const int error = start(program, {as, path, std::to_string(limits.memory), std::to_string(limits.seconds)}, writing.get(), pid);
    (void)writing.close();
    if (error != 0) return notStarted(program, error);
    Child child(pid, reading.release());
    std::string answer;
    const Child::End end = child.read(answer, deadline, limits.answer);
    if (end == Child::End::late) return about.error(kTooSlow);
    if (end == Child::End::tooLong)
        return about.error(fmt::format("takes more than {} once it is read; simplify it", readableBytes(limits.answer)));
    const std::optional<int> status = child.wait(deadline);
    if (!status) return about.error(kTooSlow);
    if (const char* why = deathOf(*status)) return about.error(why);
    Result<Model> model = receiveModel(std::as_bytes(std::span(answer)));
    if (model || (as == "image" && model.error().message.find(path) != std::string::npos)) return model;  // a whole sentence already
    return about.error(model.error().message);
} catch (const std::bad_alloc&) {
    return Subject{as, path}.error("needs more memory than there is; simplify it");
}

}  // namespace rivulet
