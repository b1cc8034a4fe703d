// ParticleView: what a FluidWorld shows of its particles, as buffers on its Device.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/compute/device.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

// The particles on the Device. Valid until the next step(), reset() or destruction. Their order changes every step; ids do not. A slot with
// a negative w of the position holds no particle: it is free, or a sample on a body.
struct ParticleView {
    const Buffer* position = nullptr;  // vec4: xyz m, w = density / rest density; negative: no particle
    const Buffer* velocity = nullptr;  // vec4: xyz m/s, w unused
    const Buffer* id = nullptr;        // uint
    const Buffer* normal = nullptr;    // vec4: of the surface, w its length; null if fluid.forces.normals is none
    uint32_t count = 0;                // slots of the fluid, free ones included
    uint32_t slots = 0;                // of the arrays, samples with them
    // vec4: xyz absorption of red, green and blue by the particle's liquid and dye, 1/m; w 1: added to that of the world's own liquid, 0:
    // instead of it. Null if all particles are equal.
    const Buffer* absorption = nullptr;
    const Buffer* matterOf = nullptr;  // by id, as Particles::matterOf; null if all particles are equal
    // vec4: the values of FluidParams::attributes, in its order; null beyond them. In the order of `position`, like all others.
    std::array<const Buffer*, kMostAttributes> attributes = {};
    float spacing = 0;    // m
    float mass = 0;       // kg, of a particle of the world's own liquid
    float viscosity = 0;  // m^2/s, kinematic, of the most viscous liquid
    // Positions at the requested time: with fluid.fixedStep between the last two steps, one step late; otherwise `position`.
    const Buffer* drawn = nullptr;  // vec4: as position
    // The ellipsoids about them: Ellipsoids::buffers(). Null if fluid.ellipsoids is off, and before the first step.
    std::array<const Buffer*, 3> ellipsoids = {};
    // The last `asleep` slots hold sleeping particles: all arrays are the same there while `sleepers` is the same object. On a GPU, and
    // where it is not known, 0 and null.
    uint32_t asleep = 0;
    std::shared_ptr<const void> sleepers = {};
    // Spray, foam and bubbles, one vec4 each: xyz position, m, w remaining life, s (0: free slot); and xyz velocity, m/s, w size (0.5 to 1)
    // plus 1 for spray, 2 for foam, 3 for a bubble. Null if fluid.foam.most is 0.
    const Buffer* foam = nullptr;
    const Buffer* foamDrawn = nullptr;  // vec4: as foam, at the time of `drawn`
    const Buffer* foamVelocity = nullptr;
    uint32_t foamSlots = 0;
    std::shared_ptr<const void> revision = {};  // the same object while all of these hold the same values; null: not known
};

}  // namespace rivulet
