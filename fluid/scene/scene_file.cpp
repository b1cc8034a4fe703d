#include "fluid/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <tuple>

#include "engine/core/file.h"
#include "engine/core/json.h"
#include "engine/core/table.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr double kFar = 1.0e5;  // m
constexpr bool kLog = true, kLinear = false;
constexpr bool kFixed = true;

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

bool inside(const vec3& p, const BoxParams& box) { return glm::clamp(p, box.min, box.max) == p; }

// "", or what makes no sense together; a single value's range was checked when it was read.
std::string contradiction(const SceneFile& scene) {
    const BoxParams& box = scene.fluid.box;
    if (!glm::all(glm::lessThan(box.min, box.max)))
        return fmt::format("fluid.box.min {} must lie below fluid.box.max {} on every axis", shown(box.min), shown(box.max));
    for (size_t i = 0; i < scene.fluid.blocks.size(); ++i) {
        const BlockParams& block = scene.fluid.blocks[i];
        if (!glm::all(glm::lessThanEqual(block.min, block.max)))
            return fmt::format("fluid.blocks[{}].min {} must not lie above its max {}", i, shown(block.min), shown(block.max));
        if (!inside(block.min, box) || !inside(block.max, box))
            return fmt::format("fluid.blocks[{}] from {} to {} reaches out of fluid.box from {} to {}", i, shown(block.min),
                               shown(block.max), shown(box.min), shown(box.max));
    }
    const FoamParams& foam = scene.fluid.foam;
    for (const auto& [name, from, to] : {std::tuple("air", foam.airFrom, foam.airTo), std::tuple("crest", foam.crestFrom, foam.crestTo),
                                         std::tuple("speed", foam.speedFrom, foam.speedTo)})
        if (!(from < to)) return fmt::format("fluid.foam.{0}From is {1}: it must lie below {0}To, which is {2}", name, from, to);
    std::set<std::pair<float, float>> kinds;
    for (const ColliderParams& collider : scene.colliders) kinds.emplace(collider.friction, collider.restitution);
    if (scene.colliders.size() > kMostSurfaces && kinds.size() > kMostSurfaces)
        return fmt::format("colliders have {} different pairs of friction and restitution, there may be {}: give some the same",
                           kinds.size(), kMostSurfaces);
    for (size_t i = 0; i < scene.colliders.size(); ++i) {
        const ColliderParams& collider = scene.colliders[i];
        if (collider.resolution == 1) return fmt::format("colliders[{}].resolution is 1: give 2 or more, or 0 for what suits the fluid", i);
        if (collider.shape == "mesh" && collider.mesh.empty())
            return fmt::format("colliders[{}].mesh is empty: name a mesh file, or make its shape a plane", i);
        if (collider.shape == "plane" && glm::length(collider.normal) < 1.0e-6F)
            return fmt::format("colliders[{}].normal is {}, must have a length", i, shown(collider.normal));
        for (const auto& [name, value] : {std::pair("friction", collider.friction), std::pair("restitution", collider.restitution)})
            if (value < 0 && value != -1)
                return fmt::format("colliders[{}].{} is {}: give 0 or more, or -1 for what fluid.collision says", i, name, value);
        const ColliderMotion& motion = collider.motion;
        const ColliderWave& wave = collider.wave;
        if (collider.shape == "plane" && (motion.moves() || wave.amplitude > 0))
            return fmt::format("colliders[{}] is a plane, which stands still: make it a mesh, or take its motion and wave away", i);
        if (motion.moves() && wave.amplitude > 0)
            return fmt::format("colliders[{}] has both a motion and a wave: it can have one of them", i);
        if (collider.animation.speed > 0) {
            if (collider.shape == "plane") return fmt::format("colliders[{}] is a plane, which has no animation: make it a mesh", i);
            if (motion.moves() || wave.amplitude > 0)
                return fmt::format("colliders[{}] has an animation and a {}: it can have one of them", i,
                                   motion.moves() ? "motion" : "wave");
        }
        if (!collider.solid && (collider.shape == "plane" || wave.amplitude > 0))
            return fmt::format("colliders[{}] {}, which must be solid", i, collider.shape == "plane" ? "is a plane" : "has a wave");
        if (motion.spin != 0 && glm::length(motion.axis) < 1.0e-6F)
            return fmt::format("colliders[{}].motion.axis is {}, must have a length", i, shown(motion.axis));
        for (size_t k = 1; k < motion.keys.size(); ++k)
            if (!(motion.keys[k].time > motion.keys[k - 1].time))
                return fmt::format("colliders[{}].motion.keys[{}].time is {} s, must be later than the key before, {} s", i, k,
                                   motion.keys[k].time, motion.keys[k - 1].time);
        if (wave.amplitude > 0 && (glm::length(wave.along) < 1.0e-6F || glm::length(wave.direction) < 1.0e-6F))
            return fmt::format("colliders[{}].wave.along and direction must have a length", i);
    }
    for (size_t i = 0; i < scene.emitters.size(); ++i) {
        const EmitterParams& emitter = scene.emitters[i];
        if (const std::string wrong = contradiction(emitter); !wrong.empty()) return fmt::format("emitters[{}].{}", i, wrong);
        if (emitter.shape == "mesh" && emitter.mesh.empty())
            return fmt::format("emitters[{}].mesh is empty: name a mesh file, or make its shape a nozzle or a box", i);
        if (emitter.shape != "mesh" && !inside(emitter.position, box))
            return fmt::format("emitters[{}].position {} is out of fluid.box from {} to {}", i, shown(emitter.position), shown(box.min),
                               shown(box.max));
    }
    if (scene.look.refractiveIndex != 0 && scene.look.refractiveIndex < 1)
        return fmt::format("look.refractiveIndex is {}: give 1 or more, or 0 for the liquid's", scene.look.refractiveIndex);
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyParams& body = scene.bodies[i];
        if ((body.shape == "mesh" || body.shape == "hull") && body.mesh.empty())
            return fmt::format("bodies[{}].mesh is empty: name a mesh file, or make its shape a box or a sphere", i);
        if (!body.parts.empty() && body.shape != "mesh" && body.shape != "hull")
            return fmt::format("bodies[{}] is a {}: parts are drawn with a hull or mesh alone", i, body.shape);
        if (!inside(body.position, box))
            return fmt::format("bodies[{}].position {} must lie in fluid.box from {} to {}", i, shown(body.position), shown(box.min),
                               shown(box.max));
    }
    const vec3 sight = scene.camera.target - scene.camera.position;
    if (glm::length(sight) < 1.0e-6F) return fmt::format("camera.target {} must not be where the camera is", shown(scene.camera.target));
    if (glm::length(scene.light.direction) < 1.0e-6F)
        return fmt::format("light.direction is {}, must have a length", shown(scene.light.direction));
    return "";
}

// Folders that hold what the program brings along, the user's own first.
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

VisitFn visiting(SceneFile& scene) {
    return [&scene](ParamVisitor& v) { scene.visit(v); };
}

}  // namespace

void ColliderKey::visit(ParamVisitor& v) {
    v.value({"time", "s", "when it is there", 0, 3600}, time);
    v.value({"position", "m", "added to the collider's", -kFar, kFar}, position);
    v.value({"rotation", "deg", "about x, then y, then z, after the collider's own", -36000, 36000}, rotation);
}

void ColliderMotion::visit(ParamVisitor& v) {
    v.value({"axis", "", "what it spins about, through its position; of any length", -1.0e6, 1.0e6}, axis);
    v.value({"spin", "deg/s", "how fast it spins, right-handed", -7200, 7200}, spin);
    v.value({"shake", "m", "how far it swings to and fro", -100, 100}, shake);
    v.value({"shakeFrequency", "Hz", "how often it does", 0, 100}, shakeFrequency);
    v.list({.name = "keys", .doc = "places at times, in order; between them it moves smoothly, after the last it stays"}, keys);
}

void ColliderWave::visit(ParamVisitor& v) {
    v.value({"amplitude", "m", "height of the wave; 0 = none, as beside bodies, which would pass through", 0, 100, kLinear, kFixed},
            amplitude);
    v.value({"length", "m", "from crest to crest", 0.001, kFar, kLog}, length);
    v.value({"period", "s", "from crest to crest; it rises to its height in the first", 0.01, 3600, kLog}, period);
    v.value({"along", "", "the way it runs, of any length", -1.0e6, 1.0e6}, along);
    v.value({"direction", "", "the way it lifts, of any length", -1.0e6, 1.0e6, kLinear, kFixed}, direction);
}

void ColliderAnimation::visit(ParamVisitor& v) {
    v.value({.name = "clip", .doc = "an animation of the mesh file, by name; none = its first", .fixed = kFixed}, clip);
    v.value({"speed", "", "how fast it plays: 1 = as in the file; 0 = it does not, the mesh stands as its file has it", 0, 100, kLinear,
             kFixed},
            speed);
    v.value({.name = "loops", .doc = "whether it begins again at its end, or stays there", .fixed = kFixed}, loops);
}

void ColliderParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"mesh", "plane"};
    v.choice({.name = "shape", .doc = "a mesh from a file, or a plane with fluid on the side of its normal", .fixed = kFixed}, shape,
             shapes);
    v.value({.name = "mesh", .doc = "mesh file: as given, beside the scene, in RIVULET_ASSETS, in assets/", .fixed = kFixed}, mesh);
    v.value({"resolution", "", "voxels along the mesh's longest side; 0 = so many that a voxel is a quarter of the fluid's spacing", 0,
             2048, kLinear, kFixed},
            resolution);
    v.value({"position", "m", "where the mesh's origin goes (with fitSize: its middle); of a plane: a point on it", -kFar, kFar, kLinear,
             kFixed},
            position);
    v.value({"rotation", "deg", "of a mesh, about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"scale", "", "of a mesh", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that a mesh's longest side is scaled to, instead of scale; 0 = scale holds", 0, kFar, kLog, kFixed},
            fitSize);
    v.value({"normal", "", "of a plane, of any length", -1.0e6, 1.0e6, kLinear, kFixed}, normal);
    v.value({"friction", "", "Coulomb friction; -1 = as fluid.collision says", -1, 10}, friction);
    v.value({"restitution", "", "share of the speed into it that comes back; -1 = as fluid.collision says", -1, 1}, restitution);
    v.group({.name = "motion", .doc = "how a mesh moves as a whole"}, motion);
    v.group({.name = "wave", .doc = "a wave that bends a mesh"}, wave);
    v.group({.name = "animation", .doc = "how a mesh moves that has animations in its file, instead of a motion or a wave"}, animation);
    v.value({.name = "solid", .doc = "whether water and bodies meet it; off: a mesh is only drawn", .fixed = kFixed}, solid);
    static const std::vector<std::string> looks = {"file", "scene"};
    v.choice({.name = "materials",
              .doc = "of a mesh: file = those of its file, where it has some; scene = colour, roughness and so on for all of it"},
             materials, looks);
    v.colour({"colour", "", "linear red, green, blue, where the file has no material, or materials is scene", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
    v.value({"metallic", "", "0 = stone or paint, 1 = metal", 0, 1}, metallic);
    v.value(
        {"opacity", "", "1 = what is behind it is hidden; less: glass, whose wall takes this share of the light and tints the rest", 0, 1},
        opacity);
    v.value({"grain", "", "0 = smooth and of one colour, 1 = coarse, mottled stone", 0, 1}, grain);
    v.value({"grainSize", "m", "of the grain's largest spots; there are finer ones in them", 1.0e-4, kFar, kLog}, grainSize);
    v.value({.name = "visible", .doc = "whether it is drawn; it is solid either way"}, visible);
}

void BodyPartParams::visit(ParamVisitor& v) {
    v.value({.name = "mesh", .doc = "mesh file, found as a collider's; scaled and turned as the body's own", .fixed = kFixed}, mesh);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
}

void BodyParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "sphere", "hull", "mesh"};
    v.choice({.name = "shape", .doc = "a box, a sphere, the convex hull of a mesh, or a closed mesh", .fixed = kFixed}, shape, shapes);
    v.value({.name = "mesh", .doc = "mesh file of a hull or mesh, found as a collider's", .fixed = kFixed}, mesh);
    v.value({"size", "m", "of a box", 1.0e-4, kFar, kLog, kFixed}, size);
    v.value({"radius", "m", "of a sphere", 1.0e-4, kFar, kLog, kFixed}, radius);
    v.value({"scale", "", "of a hull or mesh", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that a mesh's longest side is scaled to, instead of scale; 0 = scale holds", 0, kFar, kLog, kFixed},
            fitSize);
    v.value({"position", "m", "of its middle; of a hull or mesh: where the mesh's origin goes (with fitSize: its middle)", -kFar, kFar,
             kLinear, kFixed},
            position);
    v.value({"rotation", "deg", "about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"velocity", "m/s", "at t = 0", -1000, 1000, kLinear, kFixed}, velocity);
    v.value({"spin", "deg/s", "at t = 0, about its centre of mass", -36000, 36000, kLinear, kFixed}, spin);
    v.value({"density", "kg/m^3", "mean, of what it is made of; water has about 1000", 0.01, 1.0e5, kLog, kFixed}, density);
    v.value({"mass", "kg", "instead of a density; 0 = as density says", 0, 1.0e9, kLog, kFixed}, mass);
    v.value({"ballast", "m", "from the middle of its volume to its centre of mass, before it is turned: a keel's weight", -1000, 1000,
             kLinear, kFixed},
            ballast);
    v.value({"friction", "", "Coulomb friction with walls and other bodies", 0, 10, kLinear, kFixed}, friction);
    v.value({"restitution", "", "share of the speed that comes back from walls and other bodies", 0, 1, kLinear, kFixed}, restitution);
    v.value({.name = "fixed", .doc = "whether it stands still: a wall of boundary particles", .fixed = kFixed}, fixed);
    v.value({.name = "sticks", .doc = "whether fluid sticks to it (no-slip) or slips along", .fixed = kFixed}, sticks);
    v.list({.name = "parts", .doc = "meshes that are drawn with a hull or mesh", .fixed = kFixed}, parts);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
    v.value({.name = "visible", .doc = "whether it is drawn"}, visible);
}

void CameraParams::visit(ParamVisitor& v) {
    v.value({.name = "from",
             .doc = "a camera of a collider's file, by name, instead of position, target and fieldOfView; up stays up",
             .fixed = kFixed},
            from);
    v.value({"position", "m", "where the eye is", -kFar, kFar}, position);
    v.value({"target", "m", "the point looked at", -kFar, kFar}, target);
    v.value({"fieldOfView", "deg", "vertical angle of view", 5, 120}, fieldOfView);
}

void LightParams::visit(ParamVisitor& v) {
    v.value({.name = "from",
             .doc = "a directional light of a collider's file, by name: its direction and tint, the intensity stays",
             .fixed = kFixed},
            from);
    v.value({"direction", "", "towards the light, of any length", -1.0e6, 1.0e6}, direction);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"intensity", "", "factor on the colour", 0, 100}, intensity);
}

void BackgroundParams::visit(ParamVisitor& v) {
    v.colour({"horizon", "", "linear colour of the sky at eye level", 0, 10}, horizon);
    v.colour({"zenith", "", "linear colour of the sky overhead", 0, 10}, zenith);
    v.colour({"floor", "", "linear colour of the ground", 0, 1}, floor);
    v.value({"floorHeight", "m", "height of the ground", -kFar, kFar}, floorHeight);
    v.value({.name = "showFloor", .doc = "whether the ground is drawn"}, showFloor);
    v.value({.name = "showBox", .doc = "whether the edges of the fluid's box are drawn"}, showBox);
    static const std::vector<std::string> skies = {"studio", "clouds"};
    v.choice({.name = "sky",
              .doc = "a gradient and lamps, or the sun's glow and clouds outdoors, made when the scene is loaded",
              .fixed = kFixed},
             sky, skies);
    v.value({"clouds", "", "share of the sky that they cover", 0, 1, kLinear, kFixed}, clouds);
    v.value({.name = "surroundings",
             .doc = "equirectangular picture (.hdr) that lights the scene and is seen behind it, found as a mesh is; none = as sky says",
             .fixed = kFixed},
            surroundings);
    v.value({"surroundingsLevel", "", "factor on its light", 0, 1000, kLinear, kFixed}, surroundingsLevel);
}

void BudgetParams::visit(ParamVisitor& v) {
    v.value({"frameMs", "ms", "what simulating a sixtieth of a second may take; 0 = no budget: all is as fluid says", 0, 10000, kLinear,
             kFixed},
            frameMs);
    v.value({"maxDensityError", "", "how far water may be compressed, mean over particles and time, a fraction", 1.0e-5, 1, kLog, kFixed},
            maxDensityError);
    v.value({"finest", "m", "a finer spacing is not picked; 0 = fluid.spacing, which it is from then on", 0, 100, kLinear, kFixed}, finest);
}

void SceneFile::visit(ParamVisitor& v) {
    v.value({.name = "name", .doc = "what outputs are called after"}, name);
    v.value({.name = "doc", .doc = "one sentence on what is to be seen"}, doc);
    v.value({"duration", "s", "simulated time of a run that is given no other", 0, 3600}, duration);
    v.value({"timeScale", "", "simulated seconds in a second that is shown: 0.1 = ten times slower than life", 1.0e-4, 1, kLog}, timeScale);
    v.group({.name = "fluid", .doc = "what flows, and how it is simulated"}, fluid);
    v.list({.name = "colliders", .doc = "what is solid", .fixed = kFixed}, colliders);
    v.list({.name = "emitters", .doc = "where fluid comes in"}, emitters);
    v.list({.name = "sinks", .doc = "where fluid goes"}, sinks);
    v.group({.name = "pour", .doc = "what a hand pours in, by the key P"}, pour);
    v.list({.name = "bodies", .doc = "what floats or sinks, and is pushed by the fluid", .fixed = kFixed}, bodies);
    v.list({.name = "flow", .doc = "skins that something flows on: tears, rain, sweat", .fixed = kFixed}, flow);
    v.group({.name = "look", .doc = "how the fluid is drawn"}, look);
    v.group({.name = "camera", .doc = "where the picture is taken from"}, camera);
    v.group({.name = "light", .doc = "the sun"}, light);
    v.group({.name = "background", .doc = "sky and ground"}, background);
    v.group({.name = "budget", .doc = "what a frame may take: picks method, spacing and steps from the measured chart"}, budget);
    v.list({.name = "presets", .doc = "values that are set together, by a button or --preset"}, presets);
}

Status checkScene(const SceneFile& scene) {
    const std::string wrong = contradiction(scene);
    return wrong.empty() ? ok() : badInput(wrong);
}

namespace {

// Where a scene is: as findAsset says, or by the name it has in `rivulet list scenes`.
Result<std::string> findScene(const std::string& path) {
    Result<std::string> file = findAsset(path, "");
    const fs::path typed(path);
    if (file || typed.has_parent_path()) return file;
    const std::string stem = typed.stem().string();
    std::vector<std::string> names;
    for (const SceneListing& s : listScenes()) {
        names.push_back(fs::path(s.path).stem().string());
        if (names.back() == stem) return s.path;
    }
    const std::string near = nearestName(stem, names);
    const std::string remedy =
        near.empty() ? "`rivulet list scenes` names those there are" : fmt::format("did you mean the scene {}?", near);
    return badInput(fmt::format("{}; {}", file.error().message, remedy));
}

}  // namespace

namespace {

// Skins that give way to another where its mesh is found, and nobody has asked for one.
Status takeInsteads(SceneFile& scene, std::span<const std::string> assignments) {
    for (size_t k = 0; k < scene.flow.size(); ++k) {
        const bool asked = std::any_of(assignments.begin(), assignments.end(),
                                       [&](const std::string& a) { return a.starts_with(fmt::format("flow.{}.mesh=", k)); });
        if (scene.flow[k].instead.empty() || asked) continue;
        const Result<std::string> file = findAsset(scene.flow[k].instead, scene.folder);
        if (!file) return badInput(fmt::format("flow[{}].instead: {}", k, file.error().message));
        FlowParams other = scene.flow[k];
        if (Status read = readJsonFile(*file, [&](ParamVisitor& v) { other.visit(v); }); !read) return read;
        if (findAsset(other.mesh, scene.folder)) scene.flow[k] = other;
    }
    return ok();
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
            return badInput(fmt::format("the preset `{}` of {}: {}", name, scene.name, set.error().message));
    }
    scene = std::move(changed);
    return ok();
}

Result<SceneFile> loadScene(const std::string& path, std::span<const std::string> assignments, const std::string& preset) {
    Result<std::string> file = findScene(path);
    if (!file) return file.error();
    SceneFile scene;
    const VisitFn visit = visiting(scene);
    if (Status read = readJsonFile(*file, visit); !read) return read.error();
    scene.folder = fs::path(*file).parent_path().string();
    scene.source = {*file, preset, {assignments.begin(), assignments.end()}};
    if (Status taken = takeInsteads(scene, assignments); !taken) return taken.error();
    if (!preset.empty())
        if (Status set = applyPreset(scene, preset); !set) return set.error();
    for (const std::string& assignment : assignments)
        if (Status set = setParam(assignment, visit); !set) return badInput("--set " + assignment + ": " + set.error().message);
    if (Status sense = checkScene(scene); !sense) return badInput(*file + ": " + sense.error().message);
    return scene;
}

namespace {

// Files that a scene names, seen from another folder.
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
        v = fs::absolute(*before).lexically_normal().string();
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
        if (isFile(place)) return place.string();
    std::error_code error;
    if (fs::is_directory(path, error)) return badInput(fmt::format("{} is a folder, not a file", path));
    if (places.size() == 1) return badInput(fmt::format("{} does not exist", path));
    std::vector<std::string> looked;
    looked.reserve(places.size());
    for (const fs::path& place : places) looked.push_back(place.string());
    for (const fs::path& folder : assetFolders())  // what may not be shipped is fetched
        if (const fs::path script = folder / ("fetch_" + fs::path(path).stem().string() + ".sh"); isFile(script))
            return badInput(fmt::format("{} does not exist; `bash {}` brings it", path, script.string()));
    return badInput(fmt::format("{} does not exist; looked at {}", path, fmt::join(looked, ", ")));
}

std::vector<SceneListing> listScenes() {
    std::vector<fs::path> folders = {"."};
    for (const fs::path& folder : assetFolders()) folders.push_back(folder);
    std::vector<SceneListing> listings;
    std::set<fs::path> seen;  // one folder may be reached in several ways
    for (const fs::path& folder : folders) {
        std::error_code error;
        for (fs::directory_iterator at(folder / "scenes", error), end; !error && at != end; at.increment(error)) {
            std::error_code ignored;
            if (at->path().extension() != ".json" || !isFile(at->path()) || !seen.insert(fs::weakly_canonical(at->path(), ignored)).second)
                continue;
            SceneFile scene;
            const Status read = readJsonFile(at->path().string(), visiting(scene));
            listings.push_back(
                {at->path().string(), read ? scene.name : at->path().stem().string(), read ? scene.doc : read.error().message});
        }
    }
    std::sort(listings.begin(), listings.end(), [](const SceneListing& a, const SceneListing& b) { return a.path < b.path; });
    return listings;
}

}  // namespace rivulet
