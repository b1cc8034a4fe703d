// rivulet: one program over one library; a file per verb.
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
        {"run", "run a scene: in a window, or headless to video, pictures and figures", runVerb},
        {"list", "list scenes, methods, renderers, devices, parameters", listVerb},
        {"info", "what this machine offers, what --backend auto would choose and why", infoVerb},
        {"voxelize", "turn a mesh into voxels: a file, figures, pictures", voxelizeVerb},
        {"bench", "measure speed and memory", benchVerb},
        {"validate", "measure the simulation against nature, papers and formulas", validateVerb},
        {"chart", "speed against accuracy, into a page", chartVerb},
        {"export", "run a scene, and write its surface as meshes", exportVerb},
    };
    return {rows};
}

namespace {

void printHelp(FILE* to) {
    fmt::print(to, "rivulet {}: real-time water for OpenGL\n\nusage: rivulet VERB [arguments]\n\n", RIVULET_VERSION);
    for (const Verb& verb : verbs().rows) fmt::print(to, "  {:<10}{}\n", verb.name, verb.doc);
    fmt::print(to, "\n'rivulet VERB --help' says what a verb takes.\n");
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
        if (nearestName(words[0], names).empty()) {  // who names a scene alone wants to see it
            for (const SceneListing& each : listScenes()) scenes.push_back(std::filesystem::path(each.path).stem().string());
            const std::string scene = words[0].ends_with(".json") ? words[0] : nearestName(words[0], scenes);
            if (!scene.empty()) return report(badInput(fmt::format("unknown verb '{}'; `rivulet run {}` opens a scene", words[0], scene)));
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
            code = rivulet::report(rivulet::failed(fmt::format("the output could not be written: {}", std::strerror(errno))));
        return code;
    } catch (const std::bad_alloc&) {
        return rivulet::report(rivulet::failed("there is not enough memory for this"));
    } catch (const std::exception& error) {  // what a library of others throws, and no one nearer could say better
        return rivulet::report(rivulet::failed(error.what()));
    }
}
