#include "fluid/scene/collider_params.h"

#include <fmt/format.h>

#include "fluid/scene/collider_kinds.h"

namespace rivulet {

namespace {

constexpr double kFar = 1.0e5;  // m
constexpr bool kLog = true, kLinear = false;
constexpr bool kFixed = true;
constexpr float kShortest = 1.0e-6F;  // of a direction

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }

std::string docOfKinds() {
    std::string doc;
    for (const ColliderKind& kind : colliderKinds().rows) doc += fmt::format("{}{}: {}", doc.empty() ? "" : "; ", kind.name, kind.doc);
    return doc;
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
    static const std::vector<std::string> shapes = colliderKinds().names();
    static const std::string kinds = docOfKinds();
    v.choice({.name = "shape", .doc = kinds.c_str(), .fixed = kFixed}, shape, shapes);
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

std::string contradiction(const ColliderParams& collider) {
    if (collider.resolution == 1) return ".resolution is 1: give 2 or more, or 0 for what suits the fluid";
    const ColliderKind& kind = kindOf(collider);
    if (std::string wrong = kind.contradiction(collider); !wrong.empty()) return wrong;
    for (const auto& [name, value] : {std::pair("friction", collider.friction), std::pair("restitution", collider.restitution)})
        if (value < 0 && value != -1) return fmt::format(".{} is {}: give 0 or more, or -1 for what fluid.collision says", name, value);
    const ColliderMotion& motion = collider.motion;
    const ColliderWave& wave = collider.wave;
    const bool plays = collider.animation.speed > 0;
    if (!kind.hasTriangles()) {
        if (motion.moves() || wave.amplitude > 0)
            return fmt::format(" is a {}, which stands still: make it a mesh, or take its motion and wave away", kind.name);
        if (plays) return fmt::format(" is a {}, which has no animation: make it a mesh", kind.name);
        if (!collider.solid) return fmt::format(" is a {}, which must be solid", kind.name);
    }
    if (motion.moves() && wave.amplitude > 0) return " has both a motion and a wave: it can have one of them";
    if (plays && (motion.moves() || wave.amplitude > 0))
        return fmt::format(" has an animation and a {}: it can have one of them", motion.moves() ? "motion" : "wave");
    if (!collider.solid && wave.amplitude > 0) return " has a wave, which must be solid";
    if (motion.spin != 0 && glm::length(motion.axis) < kShortest)
        return fmt::format(".motion.axis is {}, must have a length", shown(motion.axis));
    for (size_t k = 1; k < motion.keys.size(); ++k)
        if (!(motion.keys[k].time > motion.keys[k - 1].time))
            return fmt::format(".motion.keys[{}].time is {} s, must be later than the key before, {} s", k, motion.keys[k].time,
                               motion.keys[k - 1].time);
    if (wave.amplitude > 0 && (glm::length(wave.along) < kShortest || glm::length(wave.direction) < kShortest))
        return ".wave.along and direction must have a length";
    return "";
}

}  // namespace rivulet
