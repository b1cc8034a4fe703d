#include "fluid/viewer/scene_sliders.h"

#include <imgui.h>

#include <algorithm>
#include <string>
#include <vector>

#include "engine/core/param_path.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

// Visits all parameters. Draws a widget for a parameter if its path is in the list.
class Sliders final : public ParamVisitor {
  public:
    explicit Sliders(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {}
    bool changed() const { return changed_; }

    void value(const ParamInfo& info, float& v) override {
        draw(info, v, [&](const char* label) {
            const ImGuiSliderFlags flags = ImGuiSliderFlags_AlwaysClamp | (info.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
            return ImGui::SliderFloat(label, &v, static_cast<float>(info.min), static_cast<float>(info.max), "%.3g", flags);
        });
    }
    void value(const ParamInfo& info, int& v) override {
        draw(info, v, [&](const char* label) {
            return ImGui::SliderInt(label, &v, static_cast<int>(info.min), static_cast<int>(info.max), "%d", ImGuiSliderFlags_AlwaysClamp);
        });
    }
    void value(const ParamInfo& info, bool& v) override {
        draw(info, v, [&](const char* label) { return ImGui::Checkbox(label, &v); });
    }
    void value(const ParamInfo& info, std::string& v) override {
        draw(info, v, [&](const char*) { return false; });
    }
    // A vector of any length, such as a wind, by dragging: its range is too wide for a slider.
    void value(const ParamInfo& info, vec3& v) override {
        draw(info, v, [&](const char* label) {
            return ImGui::DragFloat3(label, &v.x, kDrag, static_cast<float>(info.min), static_cast<float>(info.max), "%.2f",
                                     ImGuiSliderFlags_AlwaysClamp);
        });
    }
    void colour(const ParamInfo& info, vec3& v) override {
        draw(info, v, [&](const char* label) { return ImGui::ColorEdit3(label, &v.x, ImGuiColorEditFlags_Float); });
    }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        draw(info, v, [&](const char* label) {
            bool chosen = false;
            if (!ImGui::BeginCombo(label, v.c_str())) return false;
            for (const std::string& name : names)
                if (ImGui::Selectable(name.c_str(), name == v)) {
                    v = name;
                    chosen = true;
                }
            ImGui::EndCombo();
            return chosen;
        });
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        paths_.push_back(pathOf(group(), info.name));
        return true;
    }
    void endGroup() override { paths_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        paths_.push_back(pathOf(group(), info.name));
        return current;
    }
    void beginItem(size_t index) override { paths_.push_back(pathOf(group(), index)); }
    void endItem() override { paths_.pop_back(); }
    void endList() override { paths_.pop_back(); }

  private:
    static constexpr float kDrag = 0.02F;  // of a value, a pixel
    std::string_view group() const { return paths_.empty() ? std::string_view() : std::string_view(paths_.back()); }
    template <class T, class Widget>
    void draw(const ParamInfo& info, const T& v, const Widget& widget) {
        const std::string path = pathOf(group(), info.name);
        if (std::find(wanted_.begin(), wanted_.end(), path) == wanted_.end()) return;
        const std::string label = std::string(info.name) + (*info.unit == 0 ? "" : std::string(" (") + info.unit + ")") + "###" + path;
        ImGui::SetNextItemWidth(0.55F * ImGui::GetContentRegionAvail().x);
        if (info.fixed)
            ImGui::TextUnformatted((std::string(info.name) + " " + valueText(v)).c_str());
        else
            changed_ = widget(label.c_str()) || changed_;
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", info.doc);
    }

    std::vector<std::string> wanted_, paths_;
    bool changed_ = false;
};

}  // namespace

bool drawSceneSliders(SceneFile& scene) {
    if (scene.sliders.empty()) return false;
    Sliders sliders(slidersOf(scene.sliders));
    scene.visit(sliders);
    return sliders.changed();
}

}  // namespace rivulet
