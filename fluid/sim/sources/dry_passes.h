// The pass of a step that keeps volumes dry (dry.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/dry.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

class DryPasses {
  public:
    // Error (failed): out of memory. Nothing the second time.
    Status prepare(Device& device);
    // Sound volumes, of passes that were prepared. `ids`, `starts`, `bodies`: as DryBodies.
    void set(std::span<const DryParams> volumes, std::vector<uint32_t> ids, std::vector<Pose> starts, std::span<const BodyState> bodies);
    void bodiesChanged(std::vector<uint32_t> ids, std::vector<Pose> starts);  // those of params() are still there
    bool any() const { return !params_.empty(); }
    const std::vector<DryParams>& params() const { return params_; }
    const std::vector<DryVolume>& volumes() const { return volumes_; }  // where they last were
    // After a substep: moves the volumes with the bodies, and removes the particles inside. `remembered`: of the method.
    void run(const StepParams& step, const Buffer& cellStart, Particles& particles, std::span<const BodyState> bodies,
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
    Buffer places_, counter_;
    std::shared_ptr<uint32_t> removed_ = std::make_shared<uint32_t>(0);
};

}  // namespace rivulet
