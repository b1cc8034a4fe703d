// The program `rivulet`: finds the verb (run, list, ...) and runs it. Each verb is one file, verb_*.cpp.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>
#include <system_error>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/core/descriptor.h"
#include "engine/core/exception_error.h"
#include "engine/core/jobs.h"
#include "engine/core/new_file.h"
#include "engine/core/number.h"
#include "engine/core/table.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

Table<Verb> verbs() {
    static const Verb rows[] = {
        {"run", "run a scene in a window, or without one (headless) into a video, images and statistics", runVerb},
        {"list", "list the scenes, methods, liquids, renderers, devices and parameters", listVerb},
        {"info", "show the CPU, OpenGL and OpenCL of this machine, and which backend auto selects", infoVerb},
        {"voxelize", "convert a mesh to voxels and write them to a file", voxelizeVerb},
        {"flow-check", "say what a head's mesh needs to carry tears, and find its eyes and lids", flowCheckVerb},
        {"bench", "measure speed and memory use", benchVerb},
        {"validate", "compare the simulation with experiments, published data and analytic solutions", validateVerb},
        {"chart", "measure speed against accuracy for all methods and write the result as a page", chartVerb},
        {"export", "run a scene and write its particles or its surface to files", exportVerb},
        {"sweep", "run a command for each combination of parameter values, as independent tasks", sweepVerb},
        {"join", "make one video of the images that pieces of a recording were drawn to", joinVerb},
    };
    return {rows};
}

namespace {

std::string helpText() {
    std::string text =
        fmt::format("rivulet {}: real-time water for OpenGL\n\nUsage: rivulet VERB [arguments]\n\nVerbs:\n", RIVULET_VERSION);
    for (const Verb& verb : verbs().rows) text += fmt::format("  {:<12}{}\n", verb.name, verb.doc);
    return text +
           "\nRun 'rivulet VERB --help' for the arguments of a verb.\nStart with 'rivulet list scenes', then 'rivulet run dam_break'.\n";
}

// A file that is opened takes the lowest free descriptor: if stderr is closed, messages would be written into a data file. /dev/null takes
// the place of closed ones, opened so that their use fails as before. False: there is no /dev/null.
bool holdStandardStreams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) != stream) return false;  // children inherit it
    }
    return true;
}

// Reports the exception that is being handled. Returns the exit status.
int reportThrown() noexcept {
    try {
        const std::exception_ptr thrown = std::current_exception();
        try {
            std::rethrow_exception(thrown);
        } catch (const std::system_error& error) {
            if (std::ferror(stdout) == 0) return report(errorOf(thrown));
            if (const int status = Graceful().status(); status != 0) return status;  // the terminal was closed (SIGHUP)
            if (error.code().value() == EPIPE) return 128 + SIGPIPE;  // the reader closed the pipe: end silently, as other programs do
            return report(failed("the output cannot be written: " + reasonOf(error.code().value())));
        } catch (...) {
            return report(errorOf(thrown));
        }
    } catch (...) {  // there is no memory for a message either
        (void)std::fputs("rivulet: out of memory\n", stderr);
        return kFailed;
    }
}

// An exception that nothing can handle, on another thread or in a destructor.
[[noreturn]] void endAtOnce() {
    removeTemporaryFiles();
    if (std::current_exception() == nullptr) std::abort();
    std::_Exit(reportThrown());
}

// Before the variables of libraries are initialised, which takes memory too (CLI11's validators).
[[gnu::constructor(101)]] void reportFromTheStart() { std::set_terminate(endAtOnce); }

// The value of RIVULET_THREADS: the threads of parallel loops.
Result<int> threadsOf(std::string_view text) {
    int threads = 0;
    constexpr int kMost = 1024;
    if (parseNumber(text, threads) && threads >= 1 && threads <= kMost) return threads;
    return badInput(
        fmt::format("the environment variable RIVULET_THREADS must be a number of threads from 1 to {}, but is '{}'", kMost, text));
}

int dispatch(const Arguments& words) {
    if (words.empty()) {
        (void)std::fputs(helpText().c_str(), stderr);
        return kBadUse;
    }
    if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
        fmt::print("{}", helpText());
        return kDone;
    }
    if (words[0] == "--version") {
        fmt::print("rivulet {}\n", RIVULET_VERSION);
        return kDone;
    }
    const Verb* verb = verbs().find(words[0]);
    if (verb == nullptr) {
        std::vector<std::string> names = verbs().names(), scenes;
        if (nearestName(words[0], names).empty()) {  // a scene's name without `run` before it
            for (const SceneListing& each : listScenes()) scenes.push_back(std::filesystem::path(each.path).stem().string());
            const std::string scene = words[0].ends_with(".json") ? words[0] : nearestName(words[0], scenes);
            if (!scene.empty()) return report(badInput(fmt::format("unknown verb '{}'; did you mean `rivulet run {}`?", words[0], scene)));
        }
        return report(checkWord("verb", words[0], names).error());
    }
    // Loops take part of the processors, where several programs share them.
    std::optional<Workers> workers;
    if (const char* text = std::getenv("RIVULET_THREADS"); text != nullptr && *text != '\0') {
        const Result<int> threads = threadsOf(text);
        if (!threads) return report(threads.error());
        workers.emplace(*threads);
    }
    const JobsScope scope(workers ? workers->jobs() : Jobs{});
    return verb->run({words.begin() + 1, words.end()});
}

}  // namespace
}  // namespace rivulet

int main(int argc, char** argv) {
    if (!rivulet::holdStandardStreams()) return rivulet::kFailed;
    rivulet::installSignals();
    try {
        const int code = rivulet::dispatch({argv + std::min(argc, 1), argv + argc});
        if (code == rivulet::kDone) rivulet::flushOutput();
        return code;
    } catch (...) {
        return rivulet::reportThrown();
    }
}
