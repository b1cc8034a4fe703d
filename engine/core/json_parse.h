// Parses JSON into a tree of values that store their position in the text, and writes such trees.
#pragma once

#include <json/json.h>

#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// ":12:9", the line and column (in bytes) of text[offset], both from 1.
std::string placeOf(std::string_view text, size_t offset);

// Value::getOffsetStart() and getOffsetLimit() index `text`. All numbers of the tree are 0: param_value.h parses them from the text.
// Error (badInput) with line and column: invalid JSON, a duplicate key, nesting above 64 levels, more than 262144 values.
Result<Json::Value> parseJson(std::string_view text, std::string_view file);

// JSON with a line break at its end. `digits`: significant ones of a number; `indent`: of a level, empty for one line. Throws
// std::bad_alloc if memory runs out, where Json::writeString returns a part of the text.
std::string jsonText(const Json::Value& value, int digits, std::string_view indent = "  ");

}  // namespace rivulet
