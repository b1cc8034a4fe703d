// WaterRenderer: water drawn into a host's picture, in the host's own OpenGL context, whose state is afterwards as it was.
//
//     auto water = WaterRenderer::create({});
//     FluidView fluid = ...;                                  // FluidUpload makes one of a FluidWorld
//     (*water)->draw(view, fluid, look, {.framebuffer = 0, .width = w, .height = h});
//
// Needs a current OpenGL 4.5 context, core or compatibility, the same throughout, its destruction included, with its functions loaded
// (engine/gpu/load.h). One for all worlds of a context; contexts need one each. Not to be called from two threads at once.
#pragma once

#include <memory>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/result.h"
#include "engine/render/frame_view.h"
#include "engine/render/made_sky.h"
#include "fluid/render/fluid_look.h"
#include "fluid/render/fluid_view.h"
#include "fluid/render/host_target.h"

namespace rivulet {

struct RendererRow;  // fluid/render/renderers.h

struct WaterRendererOptions {
    // What water mirrors beside the picture itself: a map of the surroundings (read once; radiance in the target's units), or null: `sky`.
    const HdrImage* surroundings = nullptr;
    SkyLook sky = {};
    size_t memoryLimit = SIZE_MAX;  // bytes, of its textures, the surroundings' included; create() and draw() fail rather than hold more
};

class WaterRenderer {
  public:
    // Error (failed): a shader does not compile; out of memory. (badInput): gpu::load has not been called.
    static Result<std::unique_ptr<WaterRenderer>> create(const WaterRendererOptions& options);
    ~WaterRenderer();
    WaterRenderer(const WaterRenderer&) = delete;
    WaterRenderer& operator=(const WaterRenderer&) = delete;

    // Draws over what `target` holds: what is nearer hides water, what is farther is seen through it, refracted. Colours and depths change
    // where there is water, and nowhere else. `view.width` and `height` are the target's; `view.projection` is the one that the target's
    // depth was drawn with, of any of glClipControl's depth modes, reversed or not; nearPlane and farPlane (m) are finite and hold what
    // matters. Light is in the target's units: in one of srgb, 1 is white. `row`: another way to draw than the water's surface; a host may
    // bring its own. Error: (badInput) what of that does not hold; (failed) out of memory.
    Status draw(const FrameView& view, const FluidView& fluid, const FluidLook& look, const HostTarget& target,
                const RendererRow* row = nullptr);

    const std::vector<PassTime>& times() const;  // GPU ms a pass, two or three frames late
    size_t bytes() const;                        // of its textures

  private:
    struct Impl;
    explicit WaterRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
