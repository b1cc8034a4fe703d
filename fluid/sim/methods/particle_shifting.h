// Particle shifting (Lind et al. 2012) for methods with negative pressure. Under tension particles clump (Swegle et al. 1995): a pair that
// comes closer attracts more strongly, and the density does not show it. Shifting moves them apart again, and conserves momentum and
// angular momentum (docs/decisions/0023-tension.md).
#pragma once

#include "fluid/sim/world/step_context.h"

namespace rivulet {

class ParticleShifting {
  public:
    static Result<ParticleShifting> create(Device& device, const PairTraits& traits);

    // Shifts particles under tension between the solve of a step and its integration. `shifted`, a vec4 a slot, receives the places (m, in
    // sorted order) from which to integrate; particles.position stays where the step began, as collisions need it. particles.velocity
    // receives the new velocities; positionNext and velocityNext are scratch. `pressure`: negative where there is tension; `scale`: 1 over
    // its unit, such that 1 moves a particle by about a spacing in a step.
    void run(StepContext& context, const Buffer& pressure, float scale, Buffer& shifted);

  private:
    PairKernel wish_, shift_;
};

}  // namespace rivulet
