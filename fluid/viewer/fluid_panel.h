// The top of the scene's panel: buttons, figures of the run, messages. Each part has a fixed height, so that nothing below it moves.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "fluid/sim/world/fluid_world.h"
#include "fluid/viewer/commands.h"

namespace rivulet {

struct FluidPanelState {
    bool paused = false, filming = false, pouring = false, recording = false, measuring = false;
    std::string backend;       // the device that simulates: "cpu: Intel(R) ..."
    std::string transfer;      // how particles reach OpenGL: sentenceOf(TransferFacts)
    std::string plan;          // of simulating and drawing: "off: each frame is simulated, then drawn"
    std::string renderer;      // of OpenGL: "llvmpipe (LLVM 15.0.6, 256 bits)"
    std::string quality, why;  // of the picture: "fast"; "drawing over 12 ms"
    double simulateMs = 0, frameMs = 0;
    std::string message;  // why an edit was refused; "": none
    std::span<const std::string> notices;
    std::string replay;  // the recorded frame that is shown; empty: no replay
};

struct FluidPanelActions {
    Command command = Command::none;     // of the button that was pressed
    std::optional<std::string> dismiss;  // a notice that was read
};

// Inside an ImGui window.
FluidPanelActions drawFluidPanel(const FluidWorld& world, const FluidPanelState& state);

}  // namespace rivulet
