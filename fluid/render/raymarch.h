// Raymarch: the picture that an IsoSurface makes, at full precision, on all cores: what the renderers are measured against.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/render/frame_view.h"
#include "fluid/sim/surface/iso_surface.h"

namespace rivulet {

constexpr float kNoDepth = 1.0e6F;  // m: shaders/render/frame.glsl's depth of nothing

// A pixel each, in OpenGL's order: the bottom row first.
struct RaymarchPicture {
    int width = 0, height = 0;
    std::vector<float> depth;  // m along the view axis, to where the ray enters the water; kNoDepth: it does not
    std::vector<vec4> water;   // xyz: the normal there, view space, unit, w: m of water along the whole ray
};

struct RaymarchOptions {
    Bounds box;                    // m, world: the water is cut there, flat as glass; empty: it is not
    std::span<const float> until;  // m along the view axis, a pixel each: no water is seen behind; empty: the far plane
    // The share that is done, from whichever thread has just finished a tile, one at a time. false: leave the rest empty.
    std::function<bool(double)> progress = [](double) { return true; };
};

// Rays through the centres of pixels, from the near plane to the far one. Cells without particles are skipped; elsewhere a step is 0.08 to
// 0.7 spacings, by how far the value is from the surface's, and a peak between steps is looked at. Hits are bisected to 1e-4 spacings.
RaymarchPicture raymarch(const IsoSurface& surface, const FrameView& view, const RaymarchOptions& options = {});

}  // namespace rivulet
