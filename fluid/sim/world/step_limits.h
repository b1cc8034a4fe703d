// The speeds of the water in a world, and the longest stable step at these speeds.
#pragma once

#include "fluid/sim/forces/world_forces.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/emitter.h"

namespace rivulet {

class StepLimits {
  public:
    // The values that the limits depend on.
    struct Inputs {
        const FluidParams& params;
        const Method& method;
        const WorldForces& forces;
        std::span<const Emitter> emitters;
        vec3 gravity;         // m/s^2
        float fastestSource;  // m/s, highest emission speed
        float fastestBody;    // m/s
        bool atStart;         // t = 0: the speeds of bodies are those of the scene
        // Bounds and highest speed of the particles that the host placed at t = 0; null: none.
        const BlockParams* placed = nullptr;
    };
    // Further values that limit a step.
    struct Measured {
        double late = 0;         // s since speeds were measured, which arrive some frames late on a GPU
        double maxSpeed = 0;     // m/s, of particles at that time
        float fastestWall = 0;   // m/s, in this frame
        float mostViscous = 0;   // m^2/s; 0: all particles are alike
        const StepParams& step;  // of this step
    };

    // m/s, speed after a fall from the highest block or emitter to the far side of the box, including the initial speed.
    float fastestFall(const Inputs& in) const;
    // Upper limit of the speed of water, m/s: ten times the speed from a fall across the box, walls, forces or the start, or twice the
    // speed of sound. Without this limit, in a failing run speeds would grow as steps shrink, and steps shrink as speeds grow.
    float fastestPossible(const Inputs& in) const;
    // The longest stable step: acoustic CFL or the longest path in a step, viscous and body-force limits (Monaghan 1992, with the
    // constants of Morris et al. 1997).
    StepLimit longest(const Inputs& in, const Measured& measured, double frameSeconds) const;

    float fastestWall = 0;   // m/s, of moving solids, lately
    float fastestStart = 0;  // m/s, of particles at their start, or restored from a saved state
    float fastestEver = 0;   // m/s, the largest fastestPossible() since t = 0
};

}  // namespace rivulet
