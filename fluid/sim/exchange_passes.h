// The passes that let others hold the same water: where a world's particles are, how full a place is, and taking some out. What others
// hand over is poured: see SourcePasses.
#pragma once

#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/fluid_params.h"
#include "fluid/sim/method.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/particles.h"
#include "fluid/sim/world_particle.h"
#include "shaders/fluid/exchange_params.h"

namespace rivulet {

class ExchangePasses {
  public:
    // Error: out of memory.
    static Result<ExchangePasses> create(Device& device, const FluidParams& params);
    bool any() const { return device_ != nullptr; }

    // All wait for the device. Error: out of memory.
    Result<std::vector<float>> fullness(const StepParams& step, const NeighborGrid& grid, const Particles& particles,
                                        std::span<const vec3> places);
    // By slot. No more than 16,384 at once.
    std::vector<WorldParticle> within(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser);
    // No more than within() gives at once. `sorted`: the grid is of the particles as they lie.
    void take(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
              std::span<const uint32_t> slots, bool sorted);

  private:
    Device* device_ = nullptr;
    float weight_ = 0;
    Kernel fullness_, within_, take_, forget_;
    Buffer places_, answers_, counter_, found_, slots_;
};

}  // namespace rivulet
