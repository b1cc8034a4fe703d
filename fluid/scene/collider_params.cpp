#include "fluid/scene/collider_params.h"

#include <fmt/format.h>

#include "fluid/scene/collider_kinds.h"

namespace rivulet {

namespace {

constexpr float kShortest = 1.0e-6F;  // of a direction

std::string docOfKinds() {
    std::string doc;
    for (const ColliderKind& kind : colliderKinds().rows) doc += fmt::format("{}{}: {}", doc.empty() ? "" : "; ", kind.name, kind.doc);
    return doc;
}

}  // namespace

void ColliderKey::visit(ParamVisitor& v) {
    v.value({"time", "s", "time at which the pose is reached", 0, 3600}, time);
    v.value({"position", "m", "translation, added to the collider's own position", -kMaxPosition, kMaxPosition}, position);
    v.value({"rotation", "deg", "rotation about x, then y, then z, applied after the collider's own", -36000, 36000}, rotation);
}

void ColliderMotion::visit(ParamVisitor& v) {
    v.value({"axis", "", "axis of the spin, through its position; of any length", -1.0e6, 1.0e6}, axis);
    v.value({"spin", "deg/s", "angular speed, right-handed", -7200, 7200}, spin);
    v.value({"shake", "m", "amplitude of an oscillation", -100, 100}, shake);
    v.value({"shakeFrequency", "Hz", "frequency of the oscillation", 0, 100}, shakeFrequency);
    v.list({.name = "keys", .doc = "poses at times, in order; smooth between them, constant after the last"}, keys);
}

void ColliderWave::visit(ParamVisitor& v) {
    v.value({"amplitude", "m", "amplitude of the wave; 0 = none; not allowed in a scene with bodies", 0, 100, kLinear, kFixed}, amplitude);
    v.value({"length", "m", "wavelength, from crest to crest", 0.001, kMaxPosition, kLog}, length);
    v.value({"period", "s", "period, from crest to crest; the amplitude grows to its full value during the first one", 0.01, 3600, kLog},
            period);
    v.value({"along", "", "direction of travel, of any length", -1.0e6, 1.0e6}, along);
    v.value({"direction", "", "direction of the displacement, of any length", -1.0e6, 1.0e6, kLinear, kFixed}, direction);
}

void ColliderAnimation::visit(ParamVisitor& v) {
    v.value({.name = "clip", .doc = "an animation of the mesh file, by name; none = the first", .fixed = kFixed}, clip);
    v.value({"speed", "", "playing speed: 1 = that of the file; 0 = not played", 0, 100, kLinear, kFixed}, speed);
    v.value({.name = "loops", .doc = "whether it restarts at its end; off: it stops there", .fixed = kFixed}, loops);
}

void ColliderParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = colliderKinds().names();
    static const std::string kinds = docOfKinds();
    v.choice({.name = "shape", .doc = kinds.c_str(), .fixed = kFixed}, shape, shapes);
    v.value({.name = "mesh",
             .doc = "mesh file, searched in this order: the path itself, the scene's folder, RIVULET_ASSETS, assets/",
             .fixed = kFixed},
            mesh);
    v.value({"resolution", "", "voxels along the mesh's longest side; 0 = voxels of a quarter of the fluid's spacing", 0, 2048, kLinear,
             kFixed},
            resolution);
    v.value({"position", "m", "position of a mesh's origin (with fitSize: of its centre), or a point on a plane", -kMaxPosition,
             kMaxPosition, kLinear, kFixed},
            position);
    v.value({"rotation", "deg", "rotation of a mesh about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"scale", "", "scale factor of a mesh", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that a mesh's longest side is scaled to; 0 = use scale", 0, kMaxPosition, kLog, kFixed}, fitSize);
    v.value({"normal", "", "normal of a plane, of any length", -1.0e6, 1.0e6, kLinear, kFixed}, normal);
    v.value({"friction", "", "Coulomb friction; -1 = that of fluid.collision", -1, 10}, friction);
    v.value({"restitution", "", "share of the normal speed after the impact; -1 = that of fluid.collision", -1, 1}, restitution);
    v.group({.name = "motion", .doc = "rigid motion of a mesh"}, motion);
    v.group({.name = "wave", .doc = "a travelling wave that bends a mesh"}, wave);
    v.group({.name = "animation", .doc = "an animation of the mesh file, instead of a motion or a wave"}, animation);
    v.value({.name = "solid", .doc = "whether water and bodies collide with it; off: a mesh is only drawn", .fixed = kFixed}, solid);
    layers.visit(v);
    static const std::vector<std::string> looks = {"file", "scene"};
    v.choice(
        {.name = "materials", .doc = "materials of a mesh; file: those of its file, if it has any; scene: the values below for all parts"},
        materials, looks);
    v.colour({"colour", "", "linear red, green, blue; used where the file has no material, or materials is scene", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
    v.value({"metallic", "", "0 = stone or paint, 1 = metal", 0, 1}, metallic);
    v.value(
        {"porosity", "",
         "how much darker the surface is when wet (fluid.wetness): 0 = plastic or glaze, 1 = stone or cloth; -1 = by its roughness", -1, 1},
        porosity);
    v.value({"opacity", "", "1 = opaque; less: glass that absorbs this share of the light and tints the rest", 0, 1}, opacity);
    v.value({"grain", "", "0 = smooth and of one colour, 1 = coarse, mottled stone", 0, 1}, grain);
    v.value({"grainSize", "m", "size of the grain's largest spots", 1.0e-4, kMaxPosition, kLog}, grainSize);
    v.value({.name = "visible", .doc = "whether it is drawn; it stays solid"}, visible);
}

std::string contradiction(const ColliderParams& collider) {
    if (collider.resolution == 1) return ".resolution is 1: give 2 or more, or 0 for a quarter of fluid.spacing";
    const ColliderKind& kind = kindOf(collider);
    if (std::string wrong = kind.contradiction(collider); !wrong.empty()) return wrong;
    for (const auto& [name, value] : {std::pair("friction", collider.friction), std::pair("restitution", collider.restitution)})
        if (value < 0 && value != -1) return fmt::format(".{} is {}: give 0 or more, or -1 for that of fluid.collision", name, value);
    const ColliderMotion& motion = collider.motion;
    const ColliderWave& wave = collider.wave;
    const bool plays = collider.animation.speed > 0;
    if (!kind.hasTriangles()) {
        if (motion.moves() || wave.amplitude > 0)
            return fmt::format(" is a {}, which cannot move: make it a mesh, or remove its motion and wave", kind.name);
        if (plays) return fmt::format(" is a {}, which cannot have an animation: make it a mesh", kind.name);
        if (!collider.solid) return fmt::format(" is a {}, which must be solid: set solid to true", kind.name);
    }
    if (motion.moves() && wave.amplitude > 0) return " has both a motion and a wave: remove one of them";
    if (plays && (motion.moves() || wave.amplitude > 0))
        return fmt::format(" has an animation and a {}: remove one of them", motion.moves() ? "motion" : "wave");
    if (!collider.solid && wave.amplitude > 0) return " has a wave and is not solid: set solid to true or remove the wave";
    if (motion.spin != 0 && glm::length(motion.axis) < kShortest)
        return fmt::format(".motion.axis is ({}, {}, {}): its length must not be 0", motion.axis.x, motion.axis.y, motion.axis.z);
    for (size_t k = 1; k < motion.keys.size(); ++k)
        if (!(motion.keys[k].time > motion.keys[k - 1].time))
            return fmt::format(".motion.keys[{}].time is {} s: it must be later than that of the key before, {} s", k, motion.keys[k].time,
                               motion.keys[k - 1].time);
    if (wave.amplitude > 0 && (glm::length(wave.along) < kShortest || glm::length(wave.direction) < kShortest))
        return ".wave.along and direction must not have length 0";
    return "";
}

}  // namespace rivulet
