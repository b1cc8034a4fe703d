// SkinFlows: all skins of a scene, and the drops in the air between them, the pool and the ground. One mass: a ledger in picolitres.
#pragma once

#include <memory>
#include <vector>

#include "fluid/bridge/flow_component.h"
#include "fluid/sim/fluid_world.h"

namespace rivulet {

struct SceneFile;

class SkinFlows {
  public:
    Status create(const SceneFile& scene, Device& device, Scene& nodes, const Log& log);
    bool empty() const { return skins_.empty(); }
    bool needsNew(const SceneFile& scene) const;
    void apply(const SceneFile& scene);
    // Back to the start. Error: as create.
    Status reset(const SceneFile& scene, Device& device, Scene& nodes, const Log& log);

    // A frame of `seconds` simulated ones, after the world's. Error (failed): out of memory.
    Status step(const SceneFile& scene, FluidWorld& world, double seconds, Scene& nodes);
    // The maps, for drawing. Needs a current OpenGL context.
    Status draw();

    std::vector<std::unique_ptr<FlowComponent>>& skins() { return skins_; }
    // m^3, as RunStats::Ledger has it: emitted = onSurface + inAir + inWorld (of skins) + evaporated + drained. Waits for the device.
    struct Ledger {
        double emitted = 0, onSurface = 0, inAir = 0, evaporated = 0, drained = 0, error = 0;
    };
    Ledger ledger() const;
    size_t inAir() const { return air_.size(); }

    // The point of a skin that a ray through the world meets first, and a drop put there. false: it meets none.
    bool drip(const dvec3& from, const dvec3& way, uint32_t picolitres);

  private:
    void fall(const SceneFile& scene, double seconds);

    std::vector<std::unique_ptr<FlowComponent>> skins_;
    std::vector<FlowComponent::AirDrop> air_;
    uint64_t drained_ = 0, dripped_ = 0;  // picolitres
    size_t firstNode_ = 0;                // of the scene's, where the skins' begin
    double time_ = 0;
    double floor_ = 0;  // m, below which a drop is gone
};

}  // namespace rivulet
