// The passes for exchange of water with other owners: they list particles in a box and withdraw particles. WaterQuery measures the density
// at a point; SourcePasses handles deposits.
#pragma once

#include <functional>
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
    static constexpr size_t kMost = 16384;  // particles a call
    // Error: out of memory.
    static Result<ExchangePasses> create(Device& device);
    bool any() const { return device_ != nullptr; }

    // Both wait for the device. Sorted by slot; at most kMost.
    std::vector<WorldParticle> within(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser);
    // At most kMost. `sorted`: the grid matches the current order of particles.
    void take(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
              std::span<const uint32_t> slots, bool sorted);
    Bounds taken(size_t count);  // around the places of the `count` that take() has just removed, m; waits

    // The same without waiting: `then` is called once, on the cpu before this returns, on a GPU during a later poll(). kMost at most.
    void withinLater(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser,
                     std::function<void(std::span<const WorldParticle>)> then);
    // `claims`: each id once, in ascending order; kMost at most. `then`: of each, 1 if its particle was removed.
    void claim(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
               std::span<const ParticleClaim> claims, bool sorted, std::function<void(std::span<const uint32_t>)> then);

  private:
    Device* device_ = nullptr;
    void forget(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
                bool sorted);
    void list(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser, size_t most);

    Kernel within_, take_, forget_, claim_;
    Buffer counter_, found_, slots_;
    Buffer claimed_, expected_, removed_;
};

}  // namespace rivulet
