// The include rules: which folder may include which. Reads every source of engine/, fluid/ and shaders/.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

using Names = std::set<std::string>;

Names operator+(Names a, const Names& b) {
    a.insert(b.begin(), b.end());
    return a;
}

// Folder -> what its files may include: folders, and single files that are header-only. "shaders" are layouts shared with kernels.
const std::map<std::string, Names>& rules() {
    static const Names base = {"engine/core", "engine/compute", "engine/gpu"};
    static const Names scene = base + Names{"engine/scene", "engine/material"};
    static const Names engine = scene + Names{"engine/render", "engine/ui", "engine/app"};
    static const Names voxel = {"engine/core", "engine/compute", "fluid/voxel", "shaders"};
    static const Names sim = voxel + Names{"fluid/sim"};
    static const Names flow = sim + Names{"engine/gpu", "fluid/flow", "engine/material/layer.h"};
    // The three of engine/render are in rivulet::base: a host's picture needs them, too.
    static const Names render = sim + Names{"engine/gpu",
                                            "fluid/render",
                                            "engine/render/frame_view.h",
                                            "engine/render/frame_params.h",
                                            "engine/render/environment_map.h",
                                            "engine/render/made_sky.h",
                                            "engine/material/image.h",
                                            "fluid/io/recording.h"};  // plain data
    static const Names io = sim + Names{"fluid/io"};
    // scene <- session <- viewer, validate: only the viewer sees panels.
    static const Names scenes = flow + render + io + scene + Names{"engine/render", "engine/app", "fluid/scene"};
    static const Names sessions = scenes + Names{"fluid/session"};
    static const std::map<std::string, Names> table = {
        {"engine/core", {"engine/core"}},
        {"engine/compute", {"engine/core", "engine/compute", "shaders"}},
        {"engine/gpu", base + Names{"shaders"}},
        {"engine/material", base + Names{"engine/material", "shaders"}},
        {"engine/scene", scene + Names{"shaders"}},
        {"engine/render", scene + Names{"engine/render", "shaders"}},
        {"engine/ui", scene + Names{"engine/render", "engine/ui"}},
        {"engine/app", engine + Names{"shaders"}},
        {"fluid/voxel", voxel},
        {"fluid/sim", sim},
        {"fluid/flow", flow},
        {"fluid/render", render},
        {"fluid/io", io},
        {"fluid/scene", scenes},
        {"fluid/session", sessions},
        {"fluid/viewer", sessions + Names{"engine/ui", "fluid/viewer"}},
        {"fluid/validate", sessions + Names{"fluid/validate"}},  // cases are scenes
        {"fluid/capi", flow + render + io + Names{"fluid/capi"}},
        {"shaders", {"shaders", "engine/core/math.h"}},  // math.h: only where a kernel is C++
    };
    return table;
}

// Outside libraries -> the folders that may see them.
const std::map<std::string, Names>& libraries() {
    static const Names gl = {"engine/gpu", "engine/scene", "engine/material", "engine/render", "engine/ui",   "engine/app",
                             "fluid/flow", "fluid/render", "fluid/scene",     "fluid/session", "fluid/viewer"};
    static const std::map<std::string, Names> table = {
        {"rivulet_glad/", gl},
        {"GL/", {}},  // glad is the loader
        {"GLFW/", {"engine/app", "fluid/viewer"}},
        {"EGL/", {"engine/app"}},
        {"imgui", {"engine/ui", "engine/app", "fluid/viewer"}},
        {"assimp/", {"engine/scene"}},
        {"CL/", {"engine/compute"}},
        {"tbb/", {"engine/compute", "fluid/voxel"}},
        {"oneapi/", {"engine/compute", "fluid/voxel", "fluid/sim", "fluid/render", "fluid/io"}},
        {"json/", {"engine/core", "fluid/scene", "fluid/session", "fluid/viewer"}},
        {"zstd", {"fluid/voxel"}},
        {"xxh", {"engine/compute", "fluid/voxel"}},
        {"stb", {"engine/scene", "engine/render", "engine/app", "fluid/flow"}},
        {"Eigen/", {"fluid/flow", "fluid/sim"}},
        {"bullet", {"fluid/scene"}},
        {"btBullet", {"fluid/scene"}},
        {"LinearMath/", {"fluid/scene"}},
    };
    return table;
}

// "engine/core/json.h" -> "engine/core"; "shaders/fluid/x.h" -> "shaders"; "" where no rule speaks.
std::string roomOf(const std::string& path) {
    if (path.starts_with("shaders/")) return "shaders";
    size_t first = path.find('/');
    if (first == std::string::npos) return "";
    size_t second = path.find('/', first + 1);
    return second == std::string::npos ? "" : path.substr(0, second);
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
    if (rule == rules().end()) return file + " lies in " + room + ", a folder that the include rules do not know";
    std::string target = roomOf(path);
    if (rules().contains(target)) {
        if (rule->second.contains(target) || rule->second.contains(path)) return std::nullopt;
        return file + " includes " + path + ", which " + room + " may not see";
    }
    if (line[open] == '"') return file + " includes \"" + path + "\", which does not start at the project's root";
    for (const auto& [prefix, rooms] : libraries())
        if (path.starts_with(prefix) && !rooms.contains(room)) return file + " includes <" + path + ">, which " + room + " may not see";
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
            EXPECT_TRUE(fs::exists(fs::path(RIVULET_SOURCE_DIR) / path)) << file << " includes " << path << ", which is not there";
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
    EXPECT_TRUE(breachIn("engine/tools/x.cpp", "#include <vector>"));
    EXPECT_TRUE(breachIn("shaders/fluid/x.kernel", R"(#include "engine/core/params.h")"));

    EXPECT_FALSE(breachIn("fluid/render/points.cpp", R"(#include "engine/render/frame_view.h")"));
    EXPECT_FALSE(breachIn("fluid/flow/flow_layer.cpp", R"(#include "engine/material/layer.h")"));
    EXPECT_FALSE(breachIn("fluid/sim/world/fluid_world.cpp", R"(#include "shaders/fluid/world/step_params.h")"));
    EXPECT_FALSE(breachIn("fluid/session/session.cpp", R"(#include "engine/app/context_egl.h")"));
    EXPECT_FALSE(breachIn("engine/core/json.cpp", "#include <json/json.h>"));
    EXPECT_FALSE(breachIn("engine/core/json.cpp", "// #include nothing"));
}

}  // namespace
