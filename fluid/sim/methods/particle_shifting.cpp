#include "fluid/sim/methods/particle_shifting.h"

namespace rivulet {

Result<ParticleShifting> ParticleShifting::create(Device& device, const PairTraits& traits) {
    ParticleShifting made;
    for (auto [kernel, path] : {std::pair(&made.wish_, "fluid/methods/shifting_wish"), std::pair(&made.shift_, "fluid/methods/shifting")}) {
        Result<PairKernel> found = PairKernel::find(device, path, traits, traits.wallDefines());
        if (!found) return found.error();
        *kernel = *found;
    }
    return made;
}

void ParticleShifting::run(StepContext& c, const Buffer& pressure, float scale, Buffer& shifted) {
    Particles& p = c.particles;
    StepParams s = c.params;
    s.force = vec4(scale, 0.0F, 0.0F, 0.0F);
    Buffer& wishes = shifted;
    if (s.asleepSets > 0) c.device.fill(wishes, 0);  // sleeping particles wish for nothing
    wish_.run(c, s, {&c.grid.neighbors(), &p.position, &p.nearWalls, &pressure, &wishes}, c.grid.pairThreads());
    // Samples on bodies and lost particles are not shifted. Sleeping particles are not copied either: integration does not write their
    // velocities again, so these must stay in the buffer where they are.
    const size_t bytes = size_t{c.params.awakeSlots} * sizeof(vec4);
    c.device.copy(p.position, p.positionNext, bytes);
    c.device.copy(p.velocity, p.velocityNext, bytes);
    shift_.run(c, s, {&c.grid.neighbors(), &p.position, &p.velocity, &p.nearWalls, &wishes, &p.positionNext, &p.velocityNext},
               c.grid.pairThreads());
    c.device.copy(p.positionNext, shifted, bytes);
    c.device.copy(p.velocityNext, p.velocity, bytes);
}

}  // namespace rivulet
