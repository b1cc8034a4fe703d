// What every verb shares: exit codes, the reading of arguments, plain sentences for mistakes, a progress bar.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "engine/core/table.h"

namespace rivulet {

enum ExitCode : int { kDone = 0, kFailed = 1, kBadUse = 2, kInterrupted = 130 };

using Arguments = std::vector<std::string>;  // after the verb

struct Verb {
    const char* name;
    const char* doc;
    int (*run)(const Arguments&);  // an ExitCode
};
Table<Verb> verbs();

int runVerb(const Arguments& arguments);
int listVerb(const Arguments& arguments);
int infoVerb(const Arguments& arguments);
int voxelizeVerb(const Arguments& arguments);
int benchVerb(const Arguments& arguments);
int validateVerb(const Arguments& arguments);
int chartVerb(const Arguments& arguments);
int exportVerb(const Arguments& arguments);

// "rivulet: sentence" on stderr; returns the exit code that the error's fault asks for.
int report(const Error& error);

// What a verb takes. CLI11 reads it, behind this one interface: its templates would cost every verb some seconds of compiling.
class ArgumentReader {
  public:
    ArgumentReader(std::string_view verb, std::string_view doc);
    ~ArgumentReader();
    ArgumentReader(const ArgumentReader&) = delete;
    ArgumentReader& operator=(const ArgumentReader&) = delete;

    // By position; `name` as help shows it.
    void positional(const std::string& name, const std::string& doc, std::string& value, bool required);
    void positional(const std::string& name, const std::string& doc, std::vector<std::string>& values);
    // By name; `type` as help shows it: "FILE", "N". A text that is given must not be empty.
    void flag(const std::string& name, const std::string& doc, bool& value);
    void option(const std::string& name, const std::string& type, const std::string& doc, std::string& value);
    void option(const std::string& name, const std::string& type, const std::string& doc,
                std::vector<std::string>& values);  // one each time
    void option(const std::string& name, const std::string& type, const std::string& doc, std::optional<int>& value, int min, int max,
                bool strict = true);  // not strict: a whole number beyond them is let through, for the verb to judge
    void option(const std::string& name, const std::string& type, const std::string& doc, std::optional<double>& value, double min,
                double max);
    void exclude(const std::string& name, const std::string& other);  // not both
    void footer(const std::string& text);                             // below the help

    // A value: the exit code to leave with, since help was asked for (0) or the arguments make no sense (2, said on stderr
    // with the nearest option there is).
    std::optional<int> read(const Arguments& arguments);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Nothing when `word` is among `names`; else "unknown WHAT 'word'; did you mean 'near'?", or all names where none is near.
Status checkWord(std::string_view what, std::string_view word, std::span<const std::string> names);

// "1280x720" -> {1280, 720}; each 1 to 16384.
Result<std::pair<int, int>> parseSize(const std::string& text);

// A bar on stderr, drawn only when that is a terminal, at most ten times a second.
class Progress {
  public:
    explicit Progress(std::string what);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void show(double share, std::string_view beside = {});  // share of the work done, 0..1

  private:
    std::string what_;
    bool terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace rivulet
