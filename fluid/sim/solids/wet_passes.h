// The wetness of solids: at the end of a frame the surface that water touches becomes wet, water runs down it, and the rest dries.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/solids/body_states.h"
#include "fluid/sim/solids/wet_surface.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

class WetPasses {
  public:
    // Error: out of memory. `linked`: PairTraits::linked.
    static Result<WetPasses> create(Device& device, const Solids& solids, float spacing, bool linked);
    // The same with other solids: those that stay keep their values, the others are dry. Waits for the device. Error: out of memory.
    Result<WetPasses> with(std::span<const WetSurface::Part> parts, float spacing) const;
    void reset();  // all dry

    // At the end of a frame of `seconds`: positionNext, in the order of the last sort. The poses are of the rigid solids and the bodies, of
    // these in `rows` where they are current.
    void run(const WetnessParams& params, const StepParams& step, const NeighborGrid& grid, const Particles& particles,
             std::span<const Pose> rigid, std::span<const BodyState> bodies, const BodyRows& rows, double seconds);

    // The wetness as part of a saved state. Error: as WorldState::take; another number of points, values that are none.
    void save(WorldState& state) const;
    Result<std::vector<float>> take(WorldState& state) const;
    void restore(std::span<const float> saved);  // empty: all dry

    const std::shared_ptr<const WetSurface>& surface() const { return surface_; }
    const Buffer& values() const { return wet_[now_]; }  // float, of each point: 0 dry .. 1 wet. Another one after each frame
    const Buffer& cells() const { return cells_; }       // WetSurface::cells

  private:
    Status allocate();

    Device* device_ = nullptr;
    std::shared_ptr<const WetSurface> surface_;
    Kernel kernel_;
    Buffer points_, cells_;
    std::array<Buffer, 2> wet_;
    int now_ = 0;
};

}  // namespace rivulet
