// Writes a tree of JSON values, such as statistics, as text.
#pragma once

#include <json/json.h>

#include <string>
#include <string_view>

namespace rivulet {

// Returns the text with a line break at its end. `digits`: significant digits of a number; `indent`: the indentation of one level, empty
// for all on one line. Throws std::bad_alloc if memory runs out; Json::writeString returns a part of the text instead.
std::string jsonText(const Json::Value& value, int digits, std::string_view indent = "  ");

}  // namespace rivulet
