// Targets scene (the text of a scene file), scene_file (a file with a preset and assignments, saved and loaded again), marks (a face's
// landmarks) and set (assignments of --set).
#include <algorithm>
#include <sstream>

#include "engine/core/json.h"
#include "fluid/scene/face_marks.h"
#include "fluid/scene/scene_file.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

std::string textOf(SceneFile& scene) {
    return writeJson([&](ParamVisitor& v) { scene.visit(v); });
}

// An item in every list.
void fill(SceneFile& scene) {
    scene.colliders.resize(1);
    scene.emitters.resize(1);
    scene.sinks.resize(1);
    scene.bodies.resize(1);
    scene.flow.resize(1);
    scene.presets.resize(1);
    scene.fluid.blocks.resize(1);
    scene.fluid.probes.resize(1);
}

// What reads back is the same scene, and a scene that is refused is refused with a sentence.
void check(SceneFile& scene) {
    if (const Status valid = checkScene(scene); !valid) requireSentence(valid.error().message);
    for (size_t k = 0; k < std::min<size_t>(scene.presets.size(), 4); ++k) {
        SceneFile changed = scene;
        if (const Status set = applyPreset(changed, scene.presets[k].name); !set) requireSentence(set.error().message);
    }
    const std::string text = textOf(scene);
    SceneFile again;
    const Status read = readJson(text, "again", [&](ParamVisitor& v) { again.visit(v); });
    require(read, "what writeJson writes can be read");
    require(textOf(again) == text, "numbers read back exactly");
}

std::vector<std::string> shippedScenes() {
    std::vector<std::string> all;
    for (const char* folder : {"assets/scenes", "assets/cases"})
        for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(RIVULET_SOURCE_DIR) / folder))
            all.push_back(contentsOf(file.path()));
    std::ranges::sort(all);
    return all;
}

// Every path of a scene that has an item in every list.
const std::vector<std::string>& paths() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> found;
        SceneFile scene;
        fill(scene);
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
    if (!read) return requireSentence(read.error().message);
    check(scene);
}

std::vector<std::string> sceneSeeds() {
    std::vector<std::string> all = shippedScenes();
    // With every key, one item a list, numbers and words in every form.
    SceneFile whole;
    fill(whole);
    all.push_back(writeJson([&](ParamVisitor& v) { whole.visit(v); }));
    for (const char* text : {"",
                             "{",
                             "[]",
                             "{\"fluid\": 1}",
                             "{\"fluid\": {\"spacing\": \"a\"}}",
                             "{\"fluid\": {\"spacing\": 1e999}}",
                             "{\"name\": 3}",
                             "{\"colliders\": {}}",
                             "{\"colliders\": [1]}",
                             "{\"fluid\": {\"gravity\": [1, 2]}}",
                             "{\"fluid\": {\"gravity\": [1, 2, \"x\"]}}",
                             "{\"fluid\": {\"gravity\": 1}}",
                             "{\"fluid\": {\"method\": \"dfspj\"}}",
                             "{\"fluid\": {\"spacign\": 1}}",
                             "{\"fluid\": {\"sleep\": {\"on\": 1}}}",
                             "{\"name\": \"a\\u0007\\n\\\"\"}",
                             "{\"name\": \"a\", \"name\": \"b\"}",
                             "// c\n{}",
                             "{} x",
                             "{\"fluid\": {\"maxSubsteps\": 1.5}}",
                             "\xEF\xBB\xBF{}"})
        all.emplace_back(text);
    all.push_back(std::string(70, '[') + std::string(70, ']'));
    return all;
}

// The text up to the first zero byte, then the name of a preset, then assignments, each ended by a zero byte.
void runSceneFile(Bytes bytes) {
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<std::string> parts;
    while (parts.size() < 8 && (parts.empty() || !rest.empty())) {
        const std::string_view part = rest.substr(0, rest.find('\0'));
        parts.emplace_back(part);
        rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    }
    const std::string path = fileOf(bytesOf(parts[0]), ".json"), other = fileOf({}, "_saved.json");
    const std::string preset = parts.size() > 1 ? parts[1] : "";
    Result<SceneFile> scene = loadScene(path, std::span(parts).subspan(std::min<size_t>(parts.size(), 2)), preset);
    if (!scene) return requireSentence(scene.error().message);
    require(checkScene(*scene), "a scene that was loaded makes sense");
    if (const Status saved = saveScene(*scene, other); !saved) return requireSentence(saved.error().message);
    Result<SceneFile> again = loadScene(other, {});
    require(again, again ? "" : "what was saved can be loaded: " + again.error().message);
    require(textOf(*again) == textOf(*scene), "and gives the same scene");
}

std::vector<std::string> sceneFileSeeds() {
    std::vector<std::string> all = shippedScenes();
    const std::string zero(1, '\0');
    for (const char* tail :
         {"honey", "none", "", "|fluid.spacing=0.05", "|fluid.spacing=x", "|flow.0.mesh=a.obj", "|look.renderer=truth"}) {
        std::string parts(tail);
        std::ranges::replace(parts, '|', '\0');
        for (
            const char* text :
            {R"({"presets": [{"name": "honey", "set": "fluid.viscosity=0.01; look.renderer=points;"}, {"name": "none", "set": "x"}]})",
             R"({"fluid": {"blocks": [{"max": [0.1, 0.1, 0.1]}]}, "flow": [{"mesh": "tests/meshes/plate.obj", "instead": "scenes/head.json"}]})",
             R"({"colliders": [{"mesh": "meshes/spot.obj"}, {"kind": "plane"}], "bodies": [{"mesh": "meshes/none.obj"}]})"})
            all.push_back(text + zero + parts);
    }
    return all;
}

void runMarks(Bytes bytes) {
    const Result<FaceMarks> marks = readFaceMarks(fileOf(bytes, ".json"));
    if (!marks) return requireSentence(marks.error().message);
    for (const EyeMarks& eye : marks->eyes) {
        if (eye.tear) require(isFinite(*eye.tear), "landmarks are finite");
        for (const vec3& p : eye.lowerLid) require(isFinite(p), "landmarks are finite");
    }
}

std::vector<std::string> marksSeeds() {
    std::string points;
    for (const char* name : {"left_inner_corner", "left_lower_lid_inner_third", "left_lower_lid_outer_third", "left_outer_corner",
                             "right_inner_corner", "right_lower_lid_inner_third", "right_lower_lid_outer_third", "right_outer_corner"})
        points += std::string(points.empty() ? "" : ", ") + "\"" + name + "\": {\"pos_cm\": [1, 2.5, -3e1]}";
    const std::string eye = R"({"tear": {"position": [0, 1, 2], "uv": [0.5, 0.5]}, "lower_lid_margin": [[0, 1, 2], [1, 2, 3]]})";
    return {"{\"tear_points\": {" + points + "}}",           "{\"eyes\": {\"left\": " + eye + ", \"right\": " + eye + "}}",
            R"({"eyes": {"left": {"tear": {}}}})",           R"({"eyes": {"left": {"lower_lid_margin": [["a", 1, 1e99]]}}})",
            R"({"tear_points": {"left_inner_corner": {}}})", "{}"};
}

void runSet(Bytes bytes) {
    Feed feed(bytes);
    SceneFile scene;
    const bool checked = feed.u8() < 16;  // takes ten times as long
    for (int k = 0; k < 16 && !feed.empty(); ++k) {
        const uint32_t of = feed.u32();
        std::string path = of % 8 == 7 || paths().empty() ? feed.text(40) : paths()[of / 8 % paths().size()];
        const Status set = setParam(path + "=" + feed.text(60), [&](ParamVisitor& v) { scene.visit(v); });
        if (!set) requireSentence(set.error().message);
    }
    if (checked) check(scene);
}

std::vector<std::string> setSeeds() {
    std::vector<std::string> all;
    for (size_t k = 0; k < paths().size(); ++k)
        for (const char* value : {"0", "1", "true", "1,2,3", "dfsph", "-1e30", "[1,2,3]"}) {
            const auto of = static_cast<uint32_t>(8 * k);
            std::string bytes(1, k % 16 == 0 ? '\0' : '\x7F');
            bytes.append(reinterpret_cast<const char*>(&of), sizeof of);
            bytes += static_cast<char>(std::string_view(value).size());
            all.push_back(bytes + value);
        }
    return all;
}

}  // namespace rivulet::fuzzers
