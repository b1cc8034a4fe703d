// The program `rivulet`: finds the verb (run, list, ...) and runs it. Each verb is one file, verb_*.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/core/table.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

Table<Verb> verbs() {
    static const Verb rows[] = {
        {"run", "run a scene in a window, or without one (headless) into a video, images and statistics", runVerb},
        {"list", "list the scenes, methods, liquids, renderers, devices and parameters", listVerb},
        {"info", "show the CPU, OpenGL and OpenCL of this machine, and which backend auto selects", infoVerb},
        {"voxelize", "convert a mesh to voxels and write them to a file", voxelizeVerb},
        {"bench", "measure speed and memory use", benchVerb},
        {"validate", "compare the simulation with experiments, published data and analytic solutions", validateVerb},
        {"chart", "measure speed against accuracy for all methods and write the result as a page", chartVerb},
        {"export", "run a scene and write its particles or its surface to files", exportVerb},
    };
    return {rows};
}

namespace {

void printHelp(FILE* to) {
    fmt::print(to, "rivulet {}: real-time water for OpenGL\n\nUsage: rivulet VERB [arguments]\n\nVerbs:\n", RIVULET_VERSION);
    for (const Verb& verb : verbs().rows) fmt::print(to, "  {:<10}{}\n", verb.name, verb.doc);
    fmt::print(
        to, "\nRun 'rivulet VERB --help' for the arguments of a verb.\nStart with 'rivulet list scenes', then 'rivulet run dam_break'.\n");
}

int dispatch(const Arguments& words) {
    if (words.empty()) {
        printHelp(stderr);
        return kBadUse;
    }
    if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
        printHelp(stdout);
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
    return verb->run({words.begin() + 1, words.end()});
}

}  // namespace
}  // namespace rivulet

int main(int argc, char** argv) {
    rivulet::installInterrupts();
    try {
        int code = rivulet::dispatch({argv + std::min(argc, 1), argv + argc});
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            code = rivulet::report(rivulet::failed(fmt::format("cannot write the output: {}", std::strerror(errno))));
        return code;
    } catch (const std::bad_alloc&) {
        return rivulet::report(rivulet::failed("out of memory; use fewer particles or coarser voxels"));
    } catch (const std::exception& error) {  // thrown by a third-party library and not handled nearer to its cause
        return rivulet::report(rivulet::failed(error.what()));
    }
}
