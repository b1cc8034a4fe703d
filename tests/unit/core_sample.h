// Params of every kind, for the tests of JSON and --set.
#pragma once

#include <string>
#include <vector>

#include "engine/core/json.h"

namespace rivulet {

struct SamplePart {
    int count = 1;
    void visit(ParamVisitor& v) { v.value({"count", "", "how many", 0, 9}, count); }
    bool operator==(const SamplePart&) const = default;
};

struct SampleItem {
    float size = 0.5F;
    std::string mesh;
    vec3 tint{1.0F, 0.5F, 0.25F};
    std::vector<SamplePart> parts;
    void visit(ParamVisitor& v) {
        v.value({"size", "m", "edge", 0.001, 10}, size);
        v.value({.name = "mesh", .doc = "file"}, mesh);
        v.colour({"tint", "", "linear", 0, 1}, tint);
        v.list({.name = "parts", .doc = "lists nest"}, parts);
    }
    bool operator==(const SampleItem&) const = default;
};

struct SampleFluid {
    float spacing = 0.02F;
    int substeps = 4;
    bool walls = true;
    std::string method = "wcsph";
    vec3 gravity{0.0F, -9.81F, 0.0F};
    void visit(ParamVisitor& v) {
        static const std::vector<std::string> methods = {"wcsph", "wcsph_thesis"};
        v.value({"spacing", "m", "distance of particles", 0.0005, 1}, spacing);
        v.value({"substeps", "", "a frame", 1, 64}, substeps);
        v.value({.name = "walls", .doc = "a | b"}, walls);
        v.choice({.name = "method", .doc = "pressure", .fixed = true}, method, methods);
        v.value({"gravity", "m/s^2", "downwards", -1000, 1000}, gravity);
    }
    bool operator==(const SampleFluid&) const = default;
};

struct Sample {
    std::string name = "unnamed";
    float free = 0.0F;
    SampleFluid fluid;
    std::vector<SampleItem> colliders;
    void visit(ParamVisitor& v) {
        v.value({.name = "name", .doc = "title"}, name);
        v.value({.name = "free", .doc = "any number"}, free);
        v.group({.name = "fluid", .doc = "what flows"}, fluid);
        v.list({.name = "colliders", .doc = "solids"}, colliders);
    }
    bool operator==(const Sample&) const = default;
};

inline VisitFn visiting(Sample& sample) {
    return [&sample](ParamVisitor& v) { sample.visit(v); };
}

}  // namespace rivulet
