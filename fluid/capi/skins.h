// A step of a skin, by itself (skin.cpp) or with others and the drops in the air (air.cpp).
#pragma once

#include "engine/core/result.h"
#include "fluid/capi/call.h"
#include "fluid/capi/handles.h"

namespace rivulet::capi {

// What a step uses: OpenGL on every backend, if the positions are in one of its buffers. Its inputs are not checked yet.
Needs needsOf(const rivulet_skin_inputs* inputs);
// Error (badInput): a value of the inputs or the seconds; (failed): a stop is asked, or has interrupted an earlier step.
Status checkSkinStep(rivulet_skin& skin, const rivulet_skin_inputs& in, double seconds);
// Where the skin is in a step that begins at `begin` (s) and takes `seconds`.
void placeSkin(rivulet_skin& skin, const rivulet_skin_inputs& in, double begin, double seconds);
// Error: as SurfaceFlow::step; (failed): it was interrupted.
Status stepSkin(rivulet_skin& skin, const rivulet_skin_inputs& in, const vec3& gravity, double seconds);

}  // namespace rivulet::capi
