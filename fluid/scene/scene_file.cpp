#include "fluid/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "engine/core/file.h"
#include "engine/core/folder.h"
#include "engine/core/input_file.h"
#include "engine/core/json.h"
#include "engine/core/param_list.h"
#include "engine/core/param_value.h"
#include "engine/core/table.h"
#include "fluid/sim/solids/solids.h"
#include "fluid/sim/world/contradictions.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

VisitFn visiting(SceneFile& scene) {
    return [&scene](ParamVisitor& v) { scene.visit(v); };
}

// "", or which of the sliders is no parameter. For a file that is read: a later edit may remove what a slider is for.
std::string wrongSlider(const SceneFile& scene) {
    if (scene.sliders.empty()) return "";
    SceneFile copy = scene;
    const std::map<std::string, std::string> known = paramTexts(visiting(copy));
    std::vector<std::string> names;
    names.reserve(known.size());
    for (const auto& [name, text] : known) names.push_back(name);
    for (const std::string& path : slidersOf(scene.sliders))
        if (!known.contains(path)) {
            const std::string near = nearestName(path, names);
            return fmt::format("sliders names {}, which is no parameter{}", excerpt(path),
                               near.empty() ? "; `rivulet list --parameters` names them" : fmt::format("; did you mean {}?", near));
        }
    return "";
}

// "", or which values contradict each other. The range of each value was checked when it was read.
std::string contradiction(const SceneFile& scene) {
    const BoxParams& box = scene.fluid.box;
    if (std::string wrong = contradiction(scene.fluid); !wrong.empty()) return wrong;
    for (size_t i = 0; i < scene.fluid.blocks.size(); ++i)
        if (scene.fluid.blocks[i].shape == "mesh" && scene.fluid.blocks[i].mesh.empty())
            return fmt::format("fluid.blocks[{}].mesh is empty: name a mesh file, or set another shape", i);
    std::set<std::pair<float, float>> kinds;
    for (const ColliderParams& collider : scene.colliders) kinds.emplace(collider.friction, collider.restitution);
    if (scene.colliders.size() > kMostSurfaces && kinds.size() > kMostSurfaces)
        return fmt::format(
            "colliders have {} different pairs of friction and restitution, at most {} are possible: give some colliders equal values",
            kinds.size(), kMostSurfaces);
    for (size_t i = 0; i < scene.colliders.size(); ++i)
        if (const std::string wrong = contradiction(scene.colliders[i]); !wrong.empty()) return fmt::format("colliders[{}]{}", i, wrong);
    for (size_t i = 0; i < scene.emitters.size(); ++i) {
        const EmitterParams& emitter = scene.emitters[i];
        if (std::string wrong = contradiction(emitter, i, box); !wrong.empty()) return wrong;
        if (emitter.shape == "mesh" && emitter.mesh.empty())
            return fmt::format("emitters[{}].mesh is empty: name a mesh file, or set shape to nozzle or box", i);
    }
    if (std::string wrong = contradiction(scene.look); !wrong.empty()) return wrong;
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyParams& body = scene.bodies[i];
        if (const std::string wrong = contradiction(body); !wrong.empty()) return fmt::format("bodies[{}]{}", i, wrong);
        if (std::string wrong = outside(fmt::format("bodies[{}].position", i), body.position, box); !wrong.empty()) return wrong;
    }
    const vec3 sight = scene.camera.target - scene.camera.position;
    if (glm::length(sight) < 1.0e-6F) return fmt::format("camera.target {} must differ from camera.position", shown(scene.camera.target));
    if (glm::length(scene.light.direction) < 1.0e-6F)
        return fmt::format("light.direction is {}: its length must not be 0", shown(scene.light.direction));
    return "";
}

// Folders of assets, the user's first.
std::vector<fs::path> assetFolders() {
    std::vector<fs::path> folders;
    if (const char* listed = std::getenv("RIVULET_ASSETS")) {
        std::string_view rest = listed;
        while (!rest.empty()) {
            const size_t colon = std::min(rest.find(':'), rest.size());
            if (colon > 0) folders.emplace_back(rest.substr(0, colon));
            rest.remove_prefix(std::min(colon + 1, rest.size()));
        }
    }
    folders.emplace_back(fs::path(RIVULET_SOURCE_DIR) / "assets");
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) folders.push_back(program.parent_path().parent_path() / "share/rivulet/assets");
    return folders;
}

bool isFile(const fs::path& path) {
    std::error_code error;
    return fs::exists(path, error) && !fs::is_directory(path, error);
}

}  // namespace

void CameraParams::visit(ParamVisitor& v) {
    v.value({.name = "from",
             .doc = "name of a camera in a collider's file, used instead of position, target and fieldOfView; without roll",
             .fixed = kFixed},
            from);
    v.value({"position", "m", "position of the eye", -kMaxPosition, kMaxPosition}, position);
    v.value({"target", "m", "point at the centre of the picture", -kMaxPosition, kMaxPosition}, target);
    v.value({"fieldOfView", "deg", "vertical angle of view", 5, 120}, fieldOfView);
    v.value({"exposure", "stops", "light in the picture: each stop doubles it", -6, 6}, exposure);
    v.value({"bloom", "", "share of the light that the lens scatters around bright things; 0 = none", 0, 1}, bloom);
    v.value({"aperture", "f-number",
             "depth of field of a lens before a sensor 24 mm high: the smaller, the less is sharp; 0 = everything is sharp", 0, 64},
            aperture);
    v.value({"focus", "m", "distance along the view axis that is sharp; 0 = that of what is in the middle of the picture", 0, 1000}, focus);
}

void LightParams::visit(ParamVisitor& v) {
    v.value({.name = "from",
             .doc = "name of a directional light in a collider's file: its direction and tint are used, with the intensity below",
             .fixed = kFixed},
            from);
    v.value({"direction", "", "direction towards the light, of any length", -1.0e6, 1.0e6}, direction);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"intensity", "", "factor on the colour", 0, 100}, intensity);
    v.value({"fill", "", "light of the studio's softbox at the side, as a share of the key light; 0: it is only reflected", 0, 10}, fill);
    v.value({"rim", "", "light of the studio's softbox behind, as a share of the key light; 0: it is only reflected", 0, 10}, rim);
}

void BackgroundParams::visit(ParamVisitor& v) {
    v.colour({"horizon", "", "linear colour of the sky at eye level", 0, 10}, horizon);
    v.colour({"zenith", "", "linear colour of the sky overhead", 0, 10}, zenith);
    v.colour({"floor", "", "linear colour of the ground", 0, 1}, floor);
    v.value({"floorHeight", "m", "height of the ground", -kMaxPosition, kMaxPosition}, floorHeight);
    v.value({"tiles", "m", "side of the ground's square tiles; 0 = a plain ground", 0, 100}, tiles);
    v.value({.name = "showFloor", .doc = "whether the ground is drawn"}, showFloor);
    v.value({.name = "showBox", .doc = "whether the edges of the fluid's box are drawn"}, showBox);
    static const std::vector<std::string> skies = {"studio", "clouds"};
    v.choice({.name = "sky",
              .doc = "studio: a gradient and lamps; clouds: the sun's glow and clouds outdoors; made when the scene is loaded",
              .fixed = kFixed},
             sky, skies);
    v.value({"clouds", "", "share of the sky that is covered", 0, 1, kLinear, kFixed}, clouds);
    v.value({.name = "surroundings",
             .doc = "equirectangular picture (.hdr) that lights the scene and is its background, searched as a mesh is; none = use sky",
             .fixed = kFixed},
            surroundings);
    v.value({"surroundingsLevel", "", "factor on the light of surroundings", 0, 1000, kLinear, kFixed}, surroundingsLevel);
}

void BudgetParams::visit(ParamVisitor& v) {
    v.value({"frameMs", "ms", "limit on the cost of simulating 1/60 s; 0 = no budget: all values are those of fluid", 0, 10000, kLinear,
             kFixed},
            frameMs);
    v.value({"maxDensityError", "", "limit on the compression of water, mean over particles and time, a fraction", 1.0e-5, 1, kLog, kFixed},
            maxDensityError);
    v.value({"finest", "m", "the finest spacing that may be picked; 0 = fluid.spacing", 0, 100, kLinear, kFixed}, finest);
}

void SceneFile::visit(ParamVisitor& v) {
    v.value({.name = "name", .doc = "name of the outputs"}, name);
    v.value({.name = "doc", .doc = "one sentence about the scene"}, doc);
    v.value({"duration", "s", "simulated time of a run without --seconds or --frames", 0, 3600}, duration);
    v.value({"timeScale", "", "simulated seconds per second shown: 0.1 = ten times slower than real time", 1.0e-4, 1, kLog}, timeScale);
    v.group({.name = "fluid", .doc = "the fluid and its simulation"}, fluid);
    v.list({.name = "colliders", .doc = "solids", .fixed = kFixed}, colliders);
    v.list({.name = "emitters", .doc = "sources of fluid"}, emitters);
    v.list({.name = "sinks", .doc = "regions that remove fluid"}, sinks);
    v.list({.name = "dry", .doc = "volumes that stay dry, such as the inside of a boat"}, dry);
    v.group({.name = "pour", .doc = "the jet that a person pours (key P)"}, pour);
    v.list({.name = "bodies", .doc = "rigid bodies that float or sink in the fluid", .fixed = kFixed}, bodies);
    v.list({.name = "flow", .doc = "skins with a liquid on them: tears, rain, sweat", .fixed = kFixed}, flow);
    v.group({.name = "look", .doc = "look of the fluid"}, look);
    v.group({.name = "camera", .doc = "point of view"}, camera);
    v.group({.name = "light", .doc = "the sun"}, light);
    v.group({.name = "background", .doc = "sky and ground"}, background);
    v.group({.name = "budget", .doc = "limits on cost and error: method, spacing and steps are picked from the measured chart"}, budget);
    v.list({.name = "presets", .doc = "groups of values, set by a button or --preset"}, presets);
    v.value({.name = "sliders", .doc = "parameters that the window shows above all others: their paths, separated by ', '"}, sliders);
}

std::vector<std::string> slidersOf(std::string_view list) {
    std::vector<std::string> paths;
    while (!list.empty()) {
        std::string_view one = list.substr(0, list.find(','));
        list.remove_prefix(std::min(one.size() + 1, list.size()));
        while (one.starts_with(' ')) one.remove_prefix(1);
        while (one.ends_with(' ')) one.remove_suffix(1);
        if (!one.empty()) paths.emplace_back(one);
    }
    return paths;
}

Status checkScene(const SceneFile& scene) {
    const std::string wrong = contradiction(scene);
    return wrong.empty() ? ok() : badInput(wrong);
}

namespace {

// The file of a scene: as findAsset, or by its name in `rivulet list scenes`.
Result<std::string> findScene(const std::string& path) {
    Result<std::string> file = findAsset(path, "");
    const fs::path typed(path);
    if (file || typed.has_parent_path()) return file;
    const std::string stem = typed.stem().string();
    if (Result<std::string> scene = findAsset("scenes/" + stem + ".json", "")) return scene;
    std::vector<std::string> names;
    for (const SceneListing& s : listScenes()) {
        names.push_back(fs::path(s.path).stem().string());
        if (names.back() == stem) return s.path;
    }
    const std::string near = nearestName(stem, names);
    const std::string remedy = near.empty() ? "`rivulet list scenes` prints all scenes" : fmt::format("did you mean the scene {}?", near);
    return badInput(fmt::format("{}; {}", file.error().message, remedy));
}

}  // namespace

namespace {

// Replaces skins by their alternative (`instead`) if its mesh is found and no assignment sets a mesh.
Status useAlternatives(SceneFile& scene, std::span<const std::string> assignments) {
    for (size_t k = 0; k < scene.flow.size(); ++k) {
        const bool asked = std::any_of(assignments.begin(), assignments.end(),
                                       [&](const std::string& a) { return a.starts_with(fmt::format("flow.{}.mesh=", k)); });
        if (asked) scene.flow[k].instead.clear();  // a saved scene keeps the mesh that was asked for
        if (scene.flow[k].instead.empty()) continue;
        const Result<std::string> file = findAsset(scene.flow[k].instead, scene.folder);
        if (!file) return badInput(fmt::format("flow[{}].instead: {}", k, file.error().message));
        FlowParams other = scene.flow[k];
        if (Status read = readJsonFile(*file, [&](ParamVisitor& v) { other.visit(v); }); !read) return read;
        if (findAsset(other.mesh, scene.folder)) scene.flow[k] = other;
    }
    return ok();
}

// Values and keys that had another name in an earlier version, by the error that the old name causes. A rename adds a row.
struct Renamed {
    std::string_view error, hint;
};
constexpr Renamed kRenamed[] = {
    {"look.renderer is \"truth\"", "truth is the earlier name of reference"},
};

Error withNewName(Error error) {
    for (const Renamed& row : kRenamed)
        if (error.message.find(row.error) != std::string::npos) error.message += fmt::format("; {}", row.hint);
    return error;
}

}  // namespace

Status applyPreset(SceneFile& scene, const std::string& name) {
    std::vector<std::string> names;
    for (const PresetParams& preset : scene.presets) names.push_back(preset.name);
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
        return badInput(names.empty()
                            ? fmt::format("the scene {} has no presets", scene.name)
                            : fmt::format("the scene {} has no preset `{}`; there are {}", scene.name, name, fmt::join(names, ", ")));
    SceneFile changed = scene;
    std::string_view rest = scene.presets[static_cast<size_t>(at - names.begin())].set;
    while (!rest.empty()) {
        std::string_view one = rest.substr(0, rest.find(';'));
        rest.remove_prefix(std::min(one.size() + 1, rest.size()));
        while (one.starts_with(' ')) one.remove_prefix(1);
        if (one.empty()) continue;
        if (Status set = setParam(one, visiting(changed)); !set)
            return withNewName(badInput(fmt::format("the preset `{}` of {}: {}", name, scene.name, set.error().message)));
    }
    scene = std::move(changed);
    return ok();
}

Result<SceneFile> loadScene(const std::string& path, std::span<const std::string> assignments, const std::string& preset) {
    Result<std::string> file = findScene(path);
    if (!file) return file.error();
    SceneFile scene;
    const VisitFn visit = visiting(scene);
    if (Status read = readJsonFile(*file, visit); !read) return withNewName(read.error());
    scene.folder = fs::path(*file).parent_path().string();
    scene.source = {*file, preset, {assignments.begin(), assignments.end()}};
    if (Status used = useAlternatives(scene, assignments); !used) return used.error();
    if (!preset.empty())
        if (Status set = applyPreset(scene, preset); !set) return set.error();
    for (const std::string& assignment : assignments)
        if (Status set = setParam(assignment, visit); !set)
            return withNewName(badInput("--set " + assignment + ": " + set.error().message));
    if (Status sense = checkScene(scene); !sense) return badInput(*file + ": " + sense.error().message);
    if (const std::string wrong = wrongSlider(scene); !wrong.empty()) return badInput(*file + ": " + wrong);
    return scene;
}

namespace {

// Rewrites paths of a scene relative to another folder.
class FileMover final : public ParamVisitor {
  public:
    FileMover(std::string from, std::string to) : from_(std::move(from)), to_(std::move(to)) {}
    void value(const ParamInfo&, float&) override {}
    void value(const ParamInfo&, int&) override {}
    void value(const ParamInfo&, bool&) override {}
    void value(const ParamInfo&, vec3&) override {}
    void colour(const ParamInfo&, vec3&) override {}
    void choice(const ParamInfo&, std::string&, std::span<const std::string>) override {}
    void value(const ParamInfo&, std::string& v) override {
        const fs::path named(v);
        if (!named.is_relative() || named.extension().empty()) return;
        const Result<std::string> before = findAsset(v, from_), then = findAsset(v, to_);
        std::error_code error;
        if (!before || (then && fs::equivalent(*before, *then, error))) return;
        const fs::path whole = fs::absolute(*before, error);
        if (!error) v = whole.lexically_normal().string();
    }

  protected:
    bool beginGroup(const ParamInfo&) override { return true; }
    void endGroup() override {}
    size_t beginList(const ParamInfo&, size_t current) override { return current; }
    void beginItem(size_t) override {}
    void endItem() override {}
    void endList() override {}

  private:
    std::string from_, to_;
};

}  // namespace

Status saveScene(SceneFile& scene, const std::string& path) {
    const std::string folder = fs::path(path).parent_path().string();
    SceneFile moved = scene, none;
    FileMover mover(scene.folder, folder);
    moved.visit(mover);
    moved.folder = folder;
    const VisitFn defaults = visiting(none);
    if (Status written = writeFileAtomic(path, writeJson(visiting(moved), &defaults)); !written) return written;
    scene = std::move(moved);
    return ok();
}

Result<std::string> findAsset(const std::string& path, const std::string& sceneFolder) {
    std::vector<fs::path> places = {path};
    if (fs::path(path).is_relative()) {
        if (!sceneFolder.empty()) places.push_back(fs::path(sceneFolder) / path);
        for (const fs::path& folder : assetFolders()) places.push_back(folder / path);
    }
    for (const fs::path& place : places)
        if (isFile(place)) {
            const Status readable = checkInput(place.string());
            return readable ? Result<std::string>(place.string()) : readable.error();
        }
    std::error_code error;
    if (fs::is_directory(path, error)) return badInput(fmt::format("{} is a folder, not a file", path));
    if (places.size() == 1) return badInput(fmt::format("{} does not exist", path));
    std::vector<std::string> looked;
    looked.reserve(places.size());
    for (const fs::path& place : places) looked.push_back(place.string());
    for (const fs::path& folder : assetFolders())  // an asset that cannot be shipped has a script that downloads it
        if (const fs::path script = folder / ("fetch_" + fs::path(path).stem().string() + ".sh"); isFile(script))
            return badInput(fmt::format("{} does not exist; `bash {}` downloads it", path, script.string()));
    return badInput(fmt::format("{} does not exist; searched {}", path, fmt::join(looked, ", ")));
}

namespace {

// The names in the scenes.txt beside a folder of scenes, a line each; lines that begin with # are comments.
std::vector<std::string> orderIn(const fs::path& folder) {
    std::vector<std::string> names;
    const Result<std::string> text = readFile((folder / "scenes.txt").string());
    if (!text) return names;
    std::istringstream lines(*text);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty() && line.front() != '#') names.push_back(line);
    return names;
}

std::string missingAsset(SceneFile& scene) {
    if (!useAlternatives(scene, {})) return "";  // opening it says why
    for (const ParamEntry& entry : listParams(visiting(scene))) {
        const bool file = entry.path.ends_with(".mesh") || entry.path == "background.surroundings";
        if (!file || entry.path.find("[]") != std::string::npos) continue;
        const std::string name = plainText(entry.text);
        if (!name.empty() && !findAsset(name, scene.folder)) return name;
    }
    return "";
}

}  // namespace

std::vector<SceneListing> listScenes() {
    std::vector<fs::path> folders = {"."};
    for (const fs::path& folder : assetFolders()) folders.push_back(folder);
    std::vector<SceneListing> listings;
    std::set<fs::path> seen;  // one folder may be listed twice
    std::vector<std::string> order;
    for (const fs::path& folder : folders) {
        for (std::string& name : orderIn(folder)) order.push_back(std::move(name));
        for (const fs::path& path : entriesOf(folder / "scenes")) {
            std::error_code ignored;
            if (path.extension() != ".json" || !isFile(path) || !seen.insert(fs::weakly_canonical(path, ignored)).second) continue;
            SceneFile scene;
            const Status read = readJsonFile(path.string(), visiting(scene));
            scene.folder = path.parent_path().string();
            listings.push_back({path.string(), read ? scene.name : path.stem().string(), read ? scene.doc : read.error().message,
                                read ? missingAsset(scene) : ""});
        }
    }
    const auto place = [&order](const SceneListing& scene) {
        return std::find(order.begin(), order.end(), fs::path(scene.path).stem().string()) - order.begin();
    };
    std::sort(listings.begin(), listings.end(), [&place](const SceneListing& a, const SceneListing& b) {
        const auto first = place(a), second = place(b);
        return first != second ? first < second : a.path < b.path;
    });
    return listings;
}

}  // namespace rivulet
