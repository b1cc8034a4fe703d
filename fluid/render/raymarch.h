// Raymarch: the picture of an IsoSurface at full precision, on all cores: the reference for the renderers.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/render/frame_view.h"
#include "fluid/sim/surface/iso_surface.h"

namespace rivulet {

// The density ratio from which on more than half of a particle is part of the body of the water, and not spray: as leaving() of
// particle.glsl. `holds`: holdsTogether().
inline float bodyDensity(float holds) {
    const float half = 0.637F;  // where smoothstep is 0.7, so that leaving() is a half
    return glm::mix(glm::mix(0.42F, 0.3F, holds), glm::mix(0.72F, 0.42F, holds), half);
}

// The particles of the body of the water; those near a wall of its box once more behind it, mirrored. The surface of particles alone turns
// round before a wall, by a third of a spacing along an edge of the box; with these it meets walls at right angles, and water that lies in
// an edge fills it. Empty box: no walls.
// `particles`: xyz m, w density ratio.
std::vector<vec4> bodyAtWalls(std::span<const vec4> particles, float spacing, const Bounds& box, float holds = 0.0F);

// One value per pixel in OpenGL's order: the bottom row first.
struct RaymarchPicture {
    int width = 0, height = 0;
    std::vector<float> depth;  // m along the view axis to the point where the ray enters the water; kNoDepth: it misses
    std::vector<vec4> water;   // xyz: the normal there, view space, unit, w: m of water along the whole ray
};

struct RaymarchOptions {
    Bounds box;                    // m, world: the water is cut at its faces; empty: no cut
    std::span<const float> until;  // m along the view axis, one per pixel: where the ray ends; empty: at the far plane
    // Called with the finished share, 0 to 1, after each tile, from any thread, one call at a time. false: the rest stays empty.
    std::function<bool(double)> progress = [](double) { return true; };
};

// Rays through the centres of pixels, from the near plane to the far one. Cells without particles are skipped; elsewhere a step is 0.08 to
// 0.7 spacings, longer the farther the value is from the surface's; a peak between steps is checked. Hits are bisected to 1e-4 spacings.
RaymarchPicture raymarch(const IsoSurface& surface, const FrameView& view, const RaymarchOptions& options = {});

}  // namespace rivulet
