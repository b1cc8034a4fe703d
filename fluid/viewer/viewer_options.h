// ViewerOptions: what a Viewer needs of its window, and how it opens its first scene.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "engine/app/input_events.h"
#include "engine/app/shared_gl.h"
#include "engine/core/result.h"
#include "engine/gpu/gl_object.h"

namespace rivulet {

struct ViewerOptions {
    std::string backend = "auto";
    std::string device = {};         // of cl: clDevice of makeDevice
    std::string cooperate = "off";   // a row of plans(), or auto, which tries them at the start
    void* clipboard = nullptr;       // of UiLayer::create
    int width = 1280, height = 720;  // pixels, of the pictures that auto tries
    std::string seen = {};           // of WelcomeScreen
    double longestStep = 20;         // s: an edit is refused if a frame would then take longer
    double askStep = 1.5;            // s: an edit needs a yes if a frame would then take longer
    // Makes a context that shares with the current one, so that scenes are opened on another thread. None: the window waits.
    std::function<Result<SharedGl>()> share = {};
    // With `share`: called while the first scene is opened; it calls `draw` and shows the framebuffer. Returns false if the window was
    // closed. None: create() shows nothing until the scene is ready.
    using Draw = std::function<void(const InputEvents& input, unsigned framebuffer)>;
    std::function<bool(const Draw& draw)> showing = {};
    // Device::stopOn, of the devices that simulate: true interrupts a step, after which the viewer can only be destroyed. Null: nothing
    // does.
    const std::atomic<bool>* stop = nullptr;
};

}  // namespace rivulet
