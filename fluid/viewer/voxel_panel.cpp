#include "fluid/viewer/voxel_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "fluid/voxel/voxel_picture.h"

namespace rivulet {

namespace {

void gridFact(const char* name, const std::string& text) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetFontSize() * 6.5F);
    ImGui::TextUnformatted(text.c_str());
}

// 1,234,567 reads better than 1234567 in a column.
std::string grouped(size_t number) {
    std::string text = std::to_string(number);
    for (auto at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<size_t>(at), 1, ',');
    return text;
}

std::string readableVolume(double m3) {
    return m3 < 1e-3 ? fmt::format("{:.3g} ml", 1e6 * m3) : m3 < 1 ? fmt::format("{:.3g} l", 1e3 * m3) : fmt::format("{:.3g} m3", m3);
}

void textRight(const std::string& text) {
    const float left = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(text.c_str()).x;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + std::max(0.0F, left));
    ImGui::TextUnformatted(text.c_str());
}

// One row of the list: a swatch, a name, figures at the right.
void materialRow(const VoxelLabels& labels, uint32_t label, const std::string& name, const std::string& voxels, const std::string& volume) {
    const uint32_t colour = srgbBytes(labelColour(labels, label));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const ImVec2 low = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetTextLineHeight();
    ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(low.x, low.y + 1), ImVec2(low.x + side, low.y + side - 1), colour, 3);
    ImGui::GetWindowDrawList()->AddRect(ImVec2(low.x, low.y + 1), ImVec2(low.x + side, low.y + side - 1),
                                        ImGui::GetColorU32(ImGuiCol_Separator), 3);
    ImGui::Dummy(ImVec2(side, side));
    ImGui::SameLine();
    ImGui::TextUnformatted(name.c_str());
    ImGui::TableNextColumn();
    textRight(voxels);
    ImGui::TableNextColumn();
    textRight(volume);
}

}  // namespace

void VoxelPanel::clear() {
    labels_.reset();
    slice_ = gpu::Texture();
    stale_ = true;
    complaint_.clear();
    chosen_ = 0;
    field_ = nullptr;
    std::fill(std::begin(at_), std::end(at_), -1);
}

void VoxelPanel::draw(const SolidFields& fields, double time, float width) {
    const VoxelField* field = choose(fields, width);
    if (field == nullptr) {
        ImGui::TextDisabled("the scene has no mesh");
        return;
    }
    if (field != field_) {
        clearShown(field);
    } else if (std::find(fields.deforming.begin(), fields.deforming.end(), field) != fields.deforming.end() && time != labelledAt_ &&
               ImGui::GetTime() >= nextLook_) {
        labels_.reset();
    }
    if (!labels_) label(time);
    const ivec3& size = field->surface.size;
    for (int k = 0; k < 3; ++k) at_[k] = at_[k] < 0 ? size[k] / 2 : std::min(at_[k], size[k] - 1);
    gridFact("grid", fmt::format("{} x {} x {}", size.x, size.y, size.z));
    gridFact("edge", fmt::format("{:.3g} mm", 1e3F * field->surface.voxel));
    gridFact("memory", fmt::format("{:.1f} MB", static_cast<double>(field->bytes()) / 1e6));
    ImGui::Spacing();
    drawControls(*field, width);
    if (stale_) refresh(*field);
    drawSliceImage(*field, width);
    drawMaterials(width);
}

// The field to show; a combo box where there are several.
const VoxelField* VoxelPanel::choose(const SolidFields& fields, float width) {
    std::vector<const VoxelField*> all;
    std::vector<std::string> names;
    if (fields.still != nullptr && !fields.still->empty()) {
        all.push_back(fields.still);
        names.emplace_back("static");
    }
    for (const auto& [kind, list] : {std::pair("moving", &fields.rigid), std::pair("deforming", &fields.deforming)}) {
        for (size_t k = 0; k < list->size(); ++k) {
            all.push_back((*list)[k]);
            names.push_back(fmt::format("{} {}", kind, k + 1));
        }
    }
    if (all.empty()) return nullptr;
    chosen_ = std::min(chosen_, static_cast<int>(all.size()) - 1);
    if (all.size() > 1) {
        ImGui::SetNextItemWidth(width);
        if (ImGui::BeginCombo("##field", names[static_cast<size_t>(chosen_)].c_str())) {
            for (int k = 0; k < static_cast<int>(all.size()); ++k)
                if (ImGui::Selectable(names[static_cast<size_t>(k)].c_str(), k == chosen_)) chosen_ = k;
            ImGui::EndCombo();
        }
    }
    return all[static_cast<size_t>(chosen_)];
}

// Looked at a few times a second at most, and for a tenth of the time at most where that is slow.
void VoxelPanel::label(double time) {
    const auto start = std::chrono::steady_clock::now();
    labels_ = labelRegions(field_->surface, nullptr);
    stale_ = true;
    labelledAt_ = time;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    nextLook_ = ImGui::GetTime() + std::max(0.25, 9 * spent);
}

void VoxelPanel::clearShown(const VoxelField* field) {
    field_ = field;
    labels_.reset();
    std::fill(std::begin(at_), std::end(at_), -1);
}

void VoxelPanel::drawControls(const VoxelField& field, float width) {
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const char* const axes[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
        if (k > 0) ImGui::SameLine();
        if (ImGui::RadioButton(axes[k], axis_ == k)) {
            axis_ = k;
            stale_ = true;
        }
    }
    ImGui::SameLine(0, 3 * gap);
    for (const auto& [name, what] : {std::pair("materials", Shown::materials), std::pair("band", Shown::distance)}) {
        if (what != Shown::materials) ImGui::SameLine();
        if (ImGui::RadioButton(name, shown_ == what)) {
            shown_ = what;
            stale_ = true;
        }
    }
    ImGui::SetNextItemWidth(width);
    const std::string format = fmt::format("{} = %d", axes[axis_]);
    if (ImGui::SliderInt("##slice", &at_[axis_], 0, field.surface.size[axis_] - 1, format.c_str(), ImGuiSliderFlags_AlwaysClamp))
        stale_ = true;
}

void VoxelPanel::refresh(const VoxelField& field) {
    stale_ = false;
    const ivec3& size = field.surface.size;
    VoxelPicture picture = shown_ == Shown::materials ? drawSlice(*labels_, axis_, at_[axis_])
                                                      : drawBandSlice(field.distance, field.band, size, axis_, at_[axis_]);
    gpu::TextureDesc desc;
    desc.width = picture.width;
    desc.height = picture.height;
    if (!slice_ || !(slice_.desc() == gpu::settled(desc))) {
        auto made = gpu::Texture::create(desc);
        complaint_ = made ? "" : made.error().message;
        slice_ = made ? std::move(*made) : gpu::Texture();
        if (!slice_) return;
        gpu::Sampling sampling;
        sampling.mag = gpu::Filter::nearest;  // voxels have edges
        slice_.setSampling(sampling);
    }
    slice_.upload(std::as_bytes(std::span(picture.rgba)));
}

void VoxelPanel::drawSliceImage(const VoxelField& field, float width) {
    if (!slice_) {
        ImGui::TextWrapped("%s", complaint_.c_str());
        return;
    }
    const ivec2 axes = sliceAxes(axis_);
    const vec2 size(static_cast<float>(field.surface.size[axes.x]), static_cast<float>(field.surface.size[axes.y]));
    const float scale = width / std::max(size.x, size.y);
    const ImVec2 image(std::round(scale * size.x), std::round(scale * size.y));
    const float left = ImGui::GetCursorPosX();
    ImGui::SetCursorPosX(left + std::floor(0.5F * (width - image.x)));
    // Rows are uploaded from the top: the first is where ImGui begins too.
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(slice_.name())), image);
    ImGui::Spacing();
}

void VoxelPanel::drawMaterials(float width) const {
    constexpr size_t kMost = 64;
    if (!ImGui::BeginTable("materials", 3, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_RowBg, ImVec2(width, 0))) return;
    ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 1.3F);
    ImGui::TableSetupColumn("voxels", ImGuiTableColumnFlags_WidthStretch, 1.0F);
    ImGui::TableSetupColumn("volume", ImGuiTableColumnFlags_WidthStretch, 0.9F);
    ImGui::TableNextRow();
    for (const char* title : {"", "voxels", "volume"}) {
        ImGui::TableNextColumn();
        ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
        textRight(title);
        ImGui::PopStyleColor();
    }
    materialRow(*labels_, kInsideSurface, "surface", grouped(labels_->surface), "");
    materialRow(*labels_, kOutside, "outside", grouped(labels_->outside), "");
    for (size_t k = 0; k < std::min(kMost, labels_->materials.size()); ++k) {
        const VoxelMaterial& m = labels_->materials[k];
        materialRow(*labels_, kFirstMaterial + static_cast<uint32_t>(k), fmt::format("material {}", k), grouped(m.voxels),
                    readableVolume(m.volume));
    }
    ImGui::EndTable();
    if (labels_->materials.size() > kMost) ImGui::TextDisabled("and %zu more", labels_->materials.size() - kMost);
}

}  // namespace rivulet
