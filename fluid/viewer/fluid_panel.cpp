#include "fluid/viewer/fluid_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "engine/ui/icons.h"
#include "engine/ui/style.h"

namespace rivulet {

namespace {

// One line, whatever its length; the tooltip has all of it.
void fact(const char* name, const std::string& text, const std::string& more = {}) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetFontSize() * 7.1F);
    ImGui::TextUnformatted(text.c_str());
    const bool cut = ImGui::GetItemRectMax().x > ImGui::GetWindowPos().x + ImGui::GetContentRegionMax().x;
    if ((cut || !more.empty()) && ImGui::IsItemHovered()) ImGui::SetTooltip("%s%s%s", text.c_str(), more.empty() ? "" : "\n", more.c_str());
}

std::string milliseconds(double ms) {
    constexpr double kShort = 20;
    return ms < kShort ? fmt::format("{:.1f} ms", ms) : fmt::format("{:.0f} ms", ms);
}

void simulationFacts(const FluidWorld& world) {
    const FluidStats& stats = world.stats();
    fact("time", fmt::format("{:.2f} s", world.time()));
    fact("substeps",
         stats.iterations > 0 ? fmt::format("{} a frame, {:.1f} iterations", world.lastSubsteps(), stats.iterations)
                              : fmt::format("{} a frame", world.lastSubsteps()),
         stats.residual ? fmt::format("residual of the pressure solver: {:.3f} %", 100 * *stats.residual) : "");
    fact("particles", stats.lost > 0 ? fmt::format("{}, {} lost", stats.particles, stats.lost) : fmt::format("{}", stats.particles));
    fact("compression", fmt::format("{:.2f} % mean, {:.1f} % max", 100 * stats.avgCompression, 100 * stats.maxCompression));
}

Command drawButtons(const FluidPanelState& state) {
    const struct {
        Icon icon;
        const char* label;
        Command command;
        bool on = false;
    } buttons[] = {{state.paused ? Icon::play : Icon::pause, state.paused ? "run###pause" : "pause###pause", Command::pause},
                   {Icon::step, "step", Command::step},
                   {Icon::reset, "reset", Command::restart},
                   {Icon::drop, "pour###pour", Command::pour, state.pouring},
                   {Icon::record, state.recording ? "stop###record" : "record###record", Command::record, state.recording},
                   {Icon::video, state.filming ? "stop###video" : "video###video", Command::video, state.filming},
                   {Icon::scenes, "scenes", Command::scenes},
                   {Icon::save, "save", Command::save},
                   {Icon::picture, "picture", Command::picture},
                   {Icon::measure, "measure###measure", Command::measure, state.measuring},
                   {Icon::keys, "keys", Command::help},
                   {Icon::hide, "hide", Command::panels}};
    const float room = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
    float widest = 0;
    for (const auto& button : buttons) widest = std::max(widest, iconButtonWidth(button.label));
    const int across = std::clamp(static_cast<int>((room + gap) / (widest + gap)), 2, 3);
    const ImVec2 size((room - static_cast<float>(across - 1) * gap) / static_cast<float>(across), 0);
    Command pressed = Command::none;
    int k = 0;
    for (const auto& button : buttons) {
        if (k++ % across != 0) ImGui::SameLine();
        if (iconButton(button.icon, button.label, size, button.on)) pressed = button.command;
        if (!ImGui::IsItemHovered()) continue;
        for (const KeyRow& row : keys().rows)
            if (row.command == button.command && row.name[0] != '\0') ImGui::SetTooltip("%s: %s", row.name, row.doc);
    }
    return pressed;
}

void sentence(const ImVec4& colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

// The newest at the top; what has no room is scrolled to.
void drawMessages(const FluidWorld& world, const FluidPanelState& state, std::optional<std::string>& dismiss) {
    constexpr float kLow = 560;  // px: there the parameters come first
    const float lines = ImGui::GetIO().DisplaySize.y < kLow ? 2.0F : 4.0F;
    const ImVec2 pad(6, 3);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pad);
    ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetStyleColorVec4(ImGuiCol_FrameBg));
    ImGui::BeginChild("messages", ImVec2(0, lines * ImGui::GetTextLineHeight() + 2 * pad.y + 1), false,
                      ImGuiWindowFlags_AlwaysUseWindowPadding);
    const ImVec4 red = refusedColour(), amber(0.95F, 0.78F, 0.45F, 1);
    const std::vector<std::string>& limited = world.stats().limited;
    if (!state.message.empty()) sentence(red, state.message);
    for (size_t k = state.notices.size(); k-- > 0;) {
        const std::string& text = state.notices[k];
        if (std::find(limited.begin(), limited.end(), text) != limited.end()) continue;
        sentence(amber, text);
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("click to dismiss");
        if (ImGui::IsItemClicked()) dismiss = text;
    }
    for (const std::string& text : limited) sentence(amber, text);
    if (state.message.empty() && state.notices.empty() && limited.empty()) ImGui::TextDisabled("no messages");
    ImGui::EndChild();
    ImGui::PopStyleColor();
    ImGui::PopStyleVar();
}

// Which devices and plans are in use: folded at first, of a fixed height.
void drawDetails(const FluidPanelState& state) {
    constexpr float kLines = 11;
    bool& open = *ImGui::GetStateStorage()->GetBoolRef(ImGui::GetID("details"));
    // In a window of its own, so that its header ends where those of the parameters do.
    ImGui::BeginChild("devices", ImVec2(0, ImGui::GetFrameHeight() + (open ? kLines * ImGui::GetTextLineHeightWithSpacing() : 0)));
    open = ImGui::CollapsingHeader("devices");
    const std::pair<const char*, const std::string&> rows[] = {
        {"simulated by", state.backend}, {"drawn by", state.renderer}, {"cooperation", state.plan}, {"transfer", state.transfer}};
    for (const auto& [name, text] : rows) {
        if (!open) break;
        ImGui::TextDisabled("%s", name);
        ImGui::TextWrapped("%s", text.c_str());
    }
    ImGui::EndChild();
}

}  // namespace

FluidPanelActions drawFluidPanel(const FluidWorld& world, const FluidPanelState& state) {
    FluidPanelActions actions;
    actions.command = drawButtons(state);
    ImGui::Spacing();
    const bool replays = !state.replay.empty();
    if (replays) {
        ImGui::BeginChild("replay", ImVec2(0, 4 * ImGui::GetTextLineHeightWithSpacing() - ImGui::GetStyle().ItemSpacing.y));
        ImGui::TextWrapped("%s", state.replay.c_str());
        ImGui::EndChild();
    } else {
        simulationFacts(world);
    }
    fact("frame", replays ? milliseconds(state.frameMs)
                          : fmt::format("{}, simulation {}", milliseconds(state.frameMs), milliseconds(state.simulateMs)));
    fact("quality", state.why.empty() ? state.quality : fmt::format("{}: {}", state.quality, state.why),
         "look.quality chooses fast, fine or auto");
    ImGui::Spacing();
    drawMessages(world, state, actions.dismiss);
    drawDetails(state);
    return actions;
}

}  // namespace rivulet
