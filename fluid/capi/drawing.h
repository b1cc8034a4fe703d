// What drawing a world and drawing a snapshot share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/result.h"
#include "fluid/capi/handles.h"
#include "fluid/capi/host_renderer.h"
#include "fluid/render/host_lighting.h"
#include "fluid/render/host_target.h"
#include "fluid/render/renderers.h"

namespace rivulet::capi {

// Error (badInput): the context has no OpenGL; (failed): it has ended.
Status drawable(const rivulet_context& context);

// What WaterRenderer::draw takes besides the water.
struct WaterDraw {
    FrameView view;
    FluidLook look;
    HostTarget target;
    const RendererRow* row = nullptr;
    std::optional<HostRenderer> renderer = {};  // instead of `row`
    std::vector<HostLight> lights = {};
    HostShadow shadow = {};
    HostFog fog = {};
    HostLighting lighting() const { return {lights, shadow, fog}; }
};
// Error (badInput): a value of the view or the target.
Result<WaterDraw> waterDraw(const FluidLookParams& params, const std::string& liquid, const rivulet_view* view,
                            const rivulet_target* target);
Status drawWater(WaterRenderer& water, const gpu::HostState& scope, const FluidView& fluid, WaterDraw& draw);

// Adds the world as it is to its recording, if there is one. Error (failed): as RecordingWriter::add; the recording has then ended.
Status recordFrame(rivulet_world& world);

// For rivulet_buffers: all particles in one order, velocities and no normals.
FluidLookParams plainLook(FluidLookParams look);
rivulet_buffers buffersOf(const FluidView& fluid);

}  // namespace rivulet::capi
