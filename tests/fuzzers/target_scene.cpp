// Targets scene (the text of a scene file) and set (assignments of --set).
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/json.h"
#include "fluid/scene/scene_file.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

// What reads back is the same scene, and a scene that is refused is refused with a sentence.
void check(SceneFile& scene) {
    if (const Status valid = checkScene(scene); !valid) requireSentence(valid.error().message);
    for (size_t k = 0; k < std::min<size_t>(scene.presets.size(), 4); ++k) {
        SceneFile changed = scene;
        if (const Status set = applyPreset(changed, scene.presets[k].name); !set) requireSentence(set.error().message);
    }
    const std::string text = writeJson([&](ParamVisitor& v) { scene.visit(v); });
    SceneFile again;
    const Status read = readJson(text, "again", [&](ParamVisitor& v) { again.visit(v); });
    require(read, "what writeJson writes can be read");
    require(writeJson([&](ParamVisitor& v) { again.visit(v); }) == text, "numbers read back exactly");
}

std::vector<std::string> shippedScenes() {
    std::vector<std::string> all;
    for (const char* folder : {"assets/scenes", "assets/cases"})
        for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(RIVULET_SOURCE_DIR) / folder)) {
            std::ifstream stream(file.path());
            std::stringstream text;
            text << stream.rdbuf();
            all.push_back(text.str());
        }
    std::ranges::sort(all);
    return all;
}

// Every path of a scene that has an item in every list.
const std::vector<std::string>& paths() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> found;
        SceneFile scene;
        scene.colliders.resize(1);
        scene.emitters.resize(1);
        scene.sinks.resize(1);
        scene.bodies.resize(1);
        scene.flow.resize(1);
        scene.fluid.blocks.resize(1);
        scene.fluid.probes.resize(1);
        std::istringstream table(describeParams([&](ParamVisitor& v) { scene.visit(v); }));
        for (std::string line; std::getline(table, line);) {
            const size_t from = line.find('`'), to = line.find('`', from + 1);
            if (from == std::string::npos || to == std::string::npos) continue;
            std::string path = line.substr(from + 1, to - from - 1);
            for (size_t at = path.find(".N"); at != std::string::npos; at = path.find(".N")) path.replace(at, 2, ".0");
            for (size_t at = path.find("[]"); at != std::string::npos; at = path.find("[]")) path.replace(at, 2, ".0");
            found.push_back(path);
        }
        return found;
    }();
    return all;
}

}  // namespace

void runScene(Bytes bytes) {
    SceneFile scene;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const Status read = readJson(text, "scene", [&](ParamVisitor& v) { scene.visit(v); });
    if (!read) {
        requireSentence(read.error().message);
        return;
    }
    check(scene);
}

std::vector<std::string> sceneSeeds() { return shippedScenes(); }

void runSet(Bytes bytes) {
    Feed feed(bytes);
    SceneFile scene;
    for (int k = 0; k < 16 && !feed.empty(); ++k) {
        const uint32_t of = feed.u32();
        std::string path = of % 8 == 7 || paths().empty() ? feed.text(40) : paths()[of / 8 % paths().size()];
        SceneFile before = scene;
        const Status set = setParam(path + "=" + feed.text(60), [&](ParamVisitor& v) { scene.visit(v); });
        if (!set) requireSentence(set.error().message);
    }
    check(scene);
}

std::vector<std::string> setSeeds() {
    std::vector<std::string> all;
    for (size_t k = 0; k < paths().size(); ++k)
        for (const char* value : {"0", "1", "true", "1,2,3", "dfsph", "-1e30", "[1,2,3]"}) {
            const auto of = static_cast<uint32_t>(8 * k);
            std::string bytes(reinterpret_cast<const char*>(&of), sizeof of);
            bytes += static_cast<char>(std::string_view(value).size());
            all.push_back(bytes + value);
        }
    return all;
}

}  // namespace rivulet::fuzzers
