#include "demos/rivulet/sweep_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "engine/core/descriptor.h"

namespace rivulet {

namespace {

// The program of a process that has just been forked. Only calls that are safe in a handler of signals.
[[noreturn]] void becomeProgram(const NewProcess& process, const char* program, char* const* words, pid_t parent) {
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent) _exit(127);
    if (process.group && ::setpgid(0, 0) != 0) _exit(127);
    sigset_t none;
    sigemptyset(&none);
    (void)::sigprocmask(SIG_SETMASK, &none, nullptr);
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    const int output = process.output >= 0 ? process.output : nothing;
    if (nothing < 0 || ::dup2(process.input >= 0 ? process.input : nothing, STDIN_FILENO) < 0 || ::dup2(output, STDOUT_FILENO) < 0 ||
        ::dup2(process.errors >= 0 ? process.errors : output, STDERR_FILENO) < 0)
        _exit(127);
    if (process.kept >= 0) (void)::fcntl(process.kept, F_SETFD, 0);
    if (!process.folder.empty() && ::chdir(process.folder.c_str()) != 0) _exit(127);
    ::execv(program, words);
    constexpr char kWhy[] = "rivulet: the program cannot be started\n";
    if (::write(STDERR_FILENO, kWhy, sizeof kWhy - 1) < 0) _exit(127);
    _exit(127);
}

}  // namespace

Result<pid_t> startProcess(const NewProcess& process) {
    const bool other = process.words.front().find('/') != std::string::npos;
    std::vector<std::string> words = process.words;
    if (!other) words.insert(words.begin(), "rivulet");
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const pid_t parent = ::getpid(), child = ::fork();
    if (child == 0) becomeProgram(process, other ? words.front().c_str() : "/proc/self/exe", pointers.data(), parent);
    if (child < 0) return failed(fmt::format("no process can be started: {}", reasonOf(errno)));
    if (process.group) (void)::setpgid(child, child);  // here too: a signal may be sent to the group before the child has made it
    return child;
}

int exitStatusOf(int waited) { return WIFEXITED(waited) ? WEXITSTATUS(waited) : 128 + WTERMSIG(waited); }

std::string lastLine(const std::string& text) {
    size_t end = text.find_last_not_of("\r\n \t");
    if (end == std::string::npos) return "";
    size_t begin = text.find_last_of("\r\n", end);
    begin = begin == std::string::npos ? 0 : begin + 1;
    constexpr size_t kLongest = 300;
    return text.substr(begin, std::min(end + 1 - begin, kLongest));
}

}  // namespace rivulet
