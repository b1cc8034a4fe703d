#include "tests/unit/program_runner.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

namespace rivulet::testing {

namespace fs = std::filesystem;

namespace {

std::string textOf(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

}  // namespace

Outcome runCommand(const std::vector<std::string>& words, const RunOptions& options) {
    Scratch scratch;
    std::string out = options.stdoutFile.empty() ? scratch.file("out") : options.stdoutFile, err = scratch.file("err");
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    auto start = std::chrono::steady_clock::now();
    pid_t child = fork();
    if (child == 0) {
        for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(variable);
        for (const auto& [name, value] : options.environment)
            value.empty() ? unsetenv(name.c_str()) : setenv(name.c_str(), value.c_str(), 1);
        if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
        dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
        dup2(open(out.c_str(), O_WRONLY | (options.stdoutFile.empty() ? O_CREAT | O_TRUNC : 0), 0600), STDOUT_FILENO);
        dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
        if (options.before) options.before();
        execvp(argv[0], argv.data());
        _exit(127);
    }
    int status = 0;
    struct rusage usage = {};
    while (wait4(child, &status, WNOHANG, &usage) == 0) {
        if (options.whileRunning)
            if (int signal = options.whileRunning(child); signal != 0) kill(child, signal);
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    Outcome outcome;
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    outcome.peakKiB = usage.ru_maxrss;
    if (options.stdoutFile.empty()) outcome.out = textOf(out);
    outcome.err = textOf(err);
    return outcome;
}

Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options) {
    std::vector<std::string> words = {RIVULET_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return runCommand(words, options);
}

Scratch::Scratch() {
    std::string name = (fs::temp_directory_path() / "rivulet-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no folder for the test could be made: " << name;
    path_ = name;
}

Scratch::~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string Scratch::file(const std::string& name, const std::string& text) const {
    fs::path path = path_ / name;
    if (!text.empty()) std::ofstream(path, std::ios::binary) << text;
    return path.string();
}

std::string Scratch::text(const std::string& file) const {
    EXPECT_TRUE(fs::is_regular_file(path_ / file)) << file;
    return textOf(path_ / file);
}

std::vector<std::string> Scratch::contents() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_)) names.push_back(fs::relative(entry.path(), path_).string());
    std::sort(names.begin(), names.end());
    return names;
}

RunOptions in(const Scratch& scratch) {
    RunOptions options;
    options.folder = scratch.path();
    return options;
}

std::string smallScene(const std::string& more) {
    return R"({"name": "small", "duration": 0.1, "fluid": {"spacing": 0.02, "box": {"min": [0, 0, 0], "max": [0.4, 0.4, 0.4]},
        "blocks": [{"min": [0.05, 0.05, 0.05], "max": [0.2, 0.2, 0.15]}]})" +
           (more.empty() ? "" : ", " + more) + "}\n";
}

size_t linesIn(const std::string& text) { return static_cast<size_t>(std::count(text.begin(), text.end(), '\n')); }

void expectRefusal(const Outcome& outcome, int code, const std::string& mentions) {
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("rivulet: ")) << outcome.err;
    EXPECT_EQ(linesIn(outcome.err), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find(mentions), std::string::npos) << "'" << mentions << "' is not in: " << outcome.err;
}

}  // namespace rivulet::testing
