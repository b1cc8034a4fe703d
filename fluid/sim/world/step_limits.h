// How fast the water of a world gets, and the longest step that is stable at that speed.
#pragma once

#include "fluid/sim/forces/world_forces.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/emitter.h"

namespace rivulet {

class StepLimits {
  public:
    // What the limits depend on, as it is now.
    struct Inputs {
        const FluidParams& params;
        const Method& method;
        const WorldForces& forces;
        std::span<const Emitter> emitters;
        vec3 gravity;         // m/s^2
        float fastestSource;  // m/s, of what emitters let out
        float fastestBody;    // m/s
        bool atStart;         // t = 0: how fast bodies are is what the scene asked for
    };
    // What a step is to be limited by beside that.
    struct Measured {
        double late = 0;         // s since speeds were measured: on a GPU figures come some frames late
        double maxSpeed = 0;     // m/s, of particles then
        float fastestWall = 0;   // m/s, in this frame
        float mostViscous = 0;   // m^2/s; 0: all particles are alike
        const StepParams& step;  // of this step
    };

    // m/s, what water reaches by falling from its highest block or emitter to the far side of the box, with what it starts with.
    float fastestFall(const Inputs& in) const;
    // No water of the scene is faster, m/s: ten times what a fall across the whole box, walls, forces or its own start give, or twice the
    // speed of sound. Where something fails, speeds would otherwise grow as steps shrink, and steps shrink as speeds grow.
    float fastestPossible(const Inputs& in) const;
    // The largest stable step: acoustic CFL or how far the fastest may go, viscous and body-force limits (Monaghan 1992, with the
    // constants of Morris et al. 1997).
    StepLimit longest(const Inputs& in, const Measured& measured, double frameSeconds) const;

    float fastestWall = 0;   // m/s, of moving solids, lately
    float fastestStart = 0;  // m/s, of particles as they were put in, or restored from a saved state
    float fastestEver = 0;   // m/s, the largest fastestPossible() since t = 0
};

}  // namespace rivulet
