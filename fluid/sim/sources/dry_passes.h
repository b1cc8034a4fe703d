// The pass of a step that keeps volumes dry (dry.h).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/solids/body_states.h"
#include "fluid/sim/sources/dry.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

class DryPasses {
  public:
    // Creates what `volumes` need and is not there yet. Error (failed): out of memory.
    Status prepare(Device& device, std::span<const DryParams> volumes);
    // Sound volumes, for which the passes were prepared. `ids`, `starts`, `bodies`: as DryBodies.
    void set(std::span<const DryParams> volumes, std::vector<uint32_t> ids, std::vector<Pose> starts, std::span<const BodyState> bodies);
    void bodiesChanged(std::vector<uint32_t> ids, std::vector<Pose> starts);  // those of params() are still there
    bool any() const { return !params_.empty(); }
    bool anyCarried() const;  // with a body
    const std::vector<DryParams>& params() const { return params_; }
    const std::vector<DryVolume>& volumes() const { return volumes_; }  // where they last were, by the states of the bodies
    std::vector<DryVolume> own() const;                                 // ownDry
    void place(std::span<const BodyState> bodies);
    // After a substep: moves the volumes with the bodies, and removes the particles inside. `rows`: where these are current, the bodies are
    // there, and `bodies` only about so. `remembered`: of the method.
    void run(const StepParams& step, const Buffer& cellStart, Particles& particles, std::span<const BodyState> bodies, const BodyRows& rows,
             std::span<const NamedBuffer> remembered);
    void report();             // requests the count, which arrives late on a GPU
    uint64_t removed() const;  // particles since reset(), by the last count that arrived
    void reset(std::span<const BodyState> bodies);

  private:
    Device* device_ = nullptr;
    std::vector<DryParams> params_;
    std::vector<uint32_t> ids_;
    std::vector<Pose> starts_;
    std::vector<DryVolume> volumes_;
    Kernel dry_, forget_;
    std::optional<Kernel> dryOfRows_;  // of a GPU that moves bodies
    Buffer places_, counter_;
    std::shared_ptr<uint32_t> removed_ = std::make_shared<uint32_t>(0);
};

}  // namespace rivulet
