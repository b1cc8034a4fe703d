// A JSON text as a tree of values that know their place in it, or the Error of what is no JSON.
#pragma once

#include <json/json.h>

#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// ":12:9", the line and column (in bytes) of text[offset], both from 1.
std::string placeOf(std::string_view text, size_t offset);

// Value::getOffsetStart() and getOffsetLimit() index `text`. Its numbers all read 0: their text is for param_value.h.
// Refused, with the place: what is not JSON to the letter, a key that comes twice, nesting above 64, more than 262144 values.
Result<Json::Value> parseJson(std::string_view text, std::string_view file);

}  // namespace rivulet
