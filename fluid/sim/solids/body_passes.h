// The passes of a step that know bodies: where their samples are, and what the fluid does to them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// The bodies of a world, on its Device. In a substep: place, sort, index, then push as often as the method says, and advance.
class BodyPasses {
  public:
    // Error (badInput): a body without samples, not finite, with mass but no inertia, half a host; (failed): out of memory. `host` empty:
    // they move freely.
    static Result<BodyPasses> create(Device& device, std::span<const Body> bodies, const BodyHost& host, const FluidParams& params,
                                     const PairTraits& traits);

    // What depends on how many slots of particles there are, samples with them. Error: out of memory.
    Status allocate(uint32_t slots);

    bool any() const { return !states_.empty(); }
    uint32_t sampleCount() const { return sampleCount_; }
    // Whether a particle may be spawned at `p`: outside of every body, and not nearer than it would rest.
    bool maySpawn(const vec3& p, float spacing, float near = 1) const;  // `near` as of SolidPasses
    // What Particles::matterOf holds of the samples.
    std::vector<vec4> matter() const;

    const std::vector<BodyState>& states() const { return states_; }
    const std::vector<BodyLoad>& loads() const { return loads_; }  // of the last substep
    // m/s, of the fastest point of any body.
    float fastest() const;

    // Writes positionNext and velocityNext of the samples, wherever they are sorted.
    void place(const StepParams& step, Particles& particles);
    // After the sort.
    void index(const StepParams& step, const NeighborGrid& grid, Particles& particles);
    // As StepContext::pushSamples.
    void push(const StepParams& step, const NeighborGrid& grid, Particles& particles, const Buffer& position, const Buffer& pressures,
              float scale, const vec3& weight);
    // Sums the forces, waits for them (some KB: on a GPU that is one round trip a substep) and has the host move the bodies.
    void advance(const StepParams& step, Particles& particles, double seconds);
    // The body whose host last gave a state that is not finite: it stayed where it was.
    std::optional<size_t> misled() const { return misled_; }
    // Back to t = 0.
    void reset();

    // Poses of bodies, their pending loads, and the state of their host.
    struct Saved {
        std::vector<BodyState> states;
        std::vector<BodyLoad> loads;
        std::vector<std::byte> host;
    };
    // Error (failed): the host remembers something, and does not say what.
    Status savable() const;
    void save(WorldState& state) const;
    // Error: as WorldState::take; other bodies, or what no body can be.
    Result<Saved> take(WorldState& state) const;
    // Error (badInput), by the host; then nothing has changed.
    Status restore(const Saved& saved);

  private:
    uint64_t shapesHash() const;

    Device* device_ = nullptr;
    std::vector<Body> bodies_;
    std::vector<BodyState> states_;
    std::vector<BodyLoad> loads_;
    std::optional<size_t> misled_;
    std::vector<float> reach_;  // m, of each body's farthest sample
    BodyLoads filter_{{}, FluidParams{}};
    std::shared_ptr<FreeBodies> free_;  // where there is no other host
    BodyHost host_;
    uint32_t sampleCount_ = 0;
    std::vector<float> volumes_;  // of each sample, over spacing^3
    std::vector<DeviceBody> uploaded_;
    Buffer own_, arm_, slotOf_, wet_, rows_, deviceBodies_;
    Kernel place_, index_, wetSamples_, push_, sumLoads_;
    bool friction_ = false;
};

}  // namespace rivulet
