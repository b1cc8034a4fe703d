// The light of a host's scene as the uniform block of a frame.
#pragma once

#include "engine/core/result.h"
#include "engine/render/frame_view.h"
#include "fluid/render/host_lighting.h"
#include "shaders/render/frame.h"

namespace rivulet {

// Error (badInput): too many lights; a value that is not finite or not in its range; a shadow map that is no flat texture.
Status usable(const HostLighting& lighting);

// Fills host, hostLights, hostColours, hostShadow and fog. `view`: the host's, with its unit of length.
void packLighting(const HostLighting& lighting, const FrameView& view, FrameParams& to);

}  // namespace rivulet
