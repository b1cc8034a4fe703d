#include "fluid/scene/flow_params.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/scene/transform.h"

namespace rivulet {

namespace {
constexpr bool kLog = true, kLinear = false, kFixed = true;
constexpr double kFar = 1.0e4;  // m
}  // namespace

double ExpressionParams::at(double time) const {
    const double w = double{weight} + double{swing} * std::sin(2 * std::numbers::pi * (time / double{period} + double{phase}));
    return std::clamp(w, 0.0, 1.0);
}

dmat4 FlowMotionParams::at(double time) const {
    const vec3 degrees = turn + swing * static_cast<float>(std::sin(2 * std::numbers::pi * time / double{period}));
    const dmat4 turned(Transform{vec3(0.0F), degrees, 1.0F}.matrix());
    return glm::translate(dmat4(1.0), dvec3(pivot)) * turned * glm::translate(dmat4(1.0), -dvec3(pivot));
}

void FlowSourceParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> kinds = {"corner", "brim", "spot", "strewn", "rain"}, sides = {"left", "right", "both"};
    v.choice(
        {.name = "kind",
         .doc = "corner: below an eye's inner corner; brim: into the lower lid, which fills and spills; spot: about a point; strewn: all "
                "over; rain: from the air"},
        kind, kinds);
    v.choice({.name = "side", .doc = "whose eye, of corner and brim; left is the face's own"}, side, sides);
    v.value({"rate", "ul/min", "volume, of all together, the first drop at once; 0 = off; of corner and brim 100,000 at most", 0, 1.0e7},
            rate);
    v.value({"drop", "ul", "volume of each drop", 1.0e-4, 100, kLog}, drop);
    v.value({"start", "s", "when it begins", 0, 3600}, start);
    v.value({"stop", "s", "when it ends", 0, 3600}, stop);
    v.value({"swell", "", "0 steady, 1 comes and goes", 0, 1}, swell);
    v.value({"period", "s", "of the swell", 0.05, 3600, kLog}, period);
    v.value({"position", "m", "of a spot, or the middle of where it is strewn or rains; in the skin's own frame", -kFar, kFar}, position);
    v.value({"radius", "m", "about the position; 0 = a point, or of strewn and rain everywhere", 0, kFar}, radius);
    v.value({"speed", "m/s", "of rain", 0, 100}, speed);
    v.value({"along", "", "the way rain falls, in the world, of any length", -1.0e6, 1.0e6}, along);
    v.value({.name = "film", .doc = "part of a sheet, which spreads, instead of single drops"}, film);
}

void ExpressionParams::visit(ParamVisitor& v) {
    v.value({.name = "morph", .doc = "a morph target of the mesh", .fixed = kFixed}, morph);
    v.value({"weight", "", "how much of it", 0, 1}, weight);
    v.value({"swing", "", "how far it comes and goes", 0, 1}, swing);
    v.value({"period", "s", "how long it takes to", 0.05, 3600, kLog}, period);
    v.value({"phase", "", "in periods", 0, 1}, phase);
}

void FlowMotionParams::visit(ParamVisitor& v) {
    v.value({"pivot", "m", "what it turns about, in the skin's frame", -kFar, kFar}, pivot);
    v.value({"turn", "deg", "about x, then y, then z", -360, 360}, turn);
    v.value({"swing", "deg", "how far it turns to and fro", -180, 180}, swing);
    v.value({"period", "s", "how long that takes", 0.05, 3600, kLog}, period);
}

void RegionParams::visit(ParamVisitor& v) {
    v.value({.name = "mask",
             .doc = "picture of any size over the mesh's UVs: red oily, green dry, blue hair, alpha lip; none = the same everywhere",
             .fixed = kFixed},
            mask);
    v.value({"oily", "", "of what holds a drop, where the mask says so", 0, 10, kLinear, kFixed}, oily);
    v.value({"dry", "", "the same of dry skin", 0, 10, kLinear, kFixed}, dry);
    v.value({"hair", "", "the same of brows and the roots of lashes", 0, 10, kLinear, kFixed}, hair);
    v.value({"lip", "", "the same of lips", 0, 10, kLinear, kFixed}, lip);
}

void FlowParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> modes = {"drops", "thesis"};
    v.choice({.name = "mode",
              .doc = "drops: they walk the mesh, the same way whatever its UVs; thesis: particles in UV, as the thesis has them",
              .fixed = kFixed},
             mode, modes);
    v.value({.name = "mesh", .doc = "model file: as given, beside the scene, in RIVULET_ASSETS, in assets/", .fixed = kFixed}, mesh);
    v.value({.name = "part", .doc = "of a file with several parts the one that is wet; the others are drawn with it", .fixed = kFixed},
            part);
    v.value({.name = "instead",
             .doc = "JSON file of another skin, with the keys of this one that differ: taken where the mesh that it names is found",
             .fixed = kFixed},
            instead);
    v.value({.name = "hide",
             .doc = "parts that are not drawn, by name or material, ', ' between them; * at the end = and the like",
             .fixed = kFixed},
            hide);
    v.value({.name = "skinParts", .doc = "parts that are made of skin, the same way; the default head knows its own", .fixed = kFixed},
            skinParts);
    v.value(
        {.name = "marks", .doc = "JSON file of a face's eyes and lids; none = the file beside the mesh, if there is one", .fixed = kFixed},
        marks);
    v.value({"position", "m", "where the mesh's origin goes (with fitSize: its middle)", -kFar, kFar, kLinear, kFixed}, position);
    v.value({"rotation", "deg", "about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"scale", "", "of the mesh: its file's unit in m", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that its longest side is scaled to, instead of scale; 0 = scale holds", 0, kFar, kLog, kFixed},
            fitSize);
    v.value({"mapSize", "", "texels of the map that it is drawn into: a power of two", 16, 8192, kLog, kFixed}, mapSize);
    v.value({"wind", "m/s", "of the air, in the world", -1.0e6, 1.0e6}, wind);
    v.group({.name = "liquid", .doc = "what flows, and how it clings"}, liquid);
    v.group({.name = "thesis", .doc = "the forces of mode thesis"}, thesis);
    v.group({.name = "motion", .doc = "how the skin turns as a whole"}, motion);
    v.value({"expressive", "", "how much of expression: 0 = a statue", 0, 1}, expressive);
    v.list({.name = "expression", .doc = "how it bends: morph targets of the mesh"}, expression);
    v.list({.name = "sources", .doc = "where drops come from"}, sources);
    v.group({.name = "regions", .doc = "where the skin holds more, where less"}, regions);
    v.group({.name = "look", .doc = "how what flows looks"}, look);
    v.group({.name = "material", .doc = "of a mesh whose file has none"}, material);
}

void PresetParams::visit(ParamVisitor& v) {
    v.value({.name = "name", .doc = "what its button says"}, name);
    v.value({.name = "doc", .doc = "one sentence"}, doc);
    v.value({.name = "set", .doc = "values, as --set has them, '; ' between them"}, set);
}

}  // namespace rivulet
