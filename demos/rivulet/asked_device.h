// The device that --backend and --device ask a verb without pictures for, with what must outlive it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/app/context_egl.h"
#include "fluid/render/backend.h"

namespace rivulet {

struct AskedDevice {
    std::optional<ContextEgl> context;  // where gl or auto was asked for, and there is one
    std::unique_ptr<Device> device;
};

// As makeDevice: an absent one is a notice in `log`, and a cpu device.
inline AskedDevice askedDevice(const std::string& backend, const Log& log, const std::string& clDevice = {}) {
    AskedDevice asked;
    GlFacts gl = noGl("no OpenGL was asked for");
    if (backend == "gl" || backend == "auto") {
        Result<ContextEgl> made = ContextEgl::create();
        gl = made ? currentGlFacts() : noGl(made.error().message);
        if (made) asked.context = std::move(*made);
    }
    asked.device = makeDevice(backend, gl, log, clDevice);
    return asked;
}

}  // namespace rivulet
