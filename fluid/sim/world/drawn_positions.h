// Positions to be drawn, where steps and pictures have different rates: between the two last states, particle by particle.
#pragma once

#include "engine/compute/device.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

class DrawnPositions {
  public:
    // Nothing the second time. Error (failed): out of memory, a kernel does not compile.
    Status prepare(Device& device, uint32_t count);
    // The newest state is about to become the one before.
    void remember(Device& device, const Particles& particles);
    // `share` 0..1 of the way to the newest state; `reach`: the furthest that a particle goes in a fixed step, m.
    void draw(Device& device, const Particles& particles, float share, float reach);
    // There is no state before.
    void forget() { remembers_ = drawn_ = false; }
    // As long as nothing has been drawn: the newest state.
    const Buffer& positions(const Particles& particles) const { return drawn_ ? positions_ : particles.positionNext; }

  private:
    Kernel remember_, blend_;
    Buffer remembered_, positions_;
    bool prepared_ = false, remembers_ = false, drawn_ = false;
};

}  // namespace rivulet
