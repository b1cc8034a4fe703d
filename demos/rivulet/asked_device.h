// The device that --backend and --device select for a verb that draws nothing, with the OpenGL context that must outlive it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "engine/app/context_egl.h"
#include "fluid/render/backend.h"

namespace rivulet {

struct AskedDevice {
    std::optional<ContextEgl> context;  // set if gl or auto was requested and OpenGL is present
    std::unique_ptr<Device> device;
};

// As makeDevice: if the requested backend is absent, `log` receives a notice and the cpu device is returned.
inline AskedDevice askedDevice(const std::string& backend, const Log& log, const std::string& clDevice = {}) {
    AskedDevice asked;
    GlFacts gl = noGl("OpenGL was not requested");
    if (backend == "gl" || backend == "auto") {
        Result<ContextEgl> made = ContextEgl::create();
        gl = made ? currentGlFacts() : noGl(made.error().message);
        if (made) asked.context = std::move(*made);
    }
    asked.device = makeDevice(backend, gl, log, clDevice);
    return asked;
}

}  // namespace rivulet
