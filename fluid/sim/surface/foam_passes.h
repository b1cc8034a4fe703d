// Spray, foam and bubbles (Ihmsen et al. 2012): small particles that the water carries and that do not affect it. The last step of a frame
// spawns, moves and removes them; their kind follows from the water around them.
#pragma once

#include <memory>

#include "engine/compute/device.h"
#include "fluid/sim/solids/solid_passes.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/step_context.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/surface/foam_params.h"

namespace rivulet {

class FoamPasses {
  public:
    // Error: out of memory.
    static Result<FoamPasses> create(Device& device, const FluidParams& params, const PairTraits& traits, uint32_t particles);
    void reset();

    // At the end of a frame of `seconds`: positionNext and velocityNext, in the order of the last sort.
    void run(const FluidParams& fluid, const StepParams& step, NeighborGrid& grid, const Particles& particles, SolidPasses& solids,
             double seconds);

    // For pictures between steps: sets the time before the newest state, s, at which foam is drawn. prepareDrawn() comes first: nothing the
    // second time. Error (noMemory).
    Status prepareDrawn();
    void drawEarlier(double seconds);
    void drawNewest() { earlier_ = false; }

    // The foam as part of a saved state. Error: as WorldState::take; another number of slots.
    struct Saved {
        std::vector<vec4> foam, velocity;
        uint32_t alive = 0, frame = 0;
    };
    void save(WorldState& state) const;
    Result<Saved> take(WorldState& state) const;
    void restore(const Saved& saved);

    uint32_t slots() const { return slots_; }
    const Buffer& foam() const { return foam_; }  // see shaders/fluid/surface/foam_params.h
    const Buffer& drawn() const { return earlier_ ? drawn_ : foam_; }
    const Buffer& velocity() const { return velocity_; }  // see there
    uint32_t alive() const { return counts_->alive; }     // on a GPU some frames ago

  private:
    struct Counts {
        uint32_t alive = 0;
    };
    Device* device_ = nullptr;
    uint32_t slots_ = 0, frame_ = 0;
    float hat_ = 0, flat_ = 0, fullness_ = 0;
    PairKernel air_, crest_;
    Kernel move_, wanted_, spawn_, back_;
    Buffer airs_, births_, before_, foam_, velocity_, lists_, most_;
    Buffer drawn_;  // created at the first use
    bool earlier_ = false;
    std::shared_ptr<Counts> counts_ = std::make_shared<Counts>();
};

}  // namespace rivulet
