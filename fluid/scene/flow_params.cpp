#include "fluid/scene/flow_params.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/scene/transform.h"

namespace rivulet {

namespace {
constexpr double kFar = 1.0e4;       // m
constexpr double kPulseStray = 0.3;  // periods that a pulse may begin late
// 0 to 1, by a number alone: rows of one period, such as both eyes', keep time (Wang 1997's mix).
double chosenOf(double number) {
    auto h = static_cast<uint32_t>(static_cast<int64_t>(number));
    h = (h ^ 61U ^ (h >> 16U)) * 9U;
    h = (h ^ (h >> 4U)) * 0x27d4eb2dU;
    return static_cast<double>(h ^ (h >> 15U)) / 4294967295.0;
}
}  // namespace

double ExpressionParams::at(double time) const {
    const double periods = time / double{period} + double{phase};
    double wave = std::sin(2 * std::numbers::pi * periods);
    if (pulse > 0) {
        const double number = std::floor(periods), wide = std::min(double{pulse} / double{period}, 1 - kPulseStray);
        const double at = (periods - number - kPulseStray * chosenOf(number)) / wide;
        wave = glm::smoothstep(0.0, 0.3 * (1 - double{hold}), at) * (1 - glm::smoothstep(1 - 0.7 * (1 - double{hold}), 1.0, at));
    }
    return std::clamp(double{weight} + double{swing} * wave, 0.0, 1.0);
}

dmat4 FlowMotionParams::at(double time) const {
    const vec3 degrees = turn + swing * static_cast<float>(std::sin(2 * std::numbers::pi * time / double{period}));
    const dmat4 turned(Transform{vec3(0.0F), degrees, 1.0F}.matrix());
    return glm::translate(dmat4(1.0), dvec3(pivot)) * turned * glm::translate(dmat4(1.0), -dvec3(pivot));
}

void FlowSourceParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> kinds = {"corner", "brim", "spot", "strewn", "rain"}, sides = {"left", "right", "both"};
    v.choice({.name = "kind",
              .doc = "corner: below an eye's inner corner; brim: into the lower lid, which fills and overflows; spot: around a point; "
                     "strewn: jittered over the whole skin; rain: from the air"},
             kind, kinds);
    v.choice({.name = "side", .doc = "eye of a corner or brim; left as the face sees it"}, side, sides);
    v.value(
        {"rate", "ul/min", "volume of all drops per minute, the first drop at once; 0 = off; corner and brim: 100,000 at most", 0, 1.0e7},
        rate);
    v.value({"drop", "ul", "volume of each drop", 1.0e-4, 100, kLog}, drop);
    v.value({"start", "s", "time at which the source starts", 0, 3600}, start);
    v.value({"stop", "s", "time at which the source stops", 0, 3600}, stop);
    v.value({"swell", "", "modulation of the rate: 0 = steady, 1 = between 0 and the full rate", 0, 1}, swell);
    v.value({"period", "s", "period of the modulation", 0.05, 3600, kLog}, period);
    v.value(
        {"position", "m",
         "position of a spot, or centre of strewn drops or rain, in the skin's frame; of a corner or brim, where the nearer eye's tears "
         "start: 0 = at the eye",
         -kFar, kFar},
        position);
    v.value({"radius", "m", "radius around the position; 0 = a point, or everywhere for strewn and rain", 0, kFar}, radius);
    v.value({"speed", "m/s", "speed of rain", 0, 100}, speed);
    v.value({"along", "", "direction of rain, in the world, of any length", -1.0e6, 1.0e6}, along);
    v.value({.name = "film", .doc = "whether the source makes a film that spreads, instead of single drops"}, film);
}

void ExpressionParams::visit(ParamVisitor& v) {
    v.value({.name = "morph", .doc = "name of a morph target of the mesh", .fixed = kFixed}, morph);
    v.value({"weight", "", "mean weight", 0, 1}, weight);
    v.value({"swing", "", "amplitude of an oscillation of the weight, or height of a pulse", 0, 1}, swing);
    v.value({"period", "s", "period of the oscillation or the pulses", 0.05, 3600, kLog}, period);
    v.value({"phase", "", "phase of the oscillation, in periods", 0, 1}, phase);
    v.value({"pulse", "s", "width of a pulse in each period, such as a blink, up to 0.7 of it; 0 = a sine wave", 0, 3600}, pulse);
    v.value({"hold", "", "share of a pulse's width at its full height: 0 = a peak, 0.95 = a quick look aside and back", 0, 0.99}, hold);
}

void FlowMotionParams::visit(ParamVisitor& v) {
    v.value({"pivot", "m", "centre of rotation, in the skin's frame", -kFar, kFar}, pivot);
    v.value({"turn", "deg", "rotation about x, then y, then z", -360, 360}, turn);
    v.value({"swing", "deg", "amplitude of an oscillation about x, y and z", -180, 180}, swing);
    v.value({"period", "s", "period of the oscillation", 0.05, 3600, kLog}, period);
}

void RegionParams::visit(ParamVisitor& v) {
    v.value({.name = "mask",
             .doc = "picture of any size over the mesh's UVs: red oily, green dry, blue hair, alpha lip; none = the same everywhere",
             .fixed = kFixed},
            mask);
    v.value({"oily", "", "factor on the force that holds a drop, where the mask is red", 0, 10, kLinear, kFixed}, oily);
    v.value({"dry", "", "factor on the force that holds a drop, where the mask is green", 0, 10, kLinear, kFixed}, dry);
    v.value({"hair", "", "factor on the force that holds a drop in brows and lashes, where the mask is blue", 0, 10, kLinear, kFixed},
            hair);
    v.value({"lip", "", "factor on the force that holds a drop, by the alpha of the mask", 0, 10, kLinear, kFixed}, lip);
}

void FlowParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> modes = {"drops", "thesis"};
    v.choice({.name = "mode",
              .doc = "drops: drops move on the mesh, independent of its UVs; thesis: particles in UV space (thesis, chapter 4)",
              .fixed = kFixed},
             mode, modes);
    v.value({.name = "mesh",
             .doc = "model file, searched in this order: the path itself, the scene's folder, RIVULET_ASSETS, assets/",
             .fixed = kFixed},
            mesh);
    v.value({.name = "part", .doc = "wet part of a file with several parts; the other parts are only drawn", .fixed = kFixed}, part);
    v.value({.name = "instead",
             .doc = "JSON file of another skin, with the keys that differ from this one; used if its mesh is found",
             .fixed = kFixed},
            instead);
    v.value({.name = "hide",
             .doc = "parts that are not drawn, by name or material, separated by ', '; * at the end matches any ending",
             .fixed = kFixed},
            hide);
    v.value(
        {.name = "skinParts", .doc = "parts with the skin material, in the same form; the default head has its own list", .fixed = kFixed},
        skinParts);
    v.value({.name = "marks",
             .doc = "JSON file of a face's eyes and lids; none = the file beside the mesh, if there is one; what it lacks is found",
             .fixed = kFixed},
            marks);
    v.value({"position", "m", "position of the mesh's origin (with fitSize: of its centre)", -kFar, kFar, kLinear, kFixed}, position);
    v.value({"rotation", "deg", "rotation about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"scale", "", "scale factor of the mesh: the unit of its file in m", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that the mesh's longest side is scaled to; 0 = use scale", 0, kFar, kLog, kFixed}, fitSize);
    v.value({"mapSize", "", "texels along a side of the map that the liquid is drawn into: a power of two", 16, 8192, kLog, kFixed},
            mapSize);
    v.value({"wind", "m/s", "velocity of the air, in the world", -1.0e6, 1.0e6}, wind);
    v.group({.name = "liquid", .doc = "properties of the liquid and its adhesion"}, liquid);
    v.group({.name = "thesis", .doc = "the forces of mode thesis"}, thesis);
    v.group({.name = "motion", .doc = "rigid motion of the skin"}, motion);
    v.value({"amount", "", "factor on the rates of all sources", 0, 10}, amount);
    v.value({"pace", "", "speed of the expression; 1: as its periods say, 0: it stands still", 0, 5}, pace);
    v.value({"expressive", "", "factor on all of expression; 0 = none", 0, 1}, expressive);
    v.value({.name = "marble", .doc = "shows the mesh as a statue: all its parts are of one marble, and it has no hair"}, marble);
    v.value({"redness", "",
             "how red the eyes, their lids and the nose become; half of it is there at once, the rest comes with the first 20 to 60 ul of "
             "all sources",
             0, 1},
            redness);
    v.list({.name = "expression", .doc = "weights of the mesh's morph targets"}, expression);
    v.list({.name = "sources", .doc = "sources of drops"}, sources);
    v.group({.name = "regions", .doc = "parts of the skin that hold drops more or less strongly"}, regions);
    v.group({.name = "look", .doc = "look of the liquid"}, look);
    v.group({.name = "material", .doc = "material of a mesh if its file has none"}, material);
}

void PresetParams::visit(ParamVisitor& v) {
    v.value({.name = "name", .doc = "label of its button, and value of --preset"}, name);
    v.value({.name = "doc", .doc = "one sentence about the preset"}, doc);
    v.value({.name = "set", .doc = "values in the form of --set, separated by '; '"}, set);
}

}  // namespace rivulet
