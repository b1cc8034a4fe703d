// What drawing a world and drawing a snapshot share.
#pragma once

#include <functional>
#include <string>

#include "engine/core/result.h"
#include "fluid/capi/handles.h"

namespace rivulet::capi {

// Error (badInput): the context has no OpenGL; (failed): it has ended.
Status drawable(const rivulet_context& context);

// Checks the view and the target, then draws what `fluid` returns; it is called with OpenGL in the host's state, and restores that. Error
// (badInput): a value of the view or the target; as WaterRenderer::draw and `fluid`.
Status drawWater(rivulet_context& context, const FluidLookParams& params, const std::string& liquid, const rivulet_view* view,
                 const rivulet_target* target, const std::function<Result<FluidView>()>& fluid);

// Adds the world as it is to its recording, if there is one. Error (failed): as RecordingWriter::add; the recording has then ended.
Status recordFrame(rivulet_world& world);

// For rivulet_buffers: all particles in one order, velocities and no normals.
FluidLookParams plainLook(FluidLookParams look);
rivulet_buffers buffersOf(const FluidView& fluid);

}  // namespace rivulet::capi
