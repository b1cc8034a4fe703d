// FluidView: the input of a fluid renderer: particles as OpenGL buffers, from any Device. Names of buffers are GL names; 0: none.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/world/fluid_params.h"
#include "shaders/fluid/sources/dry_volume.h"

namespace rivulet {

struct FluidView {
    unsigned position = 0;  // GL buffer name, vec4: xyz m, w = density / rest density; negative: not drawn
    unsigned velocity = 0;  // GL buffer name, vec4: xyz m/s; with FluidLookParams::showsNormals(): normals, w their length
    unsigned id = 0;        // GL buffer name, uint
    // GL buffer name, vec4: xyz absorption of red, green and blue by the particle's liquid and dye, w scattering, 1/m, added to
    // FluidLook's; w < 0: they replace FluidLook's, and the scattering is -1 - w. 0: all particles are alike.
    unsigned absorption = 0;
    // GL buffer names, vec4 each: the values of FluidParams::attributes, in its order; 0 beyond them. For shaders of a host.
    std::array<unsigned, kMostAttributes> attributes = {};
    // GL buffer names, vec4 each, of the ellipsoids around the particles (shaders/fluid/surface/ellipsoids.kernel): centre, spread, slant.
    // 0: particles are drawn as spheres.
    std::array<unsigned, 3> ellipsoids = {};
    uint32_t count = 0;  // particles; 0: nothing is drawn, and the names may be 0. Particles with NaN are not drawn
    uint32_t half = 0;   // the first `half` particles (of those awake) are every second one, the same in each frame; 0: no such order
    // Particles that sleep come last, and are the same while `sleepers` is the same object: what is drawn of them may be kept. Of the
    // others the first `awake` hold all that is drawn. `asleepHalf`: of those that sleep, as `half`. 0 and null: none is known to sleep.
    uint32_t asleep = 0, awake = 0, asleepHalf = 0;
    std::shared_ptr<const void> sleepers = {};
    float radius = 0.01F;         // m, of a drawn sphere
    float spacing = 0.02F;        // m
    float viscosity = 0;          // m^2/s, kinematic, of the most viscous liquid: one that is viscous enough does not break up into spray
    float exposure = 1.0F / 120;  // s, simulated, that a picture is exposed: half a frame at 60 Hz, as film is
    // Spray, foam and bubbles: GL buffer names, as ParticleView::foamDrawn and foamVelocity.
    std::array<unsigned, 2> foam = {};
    uint32_t foamCount = 0;
    // Where the surface is cut: FluidWorld::dry(). With hasNewPoses() FluidWorld::ownDry(): those of bodies in their frames.
    std::vector<DryVolume> dry = {};
    // The wetness of solids: GL buffer names, WetnessView::cells and values. 0: all is dry.
    unsigned wetCells = 0, wetness = 0;
    size_t wetCellBytes = 0, wetnessBytes = 0;
    // Drops in the air: GL buffer name, two vec4 per drop: xyz position, m, w radius, m; xyz velocity, m/s.
    unsigned drops = 0;
    uint32_t dropCount = 0;
    // Drops that hang or have just let go: GL buffer name, five vec4 per drop, as shaders/screen_space/pendant.glsl has them, in the world.
    unsigned pendants = 0;
    uint32_t pendantCount = 0;
    // Bodies that a GPU moves: GL buffer name, rows of DeviceBody (shaders/fluid/solids/body_state.h) in the order of FluidWorld::bodyIds.
    // They are valid where `bodiesMoved` is not null, and the same while it is the same object; else the host knows where the bodies are,
    // and the name may be 0. Meshes with plain materials are drawn by them; textured, layered and clear ones where the host expects them.
    unsigned bodies = 0;
    uint32_t bodyCount = 0;  // also where the host moves them now; 0: always
    std::shared_ptr<const void> bodiesMoved = {};
    bool hasNewPoses() const { return bodies != 0 && bodyCount > 0 && bodiesMoved != nullptr; }
    Bounds bounds;  // m, world: the box of the water, which is cut there and casts a shadow from there; empty: no cut, no shadow
};

// 0: drops as large as a particle break up into spray; 1: the liquid is too viscous for that, by their Ohnesorge number (Ohnesorge 1936;
// threads and sheets hold above about 0.1). `viscosity` m^2/s, kinematic, `spacing` m. The tension over density of liquids is taken as 5e-5
// m^3/s^2: 3.5e-5 of oils to 7.3e-5 of water.
inline float holdsTogether(float viscosity, float spacing) {
    return glm::smoothstep(0.02F, 0.15F, viscosity / std::sqrt(5.0e-5F * std::max(spacing, 1.0e-6F)));
}

}  // namespace rivulet
