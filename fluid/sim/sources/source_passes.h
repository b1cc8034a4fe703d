// The passes of a step for emitters and sinks: they spawn particles in free slots, and free the slots of drained particles.
#pragma once

#include <memory>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/solids/body_passes.h"
#include "fluid/sim/solids/solid_passes.h"
#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

class SourcePasses {
  public:
    // Error (badInput): an invalid emitter, an unknown liquid; (failed): out of memory. `traits.matter` and
    // `absorption`: whether particles have those tables. `device` must outlive it.
    static Result<SourcePasses> create(Device& device, const Sources& sources, const FluidParams& params, bool matter, bool absorption);

    // Number of slots that emitters fill by the end of sources.seconds, at most what the box can hold.
    static double slotsFor(const Sources& sources, const FluidParams& params);

    bool any() const { return !feeds_.empty() || sinkCount_ > 0; }
    float fastest() const;  // m/s, highest emission speed
    // Sets the values that can change between steps. Error (badInput): invalid values; then nothing changes.
    Status set(const Sources& sources);
    void reset();  // back to t = 0

    // The parts of the world that a step reads.
    struct World {
        const StepParams& step;
        const FluidParams& params;
        const NeighborGrid& grid;
        Particles& particles;  // sorted as the substep sorted them
        const SolidPasses& solids;
        const BodyPasses& bodies;  // as far as the host knows where they are
        std::span<const DryVolume> dry;
        std::span<const NamedBuffer> remembered;  // of the method: its state per particle is removed with the particle
    };
    // After a substep of `dt` that ended at `time`; `last` of its frame.
    void run(const World& world, double time, double dt, bool last);
    // Deposits m^3 of the host, which become particles at `place` (m) in the following steps. sources.expectedDeposit was more than 0.
    void deposit(const vec3& place, const vec3& velocity, double volume);
    // Requests the counts, which arrive late on a GPU.
    void report();

    // By the last counts that arrived.
    uint64_t emitted() const;                     // particles, by all emitters and deposits
    uint64_t deposited() const;                   // of these, from deposits
    uint64_t drained() const;                     // particles
    bool full() const;                            // whether a particle had to wait because no slot was free
    double backlog() const;                       // particles due and not yet spawned
    double pending() const;                       // of these, from deposits
    std::span<const vec3> depositPlaces() const;  // of the last ones, m

    // The emitters' accounts and what is counted. Before save, report and wait for the device.
    struct Saved {
        std::vector<EmitterFeed::Account> accounts;
        std::vector<uint32_t> reported, counters;
        double waited = 0;
        EmitterFeed::Flight flight;
    };
    void save(WorldState& state) const;
    // Error: as WorldState::take; other emitters or sinks, or accounts that do not add up.
    Result<Saved> take(WorldState& state) const;
    void restore(const Saved& saved);

  private:
    struct Late {
        std::vector<uint32_t> counters;
    };
    void readCounts();
    void writeSinks(const std::vector<SinkParams>& sinks);
    void writeAttributes();
    void dropUnfit(const World& world);
    uint64_t meshesHash() const;

    Device* device_ = nullptr;
    bool matter_ = false, absorption_ = false;
    float spacing_ = 0;
    std::vector<EmitterFeed> feeds_;  // of the emitters; behind them that of what is poured, if others do
    bool deposits_ = false;
    std::vector<uint32_t> reported_;  // per emitter: refusals that its feed has counted; wraps around with the counters
    size_t sinkCount_ = 0;
    std::vector<AttributeParams> attributes_;  // of the world
    std::vector<Buffer> emittedAttributes_;    // of each: the value of each feed's particles
    Kernel emit_, emitAttribute_, drain_, forget_;
    Buffer candidates_, sinks_, counters_;
    std::vector<Candidate> list_;
    double waited_ = 0;  // s since emitters last ran
    std::shared_ptr<Late> late_;
};

}  // namespace rivulet
