// ViewerOptions: what a window gives a Viewer, and how a Viewer opens its first scene.
#pragma once

#include <functional>
#include <string>

#include "engine/app/input_events.h"
#include "engine/app/shared_gl.h"
#include "engine/core/result.h"
#include "engine/gpu/gl_object.h"

namespace rivulet {

struct ViewerOptions {
    std::string backend = "auto";
    std::string device = {};         // of cl, as makeDevice
    std::string cooperate = "off";   // a row of plans(), or auto, which tries them at the start
    void* clipboard = nullptr;       // as UiLayer
    int width = 1280, height = 720;  // pixels, of what auto tries
    std::string seen = {};           // as WelcomeScreen
    double longestStep = 20;         // s: an edit after which a picture would take longer is refused
    // Makes a context that shares with the current one: scenes are opened on another thread then, and the window goes on. None: it waits.
    std::function<Result<SharedGl>()> share = {};
    // With `share`: shows what `draw` draws into a framebuffer, while the first scene is being opened. false: the person has closed the
    // window. None: create() returns when all is ready, and shows nothing till then.
    using Draw = std::function<void(const InputEvents& input, GLuint framebuffer)>;
    std::function<bool(const Draw& draw)> showing = {};
};

}  // namespace rivulet
