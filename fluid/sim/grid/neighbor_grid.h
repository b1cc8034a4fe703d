// The neighbour grid: particles sorted by cell (edge = support radius h), so that a row of cells is contiguous in memory.
// Behind the fluid come the samples on bodies, in cells of their own; then what is indexed nowhere: particles outside the bounds or with
// NaN, and free slots. shaders/fluid/grid/grid.h says where each begins.
//
// GPU: atomics count, a three-dispatch prefix sum, a sort by id inside each cell (the same order in every run); kernels sweep rows.
// CPU: a stable counting sort, groups of 8 particles, and a list of candidate neighbours for each group.
// fluid.grid linked_list, on a GPU: nothing is sorted, each cell has a list (thesis 4.2; shaders/fluid/grid/linked_list.h).
#pragma once

#include <memory>
#include <span>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/world/particles.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// What decides which form of the pair kernels a world needs.
struct PairTraits {
    bvec3 periodic{false};    // axes on which the bounds wrap round
    bool repeats = false;     // cells repeat in space along all axes: positions may be anywhere, distances are as without
    bool matter = false;      // particles differ: several liquids, or samples on bodies
    uint32_t samples = 0;     // on bodies: the last ids
    bool walls = true;        // else the box wraps round along all axes and there are no colliders
    bool linked = false;      // fluid.grid linked_list
    bool follows = false;     // the grid of a very large box may cover only the particles: NeighborGrid::follow
    bool sleeps = false;      // fluid.sleep: particles may be asleep
    bool asleepRows = false;  // the same on a GPU: pair kernels visit rows of sleeping particles too
    bool keeps = true;        // a GPU has room to keep which neighbours are within reach; false: no FOR_PAIRS that keeps runs on the grid
    uint32_t workGroup = 0;   // threads, of a GPU; 0 = the device's default
    // LINKED_LIST, LOCAL_SIZE: of a kernel with a thread a particle that tests which particles take part.
    std::vector<Define> threadDefines() const;
    std::vector<Define> defines() const;  // MATTER, PERIODIC, REPEATS, SLEEP and those above: of every kernel with FOR_NEIGHBORS
    // Defines for every kernel with walls; OPEN if there are none. `extra`: further defines.
    std::vector<Define> wallDefines(std::vector<Define> extra = {}) const;
};

class NeighborGrid {
  public:
    // `inside`: where particles may be (m), with traits.repeats where most of them are; `count`: slots, samples with them. Error: so many
    // cells that memory would not hold them, with the spacing that would fit, unless traits.follows; a periodic axis shorter than 2 h.
    // checkCells() reports the first of these before anything is allocated; its `count` may be too small.
    static Status checkCells(const Bounds& inside, float h, double count, const PairTraits& traits);
    static Result<NeighborGrid> create(Device& device, const Bounds& inside, float h, uint32_t count, const PairTraits& traits = {});
    NeighborGrid(NeighborGrid&&) noexcept;
    NeighborGrid& operator=(NeighborGrid&&) noexcept;
    ~NeighborGrid();

    void fill(StepParams& params) const;  // the grid's part of it

    // Whether it covers a part of its bounds alone, because cells for all of them would be many more than the particles. Then follow() must
    // be called before each build: it covers `wanted` (m), with room about it, so that it seldom changes, and fill() has other values.
    // Where that holds too many cells they are wider than h. Error (noMemory): nothing has changed.
    bool isWindow() const;
    Status follow(const Bounds& wanted);
    // Lists reach this times h: for methods that move particles between builds.
    void setMargin(float margin);
    // GPU, sorted: sets the cells of the particles in their present order, as fluid/grid/cell_of computes them; the next build uses them.
    // If particles move before the build, call this with none.
    void setCells(std::span<const uint32_t> cells);
    // Sorts the newest state into position, velocity, id, and prepares neighbours; of linked lists it keeps the order. Error: (noMemory)
    // for the lists; (failed) more entries than lists may have, or interrupted (Device::stopOn). The newest state is then as it was, and a
    // later build may succeed.
    Status build(const StepParams& params, Particles& particles);
    // After a build(): the newest state is as it was before it, and what is sorted serves queries alone.
    void undo(Particles& particles);

    // The cpu keeps the slots of sleeping particles from step to step, the last ones, until some fall asleep or wake: then call
    // sortAsleep().
    void sortAsleep();
    bool sortsAsleep() const;     // the next build() sorts them
    uint32_t awakeSlots() const;  // cpu: slots before them, after a build()
    // cpu: another object whenever the particles in those slots, or their values, may have changed. Null: what sleeps has no slots of its
    // own, or the next build() sorts it.
    std::shared_ptr<const void> sleepers() const;

    const Buffer& neighbors() const;   // binding 1 of a kernel with FOR_NEIGHBORS
    const Buffer& cellStart() const;   // [params.cellCount] = how many particles of the fluid are inside; or the linked lists
    const Buffer& cellCounts() const;  // particles of each cell, of linked lists
    uint32_t pairThreads() const;      // threads of a kernel with FOR_NEIGHBORS over the fluid: groups on the CPU, particles on a GPU
    uint32_t sampleThreads() const;    // the same over the samples on bodies

  private:
    struct Impl;
    explicit NeighborGrid(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
