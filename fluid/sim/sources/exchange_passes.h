// The passes that let others hold the same water: where a world's particles are, and taking some out. How full a place is, WaterQuery
// says; what others hand over is poured: see SourcePasses.
#pragma once

#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_particle.h"
#include "shaders/fluid/sources/exchange_params.h"

namespace rivulet {

class ExchangePasses {
  public:
    // Error: out of memory.
    static Result<ExchangePasses> create(Device& device);
    bool any() const { return device_ != nullptr; }

    // Both wait for the device. By slot. No more than 16,384 at once.
    std::vector<WorldParticle> within(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser);
    // No more than within() gives at once. `sorted`: the grid is of the particles as they lie.
    void take(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
              std::span<const uint32_t> slots, bool sorted);

  private:
    Device* device_ = nullptr;
    Kernel within_, take_, forget_;
    Buffer counter_, found_, slots_;
};

}  // namespace rivulet
