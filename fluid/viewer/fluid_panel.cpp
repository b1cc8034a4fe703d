#include "fluid/viewer/fluid_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "engine/ui/style.h"

namespace rivulet {

namespace {

void fact(const char* name, const std::string& text) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetFontSize() * 7.5F);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
}

void sentence(const ImVec4& colour, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void simulationFacts(const FluidWorld& world) {
    const FluidStats& stats = world.stats();
    fact("time", fmt::format("{:.2f} s, {} substeps a frame", world.time(), world.lastSubsteps()));
    fact("particles",
         stats.lost > 0 ? fmt::format("{}, {} of them lost", stats.particles, stats.lost) : fmt::format("{}", stats.particles));
    fact("compression", fmt::format("{:.2f} % mean, {:.1f} % max", 100 * stats.avgCompression, 100 * stats.maxCompression));
    if (stats.iterations > 0)
        fact("pressure", stats.residual
                             ? fmt::format("{:.1f} iterations a substep, residual {:.3f} %", stats.iterations, 100 * *stats.residual)
                             : fmt::format("{:.1f} iterations a substep", stats.iterations));
}

}  // namespace

FluidPanelActions drawFluidPanel(const FluidWorld& world, const FluidPanelState& state) {
    FluidPanelActions actions;
    const ImVec2 size((ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3, 0);
    const struct {
        const char* label;
        Command command;
    } buttons[] = {{state.paused ? "run###pause" : "pause###pause", Command::pause},
                   {"step", Command::step},
                   {"reset", Command::restart},
                   {"scenes", Command::scenes},
                   {"save", Command::save},
                   {"keys", Command::help},
                   {state.pouring ? "stop pouring###pour" : "pour###pour", Command::pour},
                   {"picture", Command::picture},
                   {state.filming ? "stop###video" : "video###video", Command::video}};
    for (size_t k = 0; k < std::size(buttons); ++k) {
        if (k % 3 != 0) ImGui::SameLine();
        if (ImGui::Button(buttons[k].label, size)) actions.command = buttons[k].command;
    }
    ImGui::Spacing();

    const bool replays = !state.replay.empty();
    if (replays) fact("replaying", state.replay);
    if (!replays) fact("simulated by", state.backend);
    if (!replays) fact("cooperation", state.plan);
    fact("transfer", state.transfer);
    fact("drawn by", state.renderer);
    if (!replays) simulationFacts(world);
    fact("frame", fmt::format("{:.1f} ms", state.frameMs) + (replays ? "" : fmt::format(", simulation {:.1f} ms", state.simulateMs)));

    const ImVec4 red = refusedColour(), amber(0.95F, 0.78F, 0.45F, 1);
    if (!state.message.empty()) sentence(red, state.message);
    for (const std::string& text : world.stats().limited) sentence(amber, text);
    const std::vector<std::string>& limited = world.stats().limited;
    for (const std::string& text : state.notices)
        if (std::find(limited.begin(), limited.end(), text) == limited.end()) {
            sentence(amber, text);
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("click to dismiss");
            if (ImGui::IsItemClicked()) actions.dismiss = text;
        }
    return actions;
}

}  // namespace rivulet
