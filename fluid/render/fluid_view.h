// FluidView: what a fluid renderer draws: particles as OpenGL buffers, whichever Device simulated them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "engine/core/math.h"

namespace rivulet {

struct FluidView {
    unsigned position = 0;  // GL buffer name, vec4: xyz m, w = density / rest density; negative: not drawn
    unsigned velocity = 0;  // GL buffer name, vec4: xyz m/s; coloured by normal or surface: normals, w their length
    unsigned id = 0;        // GL buffer name, uint
    // GL buffer name, vec4: xyz what red, green and blue fade by in its liquid and dye, w what is scattered there, 1/m, on top of
    // FluidLook's; w < 0: instead of FluidLook's, and -1 - w is scattered. 0: all particles are alike.
    unsigned absorption = 0;
    // GL buffer names, vec4 each, of the ellipsoids about the particles, as shaders/fluid/surface/ellipsoids.kernel writes them: centre,
    // spread, slant. 0: they are drawn as spheres.
    std::array<unsigned, 3> ellipsoids = {};
    uint32_t count = 0;     // 0: nothing is drawn, and the names may be 0. Particles with NaN are left out
    uint32_t half = 0;      // the first so many are every second particle, the same ones each frame; 0: they are in no such order
    float radius = 0.01F;   // m, of a drawn sphere
    float spacing = 0.02F;  // m
    // Spray, foam and bubbles: GL buffer names, as ParticleView::foamDrawn and foamVelocity.
    std::array<unsigned, 2> foam = {};
    uint32_t foamCount = 0;
    // Drops in the air, of any size: GL buffer name, two vec4 a drop: xyz m, w radius, m; xyz m/s.
    unsigned drops = 0;
    uint32_t dropCount = 0;
    Bounds bounds;  // m, world: the box that the water is in: it is cut there, and its shadow map covers it; empty: no cut, no shadow
};

}  // namespace rivulet
