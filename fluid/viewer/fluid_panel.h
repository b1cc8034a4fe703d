// The panel that says what the water does: pause, step, reset, and figures.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "fluid/sim/world/fluid_world.h"
#include "fluid/viewer/commands.h"

namespace rivulet {

struct FluidPanelState {
    bool paused = false, filming = false, pouring = false;
    std::string backend;   // what simulates: "cpu: Intel(R) ..."
    std::string transfer;  // how particles come to be drawn: as sentenceOf(TransferFacts)
    std::string plan;      // who simulates while who draws: "off: a frame is stepped, then drawn"
    std::string renderer;  // what draws: "llvmpipe (LLVM 15.0.6, 256 bits)"
    double simulateMs = 0, frameMs = 0;
    std::string message;  // an edit that was refused
    std::span<const std::string> notices;
    std::string replay;  // which recorded frame is shown; empty: it simulates
};

struct FluidPanelActions {
    Command command = Command::none;     // of the button that was pressed
    std::optional<std::string> dismiss;  // a notice that was read
};

// Inside an ImGui window.
FluidPanelActions drawFluidPanel(const FluidWorld& world, const FluidPanelState& state);

}  // namespace rivulet
