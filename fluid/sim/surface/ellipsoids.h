// The ellipsoids that stand for particles amid their neighbours (Yu & Turk 2013), for drawing: found once a frame, from the neighbours of
// its last step.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/world/step_context.h"

namespace rivulet {

class Ellipsoids {
  public:
    // Nothing the second time. Error (failed): out of memory, a kernel does not compile.
    Status prepare(Device& device, const PairTraits& traits, uint32_t count);
    // `params`: of the last step.
    void find(Device& device, const StepParams& params, NeighborGrid& grid, const Particles& particles);
    // The same, of slots that particles are spawned into: they have no ellipsoid until their first step.
    void clearFree(Device& device, const StepParams& params, const NeighborGrid& grid, uint32_t count);
    // There is no state that they belong to.
    void forget() { found_ = false; }
    // vec4 each, in the particles' order, as shaders/fluid/surface/ellipsoids.kernel writes them: centre, spread, slant. Null: not found.
    std::array<const Buffer*, 3> buffers() const {
        return found_ ? std::array<const Buffer*, 3>{&of_[0], &of_[1], &of_[2]} : std::array<const Buffer*, 3>{};
    }

  private:
    PairKernel kernel_;
    Kernel free_;
    std::array<Buffer, 3> of_;
    bool prepared_ = false, found_ = false;
};

// Read back: centre, spread and slant, in the particles' order. Empty: there are none.
using HostEllipsoids = std::array<std::vector<vec4>, 3>;

// Of particles that no world steps: xyz m, w = density / rest density. Neighbours are nearer than two spacings (m). Error (failed): out of
// memory; a kernel does not compile.
Result<HostEllipsoids> ellipsoidsOf(Device& device, std::span<const vec4> particles, float spacing);

}  // namespace rivulet
