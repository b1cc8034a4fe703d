// The neighbour grid: particles sorted by cell (edge = support radius h), so that a row of cells is contiguous in memory.
// Particles outside the bounds, or with NaN, are sorted behind all others and indexed nowhere.
//
// GPU: atomics count, a three-dispatch prefix sum, a sort by id inside each cell (the same order in every run); kernels sweep rows.
// CPU: a stable counting sort, groups of 8 particles, and a list of candidate neighbours for each group.
#pragma once

#include <memory>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/particles.h"
#include "shaders/fluid/step_params.h"

namespace rivulet {

class NeighborGrid {
  public:
    // `inside`: where particles may be (m). Error: so many cells that memory would not hold them, with what spacing would fit.
    static Result<NeighborGrid> create(Device& device, const Bounds& inside, float h, uint32_t count);
    NeighborGrid(NeighborGrid&&) noexcept;
    NeighborGrid& operator=(NeighborGrid&&) noexcept;
    ~NeighborGrid();

    void fill(StepParams& params) const;  // the grid's part of it
    // Sorts the newest state into position, velocity, id, and prepares neighbours. Error: out of memory for the lists.
    Status build(const StepParams& params, Particles& particles);

    const Buffer& neighbors() const;  // binding 1 of a kernel with FOR_NEIGHBORS
    const Buffer& cellStart() const;  // [params.cellCount] = how many particles are inside
    uint32_t pairThreads() const;     // threads of a kernel with FOR_NEIGHBORS: groups on the CPU, particles on a GPU

  private:
    struct Impl;
    explicit NeighborGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
