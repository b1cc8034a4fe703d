// The include rules of tests/checks/rooms.json: which folder may include which. Reads every source of engine/, fluid/ and shaders/.
#include <gtest/gtest.h>
#include <json/json.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;

const Json::Value& table() {
    static const Json::Value value = [] {
        Json::Value read;
        std::ifstream file(fs::path(RIVULET_SOURCE_DIR) / "tests/checks/rooms.json");
        std::string errors;
        if (!Json::parseFromStream(Json::CharReaderBuilder(), file, &read, &errors)) ADD_FAILURE() << "tests/checks/rooms.json: " << errors;
        return read;
    }();
    return value;
}

// Adds what `room` may include to `allowed`, and what that may include.
void addAllowed(const std::string& room, Names& allowed) {
    if (!allowed.insert(room).second) return;
    const Json::Value& rule = table()["rooms"][room];
    for (const Json::Value& header : rule["headers"]) allowed.insert(header.asString());
    for (const Json::Value& next : rule["includes"]) addAllowed(next.asString(), allowed);
}

// Room -> what its files may include: rooms and single files.
const std::map<std::string, Names>& rules() {
    static const std::map<std::string, Names> all = [] {
        std::map<std::string, Names> made;
        for (const std::string& room : table()["rooms"].getMemberNames()) {
            addAllowed(room, made[room]);
            for (const Json::Value& other : table()["rooms"][room]["not"]) made[room].erase(other.asString());
        }
        return made;
    }();
    return all;
}

// "engine/core/json.h" -> "engine/core"; "fluid/sim/grid/x.h" -> "fluid/sim/grid"; "" if the folder is no room.
std::string roomOf(const std::string& path) {
    if (path.starts_with("shaders/")) return "shaders";
    const std::string folder = fs::path(path).parent_path().generic_string();
    for (std::string room = folder; !room.empty(); room = fs::path(room).parent_path().generic_string())
        if (rules().contains(room)) return room;
    return "";
}

bool mayUse(const std::string& room, const Json::Value& rooms) {
    return std::ranges::any_of(rooms,
                               [&](const Json::Value& name) { return room == name.asString() || room.starts_with(name.asString() + "/"); });
}

// The file that `file` means by `path` if it lies beside it.
fs::path sourceOf(const std::string& file, const std::string& path) {
    return fs::path(RIVULET_SOURCE_DIR) / fs::path(file).parent_path() / path;
}

// The breach in one line of `file`, in words; nothing when the line is no include or keeps the rules.
std::optional<std::string> breachIn(const std::string& file, const std::string& line) {
    size_t at = line.find_first_not_of(" \t");
    if (at == std::string::npos || line[at] != '#') return std::nullopt;
    at = line.find_first_not_of(" \t", at + 1);
    if (at == std::string::npos || line.compare(at, 7, "include") != 0) return std::nullopt;
    size_t open = line.find_first_of("\"<", at);
    if (open == std::string::npos) return std::nullopt;  // by a macro
    size_t close = line.find(line[open] == '<' ? '>' : '"', open + 1);
    std::string path = line.substr(open + 1, close - open - 1);
    std::string room = roomOf(file);

    auto rule = rules().find(room);
    if (rule == rules().end()) return file + " is in a folder that tests/checks/rooms.json does not name";
    std::string target = roomOf(path);
    if (rules().contains(target)) {
        if (rule->second.contains(target) || rule->second.contains(path)) return std::nullopt;
        return file + " includes " + path + ", which " + room + " may not see";
    }
    // The headers of C lie in one folder wherever a host puts them, so they name each other from there.
    if (room == "fluid/capi" && file.ends_with(".h") && fs::exists(sourceOf(file, path))) return std::nullopt;
    if (line[open] == '"') return file + " includes \"" + path + "\", which does not start at the project's root";
    const Json::Value& libraries = table()["libraries"];
    for (const std::string& prefix : libraries.getMemberNames())
        if (path.starts_with(prefix) && !mayUse(room, libraries[prefix]))
            return file + " includes <" + path + ">, which " + room + " may not see";
    return std::nullopt;
}

std::vector<std::string> sources() {
    std::vector<std::string> found;
    fs::path root = RIVULET_SOURCE_DIR;
    for (const char* top : {"engine", "fluid", "shaders"})
        for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
            static const Names kinds = {".h", ".cpp", ".kernel", ".glsl", ".vert", ".frag", ".comp"};
            if (kinds.contains(entry.path().extension().string())) found.push_back(fs::relative(entry.path(), root).generic_string());
        }
    return found;
}

TEST(IncludeRules, EveryFileKeepsThem) {
    std::vector<std::string> files = sources();
    ASSERT_GT(files.size(), 20U) << "the sources were not found below " << RIVULET_SOURCE_DIR;
    for (const std::string& file : files) {
        std::ifstream stream(fs::path(RIVULET_SOURCE_DIR) / file);
        std::string line;
        for (int number = 1; std::getline(stream, line); ++number) {
            std::optional<std::string> breach = breachIn(file, line);
            EXPECT_FALSE(breach) << file << ":" << number << ": " << *breach;
        }
    }
}

TEST(IncludeRules, EveryIncludedFileOfTheProjectExists) {
    for (const std::string& file : sources()) {
        std::ifstream stream(fs::path(RIVULET_SOURCE_DIR) / file);
        std::string line;
        while (std::getline(stream, line)) {
            size_t open = line.find("#include \"");
            if (open != 0) continue;
            std::string path = line.substr(10, line.find('"', 10) - 10);
            EXPECT_TRUE(fs::exists(fs::path(RIVULET_SOURCE_DIR) / path) || fs::exists(sourceOf(file, path)))
                << file << " includes " << path << ", which is not there";
        }
    }
}

// The test must be able to fail: planted breaches, and their neighbours that are allowed.
TEST(IncludeRules, APlantedBreachIsFound) {
    EXPECT_TRUE(breachIn("engine/core/json.cpp", R"(#include "engine/compute/device.h")"));
    EXPECT_TRUE(breachIn("engine/compute/device.cpp", R"(#include "engine/gpu/buffer.h")"));
    EXPECT_TRUE(breachIn("engine/app/app.cpp", R"(#include "fluid/sim/world/fluid_world.h")"));
    EXPECT_TRUE(breachIn("engine/material/material.cpp", R"(#include "engine/scene/mesh.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/world/fluid_world.cpp", R"(  #  include "engine/gpu/buffer.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/world/fluid_world.cpp", "#include <rivulet_glad/gl.h>"));
    EXPECT_TRUE(breachIn("fluid/voxel/voxel_grid.cpp", R"(#include "fluid/sim/world/stats.h")"));
    EXPECT_TRUE(breachIn("fluid/render/points.cpp", R"(#include "engine/render/passes.h")"));
    EXPECT_TRUE(breachIn("fluid/io/export.cpp", R"(#include "fluid/scene/scene_file.h")"));
    EXPECT_TRUE(breachIn("engine/ui/param_panel.cpp", "#include <GLFW/glfw3.h>"));
    EXPECT_TRUE(breachIn("engine/core/json.cpp", R"(#include "json.h")"));
    EXPECT_TRUE(breachIn("fluid/capi/world.cpp", R"(#include "rivulet_world.h")"));
    EXPECT_TRUE(breachIn("fluid/capi/rivulet.h", R"(#include "no_such_header.h")"));
    EXPECT_FALSE(breachIn("fluid/capi/rivulet.h", R"(#include "rivulet_world.h")"));
    EXPECT_TRUE(breachIn("engine/tools/x.cpp", "#include <vector>"));
    EXPECT_TRUE(breachIn("shaders/fluid/x.kernel", R"(#include "engine/core/params.h")"));

    EXPECT_TRUE(breachIn("engine/ui/param_panel.cpp", R"(#include "shaders/render/frame.h")"));

    // scene <- session <- viewer, validate.
    EXPECT_TRUE(breachIn("fluid/scene/scene_file.cpp", R"(#include "fluid/session/session.h")"));
    EXPECT_TRUE(breachIn("fluid/scene/scene_file.cpp", R"(#include "fluid/viewer/viewer.h")"));
    EXPECT_TRUE(breachIn("fluid/scene/scene_file.cpp", R"(#include "engine/app/context_egl.h")"));
    EXPECT_TRUE(breachIn("fluid/session/session.cpp", R"(#include "fluid/viewer/viewer.h")"));
    EXPECT_TRUE(breachIn("fluid/session/session.cpp", R"(#include "engine/ui/param_panel.h")"));
    EXPECT_TRUE(breachIn("fluid/session/session.cpp", R"(#include "engine/app/window_glfw.h")"));
    EXPECT_TRUE(breachIn("fluid/session/session.cpp", "#include <imgui.h>"));
    for (const auto& [room, allowed] : rules())
        if (room != "fluid/validate") EXPECT_TRUE(breachIn(room + "/x.cpp", R"(#include "fluid/validate/chart.h")")) << room;

    // Inside fluid/sim.
    EXPECT_TRUE(breachIn("fluid/sim/x.cpp", "#include <vector>"));
    for (const char* below : {"kernels", "grid", "methods", "forces", "solids", "query", "surface", "sources"}) {
        const std::string file = std::string("fluid/sim/") + below + "/x.cpp";
        EXPECT_TRUE(breachIn(file, R"(#include "fluid/sim/world/fluid_world.h")")) << file;
    }
    for (const char* other : {"kernels", "grid", "methods", "solids", "query", "surface", "sources"}) {
        const std::string file = std::string("fluid/sim/") + other + "/x.cpp";
        EXPECT_TRUE(breachIn(file, R"(#include "fluid/sim/forces/force.h")")) << file;
    }
    for (const char* other : {"kernels", "grid", "methods", "forces", "solids", "query", "surface"}) {
        const std::string file = std::string("fluid/sim/") + other + "/x.cpp";
        EXPECT_TRUE(breachIn(file, R"(#include "fluid/sim/sources/emitter.h")")) << file;
    }
    EXPECT_TRUE(breachIn("fluid/sim/forces/x.cpp", R"(#include "fluid/sim/solids/solids.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/methods/x.cpp", R"(#include "fluid/sim/grid/neighbor_grid.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/grid/x.cpp", R"(#include "fluid/sim/methods/method.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/grid/x.cpp", R"(#include "fluid/sim/query/water_query.h")"));
    EXPECT_TRUE(breachIn("fluid/sim/kernels/x.cpp", R"(#include "fluid/sim/grid/neighbor_grid.h")"));
    EXPECT_FALSE(breachIn("fluid/sim/sources/x.cpp", R"(#include "fluid/sim/grid/neighbor_grid.h")"));
    EXPECT_FALSE(breachIn("fluid/sim/methods/x.cpp", R"(#include "fluid/sim/world/step_context.h")"));

    EXPECT_FALSE(breachIn("fluid/render/points.cpp", R"(#include "engine/render/frame_view.h")"));
    EXPECT_FALSE(breachIn("fluid/flow/flow_layer.cpp", R"(#include "engine/material/layer.h")"));
    EXPECT_FALSE(breachIn("fluid/sim/world/fluid_world.cpp", R"(#include "shaders/fluid/world/step_params.h")"));
    EXPECT_FALSE(breachIn("fluid/session/session.cpp", R"(#include "engine/app/context_egl.h")"));
    EXPECT_FALSE(breachIn("engine/core/json.cpp", "#include <json/json.h>"));
    EXPECT_FALSE(breachIn("engine/core/json.cpp", "// #include nothing"));
}

}  // namespace
