// Every Param behind a visit as a flat list, in the visit's order.
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
    std::string range;  // "between 0.0005 and 1", "one of a, b", "" = any
    std::string text;   // the value in JSON; of a list "[]" when it is empty
    std::string doc;
    bool fixed = false;
};

std::vector<ParamEntry> listParams(const VisitFn& visit);
std::map<std::string, std::string> paramTexts(const VisitFn& visit);  // of the values alone, by path

// A value's JSON, as setParam takes it: a string without its quotes.
std::string plainText(const std::string& json);

}  // namespace rivulet
