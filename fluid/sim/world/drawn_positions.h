// Positions for drawing if steps and pictures have different rates: interpolated between the last two states, for each particle.
#pragma once

#include "engine/compute/device.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

class DrawnPositions {
  public:
    // No effect when called again. Error (failed): out of memory, a kernel does not compile.
    Status prepare(Device& device, uint32_t count);
    // Call before the newest state becomes the previous one.
    void remember(Device& device, const Particles& particles);
    // `share` 0..1 of the way to the newest state; `reach`: the longest path of a particle in a fixed step, m.
    void draw(Device& device, const Particles& particles, float share, float reach);
    // Discards the previous state.
    void forget() { remembers_ = drawn_ = false; }
    // Before the first interpolation: the newest state.
    const Buffer& positions(const Particles& particles) const { return drawn_ ? positions_ : particles.positionNext; }

  private:
    Kernel remember_, blend_;
    Buffer remembered_, positions_;
    bool prepared_ = false, remembers_ = false, drawn_ = false;
};

}  // namespace rivulet
