// Shared by all verbs: exit codes, parsing of arguments, messages and output, a progress bar.
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
#include "fluid/session/opening_progress.h"

namespace rivulet {

enum ExitCode : int { kDone = 0, kFailed = 1, kBadUse = 2 };  // or 128 + the signal that interrupted: Graceful::status()

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
int flowCheckVerb(const Arguments& arguments);
int voxelizeVerb(const Arguments& arguments);
int benchVerb(const Arguments& arguments);
int validateVerb(const Arguments& arguments);
int chartVerb(const Arguments& arguments);
int exportVerb(const Arguments& arguments);
int sweepVerb(const Arguments& arguments);
int joinVerb(const Arguments& arguments);

// Prints "rivulet: MESSAGE" on stderr, made fit for a terminal. Returns kBadUse for Fault::badInput, else kFailed.
int report(const Error& error);

// Writes to stdout what was printed. Throws std::system_error if that fails, so that long work does not go on unseen; main() reports it.
void flushOutput();

// The arguments and options of a verb. Only cli.cpp includes CLI11, which parses them: its templates take seconds to compile.
class ArgumentReader {
  public:
    ArgumentReader(std::string_view verb, std::string_view doc);
    ~ArgumentReader();
    ArgumentReader(const ArgumentReader&) = delete;
    ArgumentReader& operator=(const ArgumentReader&) = delete;

    // Arguments by position; `name` is the name in the help text.
    void positional(const std::string& name, const std::string& doc, std::string& value, bool required);
    void positional(const std::string& name, const std::string& doc, std::vector<std::string>& values);
    // Options by name ("--out"); `type` is the word for the value in the help text: "FILE", "N". An empty text is refused.
    void flag(const std::string& name, const std::string& doc, bool& value);
    void option(const std::string& name, const std::string& type, const std::string& doc, std::string& value);
    void option(const std::string& name, const std::string& type, const std::string& doc,
                std::vector<std::string>& values);  // may be repeated; one value each time
    void option(const std::string& name, const std::string& type, const std::string& doc, std::optional<int>& value, int min, int max,
                bool strict = true);  // false: values outside min..max are accepted; the verb checks them itself
    void option(const std::string& name, const std::string& type, const std::string& doc, std::optional<double>& value, double min,
                double max);
    void exclude(const std::string& name, const std::string& other);  // using both is refused
    void footer(const std::string& text);                             // printed below the help text

    // Parses. A value is the exit code to leave with: 0 after --help, 2 after invalid arguments (the error and the nearest valid option
    // are on stderr). No value: the verb runs.
    std::optional<int> read(const Arguments& arguments);
    // The same without a message. False: --help was printed. Error (badInput): invalid arguments, and the nearest valid option.
    Result<bool> parse(const Arguments& arguments);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Error (badInput) if `word` is not among `names`: "unknown WHAT 'word'; did you mean 'near'?", or the list of names if none is near.
Status checkWord(std::string_view what, std::string_view word, std::span<const std::string> names);

// "1280x720" -> {1280, 720}, pixels. Error (badInput): another form, or a side outside 1 to 16384.
Result<std::pair<int, int>> parseSize(const std::string& text);

// A progress bar on stderr. Drawn only if stderr is a terminal, at most 10 times a second; the destructor erases it.
class Progress {
  public:
    explicit Progress(const std::string& label);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void show(double share, std::string_view note = {});  // share: of the work that is done, 0..1; note: text after the bar

    // Shows the steps of opening a scene: for openSession.
    OpeningSteps steps() {
        return [this](const std::string& next, double share) {
            show(share, next);
            return true;
        };
    }

  private:
    std::string label_;
    bool terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point last_;
};

}  // namespace rivulet
