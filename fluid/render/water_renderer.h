// WaterRenderer: draws water into a host's picture, in the host's OpenGL context, and restores the context's state.
//
//     auto water = WaterRenderer::create({});
//     FluidView fluid = ...;                                  // FluidUpload makes one of a FluidWorld
//     (*water)->draw(view, fluid, look, {.framebuffer = 0, .width = w, .height = h});
//
// Needs a current OpenGL 4.5 context, core or compatibility, with its functions loaded (engine/gpu/load.h): the same context for every call
// and for the destruction. One renderer serves all worlds of a context. Do not call it from two threads at once.
#pragma once

#include <memory>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "engine/render/frame_view.h"
#include "engine/render/made_sky.h"
#include "fluid/render/fluid_look.h"
#include "fluid/render/fluid_view.h"
#include "fluid/render/host_lighting.h"
#include "fluid/render/host_target.h"

namespace rivulet {

struct RendererRow;  // fluid/render/renderers.h
namespace gpu {
class HostState;  // engine/gpu/host_state.h
}

struct WaterRendererOptions {
    // Reflected by the water beside the picture itself: a map of the surroundings (read once; radiance in the target's units); null: `sky`.
    const HdrImage* surroundings = nullptr;
    SkyLook sky = {};
    Log log = {};                   // receives why the cache of surroundings is not used
    size_t memoryLimit = SIZE_MAX;  // bytes of its textures, the surroundings included; create() and draw() fail beyond it
};

class WaterRenderer {
  public:
    // Error (failed): a shader does not compile; out of memory. (badInput): gpu::load has not been called.
    static Result<std::unique_ptr<WaterRenderer>> create(const WaterRendererOptions& options);
    ~WaterRenderer();
    WaterRenderer(const WaterRenderer&) = delete;
    WaterRenderer& operator=(const WaterRenderer&) = delete;

    // Draws over the picture in `target`: nearer surfaces hide the water, farther ones are seen through it, refracted. Colours and depths
    // change only where there is water. `view.view` and `projection` are those that the target's depth was drawn with: a perspective or an
    // orthographic projection, in any mode of glClipControl, reversed or not, right- or left-handed, mirrored or not, with an oblique near
    // plane or not. nearPlane and farPlane are finite and enclose the scene. All are in the host's unit of length, of which
    // `view.unitsPerMetre` are a metre; cameraPosWorld, width and height are not read. Light is in the target's units: in an srgb target, 1
    // is white. `row`: a row of renderers(), or one of the host; null: the water's surface. `lighting`: lights besides the view's, its
    // shadow map, and the fog of the scene. Error: (badInput) a condition above that does not hold; (failed) out of memory.
    Status draw(const FrameView& view, const FluidView& fluid, const FluidLook& look, const HostTarget& target,
                const RendererRow* row = nullptr, const HostLighting& lighting = {});
    // The same within a scope of HostState that the host holds, around several calls: state is saved once.
    Status draw(const gpu::HostState& scope, const FrameView& view, const FluidView& fluid, const FluidLook& look, const HostTarget& target,
                const RendererRow* row = nullptr, const HostLighting& lighting = {});

    // Replaces what the water reflects beside the picture itself. Costs 10 small draws and waits for nothing, so that a host may call it in
    // each frame while its sky changes. Error (badInput): none or two are given, a value of the image is negative or not finite, the
    // texture is of another kind, the turn is no rotation; (failed): out of memory. Then the ones before stay.
    Status setSurroundings(const HostSurroundings& surroundings);
    Status setSurroundings(const gpu::HostState& scope, const HostSurroundings& surroundings);

    const std::vector<PassTime>& times() const;  // GPU ms a pass, two or three frames late
    size_t bytes() const;                        // of its textures

  private:
    struct Impl;
    explicit WaterRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
