// ParticleBounds: where the particles of a world are, from a measurement that may be some frames old, so that no host waits for a GPU.
#pragma once

#include <memory>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

class ParticleBounds {
  public:
    static Result<ParticleBounds> create(Device& device);
    // They are at these places (m; w negative: none).
    void set(std::span<const vec4> position);
    void add(std::span<const vec4> position);  // and at these, before the first substep
    // Measures the newest positions of a sorted grid; the result arrives with Device::poll, on the cpu at once.
    void measure(Device& device, const StepParams& step, const NeighborGrid& grid, const Particles& particles);
    void moved() { ++steps_; }  // the particles made a substep
    // Where they may be, and may be after the next substep, if none moves further than `reach` (m) in one. `sources`: where particles may
    // be spawned (m); those that were since the last measurement have moved, too.
    Bounds next(float reach, const Bounds& sources = {}) const;

  private:
    struct Known {
        Bounds bounds;      // empty: no particles
        uint64_t step = 0;  // after which they were measured
    };
    std::shared_ptr<Known> known_ = std::make_shared<Known>();  // shared with reads in flight
    uint64_t steps_ = 0;
    Buffer rows_;
    Kernel measure_;
};

}  // namespace rivulet
