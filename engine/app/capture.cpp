#include "engine/app/capture.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stb_image_write.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

#include "engine/core/assert.h"
#include "engine/core/descriptor.h"
#include "engine/core/file.h"
#include "engine/core/new_file.h"

namespace rivulet {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kStoppedFor{30};  // that ffmpeg may be: somebody may let it go on

bool isOrdinaryTarget(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return !fs::exists(status) || fs::is_regular_file(status);
}

}  // namespace

Status writePng(const std::string& path, std::span<const uint8_t> rgba, int width, int height) {
    size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
    ASSERT(width > 0 && height > 0 && rgba.size() == 4 * pixels, "writePng takes 4 bytes a pixel, at least one pixel");
    std::vector<uint8_t> rgb(3 * pixels);
    for (size_t i = 0; i < pixels; ++i) std::memcpy(&rgb[3 * i], &rgba[4 * i], 3);
    std::string bytes;
    auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<char*>(data), static_cast<size_t>(size));
    };
    if (stbi_write_png_to_func(append, &bytes, width, height, 3, rgb.data(), 3 * width) == 0)
        return failed(fmt::format("the picture {} could not be encoded: out of memory", path));
    return writeFileAtomic(path, bytes);
}

Status makeFolder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (!error && !fs::is_directory(path, error) && !error) error = std::make_error_code(std::errc::not_a_directory);
    if (error) return failed(fmt::format("the folder {} cannot be made: {}", path, error.message()));
    return ok();
}

struct VideoWriter::Impl {
    explicit Impl(NewFile into) : file(std::move(into)) {}

    std::string path;
    NewFile file;  // which ffmpeg writes, by its name
    size_t frameBytes = 0;
    uint64_t frames = 0;
    int input = -1;     // our end of ffmpeg's standard input: a socket, since send() can be told not to raise SIGPIPE
    int messages = -1;  // ffmpeg's standard error, kept in memory
    pid_t child = -1;
    std::string broken;  // why, once something failed

    ~Impl() {
        if (input >= 0) ::close(input);
        if (child > 0) {
            ::kill(child, SIGKILL);
            wait();
        }
        if (messages >= 0) ::close(messages);
    }

    // Whether ffmpeg has been stopped (SIGSTOP) for too long, which is then `broken`. `since`: since when it has been, for the next call.
    bool stopped(std::optional<Clock::time_point>& since) {
        siginfo_t info = {};
        const bool now = ::waitid(P_PID, static_cast<id_t>(child), &info, WSTOPPED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
        if (!now) since.reset();
        if (now && !since) since = Clock::now();
        if (!now || Clock::now() - *since < kStoppedFor) return false;
        broken =
            fmt::format("the video {} could not be written: ffmpeg was stopped, and did not go on within {} s", path, kStoppedFor.count());
        return true;
    }

    // Returns when ffmpeg can take more, or has ended. False: it is stopped.
    bool canTake() {
        std::optional<Clock::time_point> since;
        for (pollfd ready{input, POLLOUT, 0}; ::poll(&ready, 1, 500) <= 0;)
            if (stopped(since)) return false;
        return true;
    }

    // Returns when ffmpeg has ended. False: it is stopped.
    bool ends() {
        std::optional<Clock::time_point> since;
        for (siginfo_t info = {};; info = {}) {
            if (::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WSTOPPED | WNOWAIT) != 0 && errno != EINTR) return true;
            if (info.si_pid == child && info.si_code != CLD_STOPPED) return true;
            if (stopped(since)) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    }

    // ffmpeg's exit status; -1 when a signal ended it.
    int wait() {
        int status = 0;
        while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
        child = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    // ffmpeg's last message: the line that names the cause.
    std::string lastMessage() const {
        std::string text(4096, '\0');
        off_t end = ::lseek(messages, 0, SEEK_END);
        off_t from = std::max<off_t>(0, end - static_cast<off_t>(text.size()));
        ssize_t got = ::pread(messages, text.data(), text.size(), from);
        text.resize(got > 0 ? static_cast<size_t>(got) : 0);
        if (text.find("No space left on device") != std::string::npos) return "no space left on device";
        while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
        size_t line = text.find_last_of("\r\n");
        if (line != std::string::npos) text.erase(0, line + 1);
        return text.empty() ? "ffmpeg ended without a message" : text;
    }

    Error failure() {
        if (broken.empty()) broken = fmt::format("the video {} could not be written: {}", path, lastMessage());
        return failed(broken);
    }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

Result<VideoWriter> VideoWriter::open(const std::string& path, int width, int height, int framesPerSecond) {
    ASSERT(width > 0 && height > 0 && framesPerSecond > 0, "a video has a size and a frame rate");
    const bool ordinary = isOrdinaryTarget(path);
    Result<NewFile> file = NewFile::open(path);
    if (!file) return file.error();
    auto impl = std::make_unique<Impl>(std::move(*file));
    impl->path = path;
    impl->frameBytes = 4 * static_cast<size_t>(width) * static_cast<size_t>(height);

    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return failed(fmt::format("no pipe to ffmpeg: {}", reasonOf(errno)));
    impl->input = ends[0];
    impl->messages = ::memfd_create("messages of ffmpeg", MFD_CLOEXEC);
    if (impl->messages < 0) {
        const int error = errno;
        ::close(ends[1]);
        return failed(fmt::format("no memory for the messages of ffmpeg: {}", reasonOf(error)));
    }

    std::string size = fmt::format("{}x{}", width, height), rate = std::to_string(framesPerSecond);
    const std::string target = "file:" + impl->file.name();  // a name may look like an option, or like the address of a server
    std::vector<const char*> words = {"ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pixel_format",
                                      "rgba", "-video_size", size.c_str(), "-framerate", rate.c_str(), "-i", "pipe:0", "-an",
                                      // H.264 with 4:2:0 colour, which every player reads, needs even sides
                                      "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-preset", "veryfast", "-crf", "18",
                                      "-pix_fmt", "yuv420p", "-movflags", "+faststart"};
    if (!ordinary)
        words.insert(words.end(), {"-f", "matroska"});  // a device: it has no ending, and may not seek
    else if (!fs::path(path).has_extension())
        words.insert(words.end(), {"-f", "mp4"});
    words.insert(words.end(), {target.c_str(), nullptr});

    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, impl->messages, STDERR_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    int error = posix_spawnp(&impl->child, "ffmpeg", &files, &attributes, const_cast<char* const*>(words.data()), environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[1]);
    if (error != 0) {
        impl->child = -1;
        return failed(error == ENOENT ? std::string("a video needs ffmpeg, which is not installed (Debian package: ffmpeg)")
                                      : fmt::format("ffmpeg could not be started: {}", reasonOf(error)));
    }
    return VideoWriter(std::move(impl));
}

Status VideoWriter::add(std::span<const uint8_t> rgba) {
    ASSERT(impl_ && impl_->input >= 0, "a VideoWriter takes frames until close()");
    ASSERT(rgba.size() == impl_->frameBytes, "a frame has the size given to open()");
    if (!impl_->broken.empty()) return impl_->failure();
    for (size_t done = 0; done < rgba.size();) {
        ssize_t sent = ::send(impl_->input, rgba.data() + done, rgba.size() - done, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0 && errno == EAGAIN) {
            if (!impl_->canTake()) return impl_->failure();
            continue;
        }
        if (sent < 0) {
            if (errno == EPIPE || errno == ECONNRESET) {
                (void)::shutdown(impl_->input, SHUT_WR);
                if (impl_->ends()) impl_->wait();  // it closed its end: it is ending, and says why
            } else
                impl_->broken = fmt::format("the video {} could not be written: ffmpeg was not reached: {}", impl_->path, reasonOf(errno));
            return impl_->failure();
        }
        done += static_cast<size_t>(sent);
    }
    ++impl_->frames;
    return ok();
}

Status VideoWriter::close() {
    ASSERT(impl_ && impl_->input >= 0, "close() a VideoWriter once");
    ::close(impl_->input);
    impl_->input = -1;
    if (impl_->child > 0) {
        bool empty = impl_->frames == 0;
        if (!empty && !impl_->ends()) return impl_->failure();
        int status = impl_->wait();
        if (empty) return ok();
        // ffmpeg ends with 0 even when the last block did not fit on the disk: what it says on its error channel is believed instead.
        if (status != 0 || ::lseek(impl_->messages, 0, SEEK_END) > 0) return impl_->failure();
    }
    if (!impl_->broken.empty()) return impl_->failure();
    return impl_->file.commit();
}

}  // namespace rivulet
