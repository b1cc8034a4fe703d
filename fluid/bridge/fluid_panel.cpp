#include "fluid/bridge/fluid_panel.h"

#include <fmt/format.h>
#include <imgui.h>

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

}  // namespace

FluidPanelActions drawFluidPanel(const FluidWorld& world, const FluidPanelState& state) {
    FluidPanelActions actions;
    float gap = ImGui::GetStyle().ItemSpacing.x;
    ImVec2 button((ImGui::GetContentRegionAvail().x - 3 * gap) / 4, 0);
    actions.togglePause = ImGui::Button(state.paused ? "run###pause" : "pause###pause", button);
    ImGui::SameLine();
    actions.step = ImGui::Button("step", button);
    ImGui::SameLine();
    actions.reset = ImGui::Button("reset", button);
    ImGui::SameLine();
    actions.help = ImGui::Button("keys", button);
    ImGui::Spacing();

    const FluidStats& stats = world.stats();
    fact("simulated by", state.backend);
    fact("cooperation", state.plan);
    fact("transfer", state.transfer);
    fact("drawn by", state.renderer);
    fact("time", fmt::format("{:.2f} s, {} substeps a frame", world.time(), world.lastSubsteps()));
    fact("particles",
         stats.lost > 0 ? fmt::format("{}, {} of them lost", stats.particles, stats.lost) : fmt::format("{}", stats.particles));
    fact("compression", fmt::format("{:.2f} % mean, {:.1f} % most", 100 * stats.avgCompression, 100 * stats.maxCompression));
    if (stats.iterations > 0)
        fact("pressure", stats.residual ? fmt::format("{:.1f} iterations a substep, {:.3f} % left", stats.iterations, 100 * *stats.residual)
                                        : fmt::format("{:.1f} iterations a substep", stats.iterations));
    fact("frame", fmt::format("{:.1f} ms, of it simulation {:.1f} ms", state.frameMs, state.simulateMs));

    const ImVec4 red(0.98F, 0.55F, 0.45F, 1), amber(0.95F, 0.78F, 0.45F, 1);
    if (!state.message.empty()) sentence(red, state.message);
    for (const std::string& text : stats.limited) sentence(amber, text);
    for (const std::string& text : state.notices) sentence(amber, text);
    return actions;
}

}  // namespace rivulet
