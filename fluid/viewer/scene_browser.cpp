#include "fluid/viewer/scene_browser.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "engine/core/message_line.h"
#include "engine/scene/import_model.h"
#include "engine/ui/style.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr float kCard = 236, kShape = 9.0F / 16;  // pixels across; height over width of a picture

bool holds(const std::string& text, const std::string& part) {
    const auto alike = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    return std::search(text.begin(), text.end(), part.begin(), part.end(), alike) != text.end();
}

}  // namespace

void SceneBrowser::show(bool yes) {
    shown_ = yes;
    trouble_.clear();
    if (!yes) return;
    scenes_ = listScenes();
    sketches_.clear();  // the files may have changed
    std::erase_if(pictures_, [](const auto& known) { return !known.second; });
    std::stable_partition(scenes_.begin(), scenes_.end(), [](const SceneListing& scene) { return scene.missing.empty(); });
    for (SceneListing& scene : scenes_) {
        scene.name = messageLine(scene.name);
        scene.doc = messageLine(scene.doc);
    }
}

void SceneBrowser::refuse(const std::string& why) { trouble_ = messageLine(why); }

const gpu::Texture* SceneBrowser::pictureOf(const std::string& scene) {
    const auto known = pictures_.find(scene);
    if (known != pictures_.end()) return known->second ? &known->second : nullptr;
    if (readOne_) return nullptr;
    readOne_ = true;
    gpu::Texture& kept = pictures_[scene];
    const fs::path file = fs::path(scene).parent_path().parent_path() / "pictures" / (fs::path(scene).stem().string() + ".jpg");
    std::error_code error;
    if (!fs::exists(file, error)) {
        sketches_.try_emplace(scene, scene, kShape);
        return nullptr;
    }
    const Result<std::shared_ptr<const Image>> read = importImage(file.string());
    if (!read) return nullptr;
    const Image* image = read->get();
    Result<gpu::Texture> texture = gpu::Texture::create({.width = image->width, .height = image->height, .format = gpu::Format::rgba8});
    if (!texture) return nullptr;
    texture->upload(std::as_bytes(std::span(image->rgba)));
    kept = std::move(*texture);
    return &kept;
}

bool SceneBrowser::card(size_t index, float width) {
    const SceneListing& scene = scenes_[index];
    const float tall = width * kShape, text = 3.2F * ImGui::GetTextLineHeight();
    ImGui::PushID(scene.path.c_str());
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool chosen = ImGui::InvisibleButton("card", ImVec2(width, tall + text + 8));
    const bool hovered = ImGui::IsItemHovered();
    if (hovered) {
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(30 * ImGui::GetFontSize());
        ImGui::TextUnformatted(scene.doc.c_str());
        if (!scene.missing.empty()) ImGui::TextColored(refusedColour(), "not found: %s", scene.missing.c_str());
        ImGui::TextDisabled("%s", scene.path.c_str());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImVec2 under(at.x + width, at.y + tall);
    list.AddRectFilled(at, ImVec2(at.x + width, at.y + tall + text + 8),
                       ImGui::GetColorU32(hovered ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), 4);
    if (const gpu::Texture* picture = pictureOf(scene.path))
        list.AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(picture->name())), at, under, ImVec2(0, 1), ImVec2(1, 0),
                             IM_COL32_WHITE, 4, ImDrawFlags_RoundCornersTop);
    else if (const auto sketch = sketches_.find(scene.path); sketch != sketches_.end())
        sketch->second.draw(list, vec2(at.x, at.y), width);
    if (!scene.missing.empty()) {
        const char* why = "needs a file that is not installed";
        const ImVec2 room = ImGui::CalcTextSize(why), low(at.x + 7, under.y - room.y - 7);
        list.AddRectFilled(ImVec2(low.x - 3, low.y - 2), ImVec2(low.x + room.x + 3, low.y + room.y + 2), IM_COL32(10, 14, 18, 220), 3);
        list.AddText(low, ImGui::GetColorU32(refusedColour()), why);
    }
    const ImVec2 name(at.x + 7, at.y + tall + 4);
    list.AddText(name, ImGui::GetColorU32(ImGuiCol_Text), scene.name.c_str());
    const float small = 0.88F * ImGui::GetFontSize(), doc = name.y + ImGui::GetTextLineHeight() + 1;
    const ImVec4 clip(at.x, at.y, at.x + width, doc + 2 * small);  // two lines of it
    list.AddText(nullptr, small, ImVec2(name.x, doc), ImGui::GetColorU32(ImGuiCol_TextDisabled), scene.doc.c_str(), nullptr, width - 14,
                 &clip);
    ImGui::PopID();
    return chosen;
}

std::optional<std::string> SceneBrowser::draw() {
    std::optional<std::string> chosen;
    if (!shown_) return chosen;
    readOne_ = false;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(display.x / 2, display.y / 2), ImGuiCond_Appearing, ImVec2(0.5F, 0.5F));
    ImGui::SetNextWindowBgAlpha(0.98F);
    ImGui::SetNextWindowSize(ImVec2(std::min(display.x - 20, 3 * kCard + 66), std::min(display.y - 20, 620.0F)), ImGuiCond_Appearing);
    if (ImGui::Begin("scenes", &shown_, ImGuiWindowFlags_NoCollapse)) {
        ImGui::SetNextItemWidth(-1);
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        ImGui::InputTextWithHint("##wanted", "search names and descriptions", &wanted_);
        const float wrapped = ImGui::GetContentRegionAvail().x, gapBelow = ImGui::GetStyle().ItemSpacing.y;
        const float said = trouble_.empty() ? 0 : ImGui::CalcTextSize(trouble_.c_str(), nullptr, false, wrapped).y + gapBelow;
        const float below = ImGui::GetFrameHeightWithSpacing() + said;
        ImGui::BeginChild("cards", ImVec2(0, -below));
        const float room = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
        const int across = std::max(1, static_cast<int>((room + gap) / (kCard + gap)));
        const float width = (room - static_cast<float>(across - 1) * gap) / static_cast<float>(across);
        int column = 0;
        for (size_t k = 0; k < scenes_.size(); ++k) {
            if (!holds(scenes_[k].name + " " + scenes_[k].doc, wanted_)) continue;
            if (column > 0) ImGui::SameLine();
            if (card(k, width)) chosen = scenes_[k].path;
            column = (column + 1) % across;
        }
        ImGui::EndChild();
        if (!trouble_.empty()) {
            ImGui::PushTextWrapPos(0);
            ImGui::TextColored(refusedColour(), "%s", trouble_.c_str());
            ImGui::PopTextWrapPos();
        }
        const float open = ImGui::CalcTextSize("open").x + 2 * ImGui::GetStyle().FramePadding.x;
        ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - open - ImGui::GetStyle().ItemSpacing.x);
        if (refocus_) ImGui::SetKeyboardFocusHere();
        refocus_ = false;
        const bool entered =
            ImGui::InputTextWithHint("##path", "or the path of a scene file", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
        if (entered) refocus_ = true;  // should it be refused
        ImGui::SameLine();
        if ((ImGui::Button("open") || entered) && !path_.empty()) chosen = path_;
    }
    ImGui::End();
    return chosen;
}

}  // namespace rivulet
