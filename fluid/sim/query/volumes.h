// Volumes that a game watches: how much water is in each, and how much has entered and left, step by step.
//
// Counted once at the end of each FluidWorld::step that steps, where particles then are: one that passes through within a step is not seen.
// A particle is in a volume if its centre is. Whatever begins or ends there counts too: a particle spawned in a volume has entered it; one
// that a sink or withdraw() removes, that is lost, or that reset() or restore() put elsewhere has left. Where a freed slot is filled again
// within the same step, both count as one. So `inside` is `entered` less `left`, always.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/sources/emit_params.h"

namespace rivulet {

struct Volume {
    enum Shape : uint32_t { box, sphere };
    uint32_t id = 0;  // of the host's own choice
    Shape shape = box;
    vec3 position{0.0F};   // m, its centre
    vec3 size{0.1F};       // m, of a box
    float radius = 0.05F;  // m, of a sphere
};

// Error (badInput): `what` has a position or size that is not finite or negative.
Status checkVolume(const Volume& volume, const std::string& what);
SinkVolume shapeOf(const Volume& volume);  // of a sound one

// Of one volume, in particles.
struct VolumeCount {
    uint32_t id = 0;
    uint64_t entered = 0, left = 0;
    uint64_t inside = 0;
    double time = 0;      // s simulated: of the step after which it was so
    double particle = 0;  // m^3, of each
    double volumeInside() const { return static_cast<double>(inside) * particle; }
};

class VolumePasses {
  public:
    static constexpr size_t kMost = 32;

    // Volumes of ids that were there keep their counts, wherever they are now; others begin empty. Error (badInput): too many, an id twice,
    // invalid sizes; (failed): out of memory. Then all stays as it was. `slots` of particles, `particle` m^3.
    Status set(Device& device, std::span<const Volume> volumes, uint32_t slots, double particle);
    // Of the particles as they are, at `time` (s).
    void count(const StepParams& step, const Particles& particles, double time);
    // In the order of set(), since each was; as far as is known.
    std::vector<VolumeCount> counts() const;
    // `entered` and `left` since this was last called, of those where something has.
    std::vector<VolumeCount> takeEvents();
    void reset();  // all are empty, as when they were set

    // Before save, wait for the device.
    void save(WorldState& state) const;
    struct Saved {
        std::vector<Volume> volumes;
        std::vector<uint64_t> numbers;  // 5 a volume: its bit; entered, left; of these, reported
        std::vector<double> times;
        std::vector<uint32_t> inside;
    };
    // Of a state that has none: those that are set stay, empty. Error: as WorldState::take; counts that do not add up.
    static Result<Saved> take(WorldState& state, uint32_t slots);
    // The memory for volumes of a world with so many slots: nothing the second time. Error (noMemory).
    Status prepare(Device& device, uint32_t slots);
    void restore(Device& device, const Saved& saved, double particle);  // of volumes that were prepared

  private:
    struct Row {
        VolumeCount count;
        uint64_t entered = 0, left = 0;          // reported by takeEvents
        uint32_t lastEntered = 0, lastLeft = 0;  // the device's counters when last read: they turn over
        uint64_t serial = 0;                     // unlike all others'; 0: this bit is no volume's
    };
    using Rows = std::array<Row, kMost>;  // by bit
    void write();

    Device* device_ = nullptr;
    Kernel count_;
    Buffer shapes_, inside_, counters_;
    std::vector<Volume> volumes_;
    std::vector<uint32_t> bits_;  // of each
    uint32_t keep_ = ~0U;         // bits that mean the same to particles and to volumes_
    uint64_t serial_ = 0;
    uint32_t slots_ = 0;
    std::shared_ptr<Rows> rows_ = std::make_shared<Rows>();
};

}  // namespace rivulet
