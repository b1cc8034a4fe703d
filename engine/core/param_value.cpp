#include "engine/core/param_value.h"

#include <fmt/format.h>

#include <array>

#include "engine/core/number.h"
#include "engine/core/table.h"

namespace rivulet {

namespace {

constexpr double kUnlimited = 1e30;  // ParamInfo's default range

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n";
    const size_t first = text.find_first_not_of(kSpace);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

// "between 1 and 64 m", "at least 0"; ParamInfo's own range if the Param sets none.
std::string wantedRange(const ParamInfo& info) {
    const std::string range = rangeText(info);
    return (range.empty() ? fmt::format("between {} and {}", info.min, info.max) : range) + (*info.unit ? " " : "") + info.unit;
}

std::string notA(std::string_view kind, const ParamInfo& info, std::string_view text) {
    const std::string range = rangeText(info).empty() ? "" : " " + wantedRange(info);
    return fmt::format("is {}, must be {}{}", text.empty() ? "empty" : excerpt(text), kind, range);
}

std::string outOfRange(const ParamInfo& info, std::string_view text, std::string_view suffix = "") {
    return fmt::format("is {}{}{}, must be {}{}", excerpt(text), *info.unit ? " " : "", info.unit, wantedRange(info), suffix);
}

// NaN is in no range. The limits of T apply if the ParamInfo's are wider.
template <class T>
bool inRange(const ParamInfo& info, double v) {
    return v >= info.min && v <= info.max && v >= std::numeric_limits<T>::lowest() && v <= std::numeric_limits<T>::max();
}

bool splitInThree(std::string_view text, std::array<std::string_view, 3>& parts) {
    if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
    for (size_t i = 0; i < 2; ++i) {
        const size_t comma = text.find(',');
        if (comma == std::string_view::npos) return false;
        parts[i] = trimmed(text.substr(0, comma));
        text.remove_prefix(comma + 1);
    }
    parts[2] = trimmed(text);
    return true;
}

// The nearest float; a value too small for a float is parsed as a double first.
float nearestFloat(std::string_view text, double wide) {
    float v = 0;
    return parseNumber(text, v) ? v : static_cast<float>(wide);
}

}  // namespace

std::string assignValue(const ParamInfo& info, std::string_view text, float& v) {
    text = trimmed(text);
    double wide = 0;
    if (!parseNumber(text, wide) || std::isnan(wide)) return notA("a number", info, text);
    if (!inRange<float>(info, wide)) return outOfRange(info, text);
    v = nearestFloat(text, wide);
    return "";
}

std::string assignValue(const ParamInfo& info, std::string_view text, int& v) {
    text = trimmed(text);
    double wide = 0;
    if (!parseNumber(text, wide) || wide != std::floor(wide)) return notA("a whole number", info, text);
    if (!inRange<int>(info, wide)) return outOfRange(info, text);
    v = static_cast<int>(wide);
    return "";
}

std::string assignValue(const ParamInfo& info, std::string_view text, bool& v) {
    text = trimmed(text);
    if (text != "true" && text != "false") return notA("true or false", info, text);
    v = text == "true";
    return "";
}

std::string assignValue(const ParamInfo&, std::string_view text, std::string& v) {
    v = text;
    return "";
}

std::string assignValue(const ParamInfo& info, std::string_view text, vec3& v) {
    text = trimmed(text);
    std::array<std::string_view, 3> parts;
    vec3 read{0.0F};
    if (!splitInThree(text, parts)) return notA("three numbers [x, y, z], each", info, text);
    for (int i = 0; i < 3; ++i) {
        const std::string_view part = parts[static_cast<size_t>(i)];
        double wide = 0;
        if (!parseNumber(part, wide) || std::isnan(wide)) return notA("three numbers [x, y, z], each", info, text);
        if (!inRange<float>(info, wide)) return outOfRange(info, text, " in each component");
        read[i] = nearestFloat(part, wide);
    }
    v = read;
    return "";
}

std::string assignChoice(std::string_view text, std::string& v, std::span<const std::string> names) {
    for (const std::string& name : names)
        if (text == name) {
            v = name;
            return "";
        }
    const std::string near = nearestName(text, names);
    const std::string complaint = fmt::format("is \"{}\", must be one of {}", excerpt(text), joined(names));
    return near.empty() ? complaint : fmt::format("{}; did you mean {}?", complaint, near);
}

std::string valueText(float v) { return std::isfinite(v) ? fmt::format("{}", v) : "null"; }
std::string valueText(int v) { return fmt::format("{}", v); }
std::string valueText(bool v) { return v ? "true" : "false"; }
std::string valueText(const vec3& v) { return fmt::format("[{}, {}, {}]", valueText(v.x), valueText(v.y), valueText(v.z)); }

std::string valueText(const std::string& v) {
    std::string quoted = "\"";
    for (char c : v) {
        if (c == '"' || c == '\\')
            quoted += {'\\', c};
        else if (c == '\n')
            quoted += "\\n";
        else if (static_cast<unsigned char>(c) < 0x20)
            quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            quoted += c;
    }
    return quoted + '"';
}

std::string rangeText(const ParamInfo& info) {
    const bool below = info.min > -kUnlimited;
    const bool above = info.max < kUnlimited;
    if (below && above) return fmt::format("between {} and {}", info.min, info.max);
    if (below) return fmt::format("at least {}", info.min);
    if (above) return fmt::format("at most {}", info.max);
    return "";
}

std::string excerpt(std::string_view text) {
    constexpr size_t kLongest = 60;
    std::string line(text.substr(0, kLongest));
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text.size() > kLongest ? line + "..." : line;
}

std::string joined(std::span<const std::string> names) {
    if (!names.empty() && names.front().empty()) return fmt::format("{} or empty", fmt::join(names.subspan(1), ", "));
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace rivulet
