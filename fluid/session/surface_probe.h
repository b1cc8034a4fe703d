// SurfaceProbe: the depth of the water's surface as the screen-space renderer computes it, of particles in an empty scene.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/app/context_egl.h"
#include "engine/render/frame_view.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/surface/ellipsoids.h"

namespace rivulet {

class SurfaceProbe {
  public:
    // `ownContext`: makes an OpenGL context, current during the probe's life; else one must be current. Error (failed): no OpenGL 4.5; a
    // shader does not compile.
    static Result<SurfaceProbe> create(bool ownContext);

    // m along the view axis, a pixel each, the bottom row first; 1e6 where there is none. `fluid`: radius, spacing and bounds; the buffers
    // are made from `particles` (xyz m, w density ratio) and their ellipsoids; none: spheres. Error (failed): out of GPU
    // memory.
    Result<std::vector<float>> depth(std::span<const vec4> particles, FluidView fluid, const FrameView& view, const FluidLook& look,
                                     const HostEllipsoids& ellipsoids = {});

  private:
    SurfaceProbe() = default;
    std::optional<ContextEgl> context_;  // declared first: destroyed last
    FluidPrograms programs_;
};

}  // namespace rivulet
