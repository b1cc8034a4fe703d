// One value of a Param: read from text, checked against its ParamInfo, written as text. JSON, --set and the reference share this.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/core/params.h"

namespace rivulet {

// Reads `text` into v. Returns "" on success. Else v is unchanged and the error is returned: `is -1 m, must be between 0.0005 and 1 m`.
std::string assignValue(const ParamInfo& info, std::string_view text, float& v);
std::string assignValue(const ParamInfo& info, std::string_view text, int& v);   // refuses fractions
std::string assignValue(const ParamInfo& info, std::string_view text, bool& v);  // true, false
std::string assignValue(const ParamInfo& info, std::string_view text, std::string& v);
std::string assignValue(const ParamInfo& info, std::string_view text, vec3& v);  // 1,2,3 or [1, 2, 3]
std::string assignChoice(std::string_view text, std::string& v, std::span<const std::string> names);

// JSON in the shortest form that reads back as the same value, in any locale. NaN and infinity are written as null.
std::string valueText(float v);
std::string valueText(int v);
std::string valueText(bool v);
std::string valueText(const std::string& v);
std::string valueText(const vec3& v);

std::string rangeText(const ParamInfo& info);            // "between 0.0005 and 1", "at least 0", "" = any
std::string excerpt(std::string_view text);              // for an error message: one line, at most 60 characters
std::string joined(std::span<const std::string> names);  // "a, b, c"; "a, b or empty" if the first name is ""

}  // namespace rivulet
