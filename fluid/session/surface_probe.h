// SurfaceProbe: the water as the screen-space renderer draws it, as numbers: depth of the surface and covered share of each pixel, of
// particles in an empty scene.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/app/context_egl.h"
#include "engine/render/frame_view.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/surface/ellipsoids.h"

namespace rivulet {

// One value per pixel, the bottom row first.
struct SurfaceSeen {
    std::vector<float> depth;  // m along the view axis; 1e6 where there is none
    std::vector<float> cover;  // 0 to 1: the share of the pixel in which water hides what is behind it, spray included
};

class SurfaceProbe {
  public:
    // `ownContext`: makes an OpenGL context, current during the probe's life; else one must be current. Error (failed): no OpenGL 4.5; a
    // shader does not compile.
    static Result<SurfaceProbe> create(bool ownContext);

    // `fluid`: radius, spacing and bounds; the buffers are made from `particles` (xyz m, w density ratio) and their ellipsoids; none:
    // spheres. Of `look`, absorption and scattering are not used. Error (failed): out of GPU memory.
    Result<SurfaceSeen> see(std::span<const vec4> particles, FluidView fluid, const FrameView& view, const FluidLook& look,
                            const HostEllipsoids& ellipsoids = {});

  private:
    SurfaceProbe() = default;
    std::optional<ContextEgl> context_;  // declared first: destroyed last
    FluidPrograms programs_;
};

}  // namespace rivulet
