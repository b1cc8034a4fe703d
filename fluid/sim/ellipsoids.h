// The ellipsoids that stand for particles amid their neighbours (Yu & Turk 2013), for drawing: found once a frame, from the neighbours of
// its last step.
#pragma once

#include <array>

#include "engine/compute/device.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/step_context.h"

namespace rivulet {

class Ellipsoids {
  public:
    // Nothing the second time. Error (failed): out of memory, a kernel does not compile.
    Status prepare(Device& device, const PairTraits& traits, uint32_t count);
    // `params`: of the last step.
    void find(Device& device, const StepParams& params, NeighborGrid& grid, const Particles& particles);
    // There is no state that they belong to.
    void forget() { found_ = false; }
    // vec4 each, in the particles' order, as shaders/fluid/ellipsoids.kernel writes them: centre, spread, slant. Null: not found.
    std::array<const Buffer*, 3> buffers() const {
        return found_ ? std::array<const Buffer*, 3>{&of_[0], &of_[1], &of_[2]} : std::array<const Buffer*, 3>{};
    }

  private:
    PairKernel kernel_;
    std::array<Buffer, 3> of_;
    bool prepared_ = false, found_ = false;
};

}  // namespace rivulet
