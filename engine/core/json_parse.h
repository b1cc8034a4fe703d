// Parses JSON into a tree of values that store their position in the text.
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

}  // namespace rivulet
