// All Params of a struct as a flat list, in the order of its visit.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/core/json.h"

namespace rivulet {

struct ParamEntry {
    enum class Kind { value, group, list };
    Kind kind = Kind::value;
    std::string path;  // "fluid.spacing"; in the item of an empty list "colliders[].mesh", else "colliders[0].mesh"
    std::string unit;
    std::string range;  // "between 0.0005 and 1", "one of a, b"; "": any value
    std::string text;   // the value as JSON; "[]" for an empty list
    std::string doc;
    bool fixed = false;
};

std::vector<ParamEntry> listParams(const VisitFn& visit);
std::map<std::string, std::string> paramTexts(const VisitFn& visit);  // the values as JSON by path, without groups and lists

// Converts a value's JSON to the form that setParam accepts: a string without its quotes.
std::string plainText(const std::string& json);

}  // namespace rivulet
