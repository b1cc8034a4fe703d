#include "engine/ui/param_panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "engine/core/param_list.h"
#include "engine/core/param_path.h"
#include "engine/core/param_value.h"
#include "engine/ui/style.h"

namespace rivulet {

namespace {

constexpr double kSliderSpan = 200;  // a range wider than this has a drag field: a slider would be too coarse
constexpr double kOpenRange = 1e6;   // a larger limit counts as unlimited

bool isOpen(const ParamInfo& info) { return info.min < -kOpenRange || info.max > kOpenRange; }

float srgbFromLinear(float c) { return c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F; }
float linearFromSrgb(float c) { return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }

const ImVec4 kChanged(0.42F, 0.78F, 0.94F, 1);  // colour of changed values

std::string lowered(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::vector<std::string> wordsOf(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream stream(lowered(text));
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

constexpr double kDecades = 8;  // of a slider: more would be too coarse

// Returns a format with enough digits for the steps of the range.
std::string formatFor(const ParamInfo& info, float v) {
    // ImGui takes the smallest value above 0 of a logarithmic slider from the digits.
    if (slidesByDecades(info) && info.min <= 0)
        return fmt::format("%.{}g", std::clamp(static_cast<int>(kDecades - std::log10(info.max)), 4, 7));
    if (slidesByDecades(info) || isOpen(info) || info.max - info.min > kSliderSpan) return "%.4g";
    float size = std::max(std::abs(v), static_cast<float>(info.max - info.min) * 0.1F);
    return size < 0.1F ? "%.5f" : size < 10.0F ? "%.3f" : "%.2f";
}

float roundedTo3Digits(float v) { return std::strtof(fmt::format("{:.3g}", v).c_str(), nullptr); }

}  // namespace

bool slidesByDecades(const ParamInfo& info) {
    if (isOpen(info)) return false;
    constexpr double kWide = 1000;
    if (info.min <= 0) return info.logarithmic;
    const double ratio = info.max / info.min;
    return (info.logarithmic || ratio >= kWide) && std::log10(ratio) <= kDecades;
}

std::string readableName(std::string_view name) {
    std::string text;
    for (char c : name) {
        bool upper = std::isupper(static_cast<unsigned char>(c)) != 0;
        if (upper && !text.empty()) text += ' ';
        text += upper ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
    }
    return text;
}

void ParamMemory::open(const VisitFn& params, const VisitFn& defaults) {
    opened_ = paramTexts(params);
    defaults_ = paramTexts(defaults);
    changed_.clear();
}

void ParamMemory::compare(const VisitFn& params) {
    changed_.clear();
    for (const ParamEntry& entry : listParams(params)) {
        const auto was = opened_.find(entry.path);
        if (entry.kind == ParamEntry::Kind::value && was != opened_.end() && was->second != entry.text) changed_.insert(*was);
    }
}

const std::string* ParamMemory::byDefault(const std::string& path) const {
    std::string any;  // an item's default is the same in every item: "colliders[2].mesh" is "colliders[].mesh"
    for (size_t k = 0; k < path.size(); ++k) {
        any += path[k];
        if (path[k] == '[') k = path.find(']', k) - 1;
    }
    auto found = defaults_.find(path);
    if (found == defaults_.end()) found = defaults_.find(any);
    return found == defaults_.end() ? nullptr : &found->second;
}

void ParamPanel::search(const VisitFn& params) {
    std::string& wanted = memory_.wanted;
    // All of its rows are always there, so that nothing below moves.
    const float clear = ImGui::CalcTextSize("clear").x + 2 * ImGui::GetStyle().FramePadding.x + ImGui::GetStyle().ItemSpacing.x;
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - clear);
    if (memory_.find) ImGui::SetKeyboardFocusHere();
    memory_.find = false;
    ImGui::InputTextWithHint("##wanted", "search: a name, a unit, a word", &wanted);
    ImGui::SameLine();
    ImGui::BeginDisabled(wanted.empty());
    if (ImGui::Button("clear")) wanted.clear();
    ImGui::EndDisabled();
    find(params);
    const bool unchanged = memory_.changed().empty();
    if (!wanted.empty() && found_.empty())
        ImGui::TextColored(refusedColour(), "no matching parameter");
    else if (unchanged)
        ImGui::TextDisabled("nothing changed");
    else
        ImGui::TextColored(kChanged, "%zu changed", memory_.changed().size());
    if (ImGui::IsItemHovered() && !unchanged) ImGui::SetTooltip("changed names have this colour; right-click a name to reset it");
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize("reset all").x - 2 * ImGui::GetStyle().FramePadding.x);
    if (!unchanged && ImGui::SmallButton("reset all")) resetAll(params);
    if (unchanged) ImGui::NewLine();
}

// Which values, groups and lists have the wanted words.
void ParamPanel::find(const VisitFn& params) {
    const std::string& wanted = memory_.wanted;
    if (wanted.empty()) return;
    const std::vector<std::string> words = wordsOf(wanted);
    for (const ParamEntry& entry : listParams(params)) {
        if (entry.path.find("[]") != std::string::npos) continue;  // of an item that does not exist
        const std::string text = lowered(fmt::format("{} {} {} {}", entry.path, readableName(entry.path), entry.unit, entry.doc));
        if (!std::all_of(words.begin(), words.end(), [&](const std::string& word) { return text.find(word) != std::string::npos; }))
            continue;
        // Adds the path and all groups that contain it.
        for (size_t end = entry.path.size(); end != std::string::npos && end > 0; end = entry.path.find_last_of(".[", end - 1))
            found_.insert(entry.path.substr(0, end));
        if (entry.kind != ParamEntry::Kind::value) whole_.push_back(entry.path);
    }
}

// The length of a list is not a value: added items stay.
void ParamPanel::resetAll(const VisitFn& params) {
    for (const auto& [path, text] : memory_.changed()) {
        std::string was = text;
        was = plainText(was);
        if (setParam(fmt::format("{}={}", path, was), params)) changed_ = recreate_ = true;
    }
}

bool ParamPanel::shown(const char* name) const {
    if (memory_.wanted.empty()) return true;
    const std::string path = pathOf(paths_.empty() ? "" : paths_.back(), name);
    return found_.contains(path) || isWhole(path);
}

// True if the path lies in a group or list that was itself found.
bool ParamPanel::isWhole(const std::string& path) const {
    return std::any_of(whole_.begin(), whole_.end(), [&](const std::string& group) {
        return path.starts_with(group) && (path.size() == group.size() || path[group.size()] == '.' || path[group.size()] == '[');
    });
}

void ParamPanel::label(const ParamInfo& info, std::string& text) {
    const std::string path = pathOf(paths_.empty() ? "" : paths_.back(), info.name);
    const auto was = memory_.changed().find(path);
    const bool changed = was != memory_.changed().end();
    ImGui::PushID(info.name);
    float left = ImGui::GetCursorPosX();
    // Widgets stand in one column at any nesting depth; the dimmed unit follows on the right. A longer name has a line of its own.
    float column = std::max(left + 20, ImGui::GetWindowWidth() * 0.42F);
    const std::string name = readableName(info.name);
    const bool above = ImGui::CalcTextSize(name.c_str()).x > column - left - 6;
    if (!above) ImGui::AlignTextToFramePadding();
    if (changed) ImGui::PushStyleColor(ImGuiCol_Text, kChanged);
    ImGui::TextUnformatted(name.c_str());
    if (changed) ImGui::PopStyleColor();
    if (ImGui::BeginPopupContextItem("menu")) {
        const std::string* byDefault = memory_.byDefault(path);
        ImGui::TextDisabled("%s", path.c_str());
        if (ImGui::MenuItem("as opened", changed ? excerpt(was->second).c_str() : "", false, changed)) text = was->second;
        if (byDefault != nullptr && ImGui::MenuItem("default", excerpt(*byDefault).c_str())) text = *byDefault;
        if (ImGui::MenuItem("copy the name")) ImGui::SetClipboardText(path.c_str());
        ImGui::EndPopup();
    } else if (ImGui::IsItemHovered() && info.doc[0] != '\0') {
        std::string about = info.doc;
        if (info.unit[0] != '\0') about += fmt::format("\nunit: {}", info.unit);
        if (!isOpen(info) && info.max < kOpenRange) about += fmt::format("\nrange: {:g} to {:g}", info.min, info.max);
        if (info.fixed) about += "\nchanging this restarts the water";
        if (changed) about += fmt::format("\nopened as {}; right-click to reset", excerpt(was->second));
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
        ImGui::TextUnformatted(about.c_str());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
    if (above)
        ImGui::SetCursorPosX(column);
    else
        ImGui::SameLine(column);
    constexpr float kGap = 8;                                   // px
    float unit = info.unit[0] != '\0' || info.max < kOpenRange  // text fields have none
                     ? std::max(ImGui::CalcTextSize("m^2/s^2").x, ImGui::CalcTextSize(info.unit).x) + kGap
                     : 0;
    ImGui::SetNextItemWidth(std::max(40.0F, ImGui::GetContentRegionAvail().x - unit));
}

// `widget` draws the value and returns true if it was edited; `take` reads a value from JSON.
template <class Widget, class Take>
void ParamPanel::edit(const ParamInfo& info, const Widget& widget, const Take& take) {
    if (hidden() || !shown(info.name)) return;
    std::string text;
    label(info, text);
    bool edited = widget();
    bool ended = info.fixed && ImGui::IsItemDeactivatedAfterEdit();
    if (!text.empty()) {
        take(plainText(text));
        edited = true;
        ended = info.fixed;
    }
    changed_ = changed_ || edited;
    recreate_ = recreate_ || ended;
    if (info.unit[0] != '\0') {
        ImGui::SameLine(0, 6);
        ImGui::TextDisabled("%s", info.unit);
    }
    ImGui::PopID();
}

bool ParamPanel::floats(const ParamInfo& info, float* v, int count) {
    float before[3] = {0, 0, 0};
    std::copy_n(v, count, before);
    float low = static_cast<float>(info.min), high = static_cast<float>(info.max);
    const std::string format = formatFor(info, v[0]);
    const bool decades = slidesByDecades(info);
    const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (decades ? ImGuiSliderFlags_Logarithmic : 0);
    bool edited = false;
    if (decades || (!isOpen(info) && info.max - info.min <= kSliderSpan)) {
        edited = ImGui::SliderScalarN("##v", ImGuiDataType_Float, v, count, &low, &high, format.c_str(), flags);
    } else {
        float largest = 0;
        for (int i = 0; i < count; ++i) largest = std::max(largest, std::abs(v[i]));
        edited = ImGui::DragScalarN("##v", ImGuiDataType_Float, v, count, std::max(0.005F * largest, 0.002F), &low, &high, format.c_str(),
                                    flags);
    }
    if (!edited) return false;
    // A drag ends at figures that are read at a glance; what is typed stays as it is.
    if (decades && ImGui::IsMouseDown(ImGuiMouseButton_Left))
        for (int i = 0; i < count; ++i)
            if (v[i] != before[i]) v[i] = roundedTo3Digits(v[i]);
    // ImGui's clamp lets a typed "nan" pass, and any value if the range is open.
    for (int i = 0; i < count; ++i) v[i] = std::isfinite(v[i]) ? std::clamp(v[i], low, high) : before[i];
    return !std::equal(v, v + count, before);
}

void ParamPanel::value(const ParamInfo& info, float& v) {
    edit(
        info, [&] { return floats(info, &v, 1); }, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::value(const ParamInfo& info, vec3& v) {
    edit(
        info, [&] { return floats(info, &v.x, 3); }, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::value(const ParamInfo& info, int& v) {
    const auto widget = [&] {
        constexpr double kWidest = 1e9;
        int low = static_cast<int>(std::max(info.min, -kWidest)), high = static_cast<int>(std::min(info.max, kWidest));
        if (high - static_cast<double>(low) <= 2000)
            return ImGui::SliderInt("##v", &v, low, high, "%d",
                                    ImGuiSliderFlags_AlwaysClamp | (slidesByDecades(info) ? ImGuiSliderFlags_Logarithmic : 0));
        return ImGui::DragInt("##v", &v, std::max(1.0F, 0.005F * static_cast<float>(std::abs(v))), low, high, "%d",
                              ImGuiSliderFlags_AlwaysClamp);
    };
    edit(info, widget, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::value(const ParamInfo& info, bool& v) {
    edit(
        info, [&] { return ImGui::Checkbox("##v", &v); }, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::value(const ParamInfo& info, std::string& v) {
    edit(
        info, [&] { return ImGui::InputText("##v", &v); }, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::colour(const ParamInfo& info, vec3& v) {
    const auto widget = [&] {
        // Colours are linear in the struct and sRGB on the screen, so that the swatch shows the right colour.
        bool bright = info.max > 1;
        float shown[3];
        for (int i = 0; i < 3; ++i) shown[i] = bright ? v[i] : srgbFromLinear(v[i]);
        ImGuiColorEditFlags flags = ImGuiColorEditFlags_Float | (bright ? ImGuiColorEditFlags_HDR : 0);
        if (!ImGui::ColorEdit3("##v", shown, flags)) return false;
        for (int i = 0; i < 3; ++i) {
            float c = bright ? shown[i] : linearFromSrgb(shown[i]);
            if (std::isfinite(c)) v[i] = std::clamp(c, static_cast<float>(info.min), static_cast<float>(info.max));
        }
        return true;
    };
    edit(info, widget, [&](const std::string& text) { assignValue(info, text, v); });
}

void ParamPanel::choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) {
    const auto widget = [&] {
        bool edited = false;
        const auto shown = [](const std::string& name) { return name.empty() ? "(none)" : name.c_str(); };
        if (!ImGui::BeginCombo("##v", shown(v))) return false;
        for (const std::string& name : names) {
            if (ImGui::Selectable(shown(name), name == v) && name != v) {
                v = name;
                edited = true;
            }
            if (name == v) ImGui::SetItemDefaultFocus();
        }
        ImGui::EndCombo();
        recreate_ = recreate_ || (edited && info.fixed);
        return edited;
    };
    edit(info, widget, [&](const std::string& text) { assignChoice(text, v, names); });
}

// During a search all matching groups are unfolded.
bool ParamPanel::unfolded(const std::string& title) {
    if (!memory_.wanted.empty()) {
        ImGui::TextDisabled("%s", title.substr(0, title.find("###")).c_str());
        if (depth_ > 0) ImGui::TreePush(title.c_str());
        return true;
    }
    return depth_ == 0 ? ImGui::CollapsingHeader(title.c_str()) : ImGui::TreeNodeEx(title.c_str(), ImGuiTreeNodeFlags_SpanAvailWidth);
}

bool ParamPanel::beginGroup(const ParamInfo& info) {
    if (hidden() || !shown(info.name)) return false;
    ImGui::PushID(info.name);
    if (!unfolded(readableName(info.name))) {
        ImGui::PopID();
        return false;
    }
    if (depth_ == 0) ImGui::Indent(6);
    ++depth_;
    paths_.push_back(pathOf(paths_.empty() ? "" : paths_.back(), info.name));
    return true;
}

void ParamPanel::endGroup() {
    paths_.pop_back();
    --depth_;
    if (depth_ == 0)
        ImGui::Unindent(6);
    else
        ImGui::TreePop();
    ImGui::PopID();
}

// A folded list still visits its items, because the length must be kept; the items then draw nothing.
size_t ParamPanel::beginList(const ParamInfo& info, size_t current) {
    size_t wanted = current;
    bool open = false;
    lists_.push_back(pathOf(paths_.empty() ? "" : paths_.back(), info.name));
    if (!hidden() && shown(info.name)) {
        ImGui::PushID(info.name);
        open = unfolded(fmt::format("{} ({})###list", readableName(info.name), current));
        if (open) {
            if (depth_ == 0) ImGui::Indent(6);
            constexpr size_t kMost = 64;
            if (ImGui::SmallButton("add") && current < kMost) wanted = current + 1;
            ImGui::SameLine();
            if (ImGui::SmallButton("remove last") && current > 0) wanted = current - 1;
        } else {
            ImGui::PopID();
        }
    }
    if (wanted != current) changed_ = recreate_ = true;
    open_.push_back(open);
    closed_ += open ? 0 : 1;
    depth_ += open ? 1 : 0;
    return wanted;
}

void ParamPanel::beginItem(size_t index) {
    bool open = false;
    paths_.push_back(pathOf(lists_.back(), index));
    if (!hidden() && (memory_.wanted.empty() || found_.contains(paths_.back()) || isWhole(paths_.back()))) {
        ImGui::PushID(static_cast<int>(index));
        open = ImGui::TreeNodeEx("item", ImGuiTreeNodeFlags_SpanAvailWidth | ImGuiTreeNodeFlags_DefaultOpen, "%d", static_cast<int>(index));
        if (!open) ImGui::PopID();
    }
    open_.push_back(open);
    closed_ += open ? 0 : 1;
    depth_ += open ? 1 : 0;
}

void ParamPanel::endItem() {
    paths_.pop_back();
    bool open = open_.back();
    open_.pop_back();
    if (!open) {
        --closed_;
        return;
    }
    --depth_;
    ImGui::TreePop();
    ImGui::PopID();
}

void ParamPanel::endList() {
    lists_.pop_back();
    bool open = open_.back();
    open_.pop_back();
    if (!open) {
        --closed_;
        return;
    }
    --depth_;
    if (depth_ == 0)
        ImGui::Unindent(6);
    else
        ImGui::TreePop();
    ImGui::PopID();
}

}  // namespace rivulet
