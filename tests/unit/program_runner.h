// Runs the built program as a person would: arguments in, exit code and text out.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rivulet::testing {

struct Outcome {
    int code = -1;  // exit status; 128 + signal when a signal ended it
    std::string out, err;
    double seconds = 0;
    long peakKiB = 0;  // largest resident memory
};

struct RunOptions {
    std::filesystem::path folder;                    // working directory; empty: this one
    std::map<std::string, std::string> environment;  // set on top; an empty value takes the variable away
    std::function<int(pid_t)> whileRunning;          // called every 10 ms with the process; returns a signal to send, or 0
    std::string stdoutFile;                          // empty: captured
    std::function<void()> before = {};               // called in the new process before the program starts
};

// There is no display for the program unless `environment` gives one.
Outcome runProgram(const std::vector<std::string>& arguments, const RunOptions& options = {});
Outcome runCommand(const std::vector<std::string>& words, const RunOptions& options = {});

// A folder of its own, deleted with everything in it.
class Scratch {
  public:
    Scratch();
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::string file(const std::string& name, const std::string& text = {}) const;  // written when `text` is not empty; its path
    std::string text(const std::string& file) const;                                // a file's bytes; a failure and "" if there is none
    std::vector<std::string> contents() const;                                      // relative, sorted, hidden ones too

  private:
    std::filesystem::path path_;
};

RunOptions in(const Scratch& scratch);  // with its folder as the working directory

// A scene of some 300 particles that steps in a blink: a block in the air in a 0.4 m box.
std::string smallScene(const std::string& more = {});

size_t linesIn(const std::string& text);

// It ended with `code`, wrote nothing to stdout, and one line to stderr that begins with "rivulet: " and holds `mentions`.
void expectRefusal(const Outcome& outcome, int code, const std::string& mentions);

}  // namespace rivulet::testing
