// SkinFlows: all skins of a scene, and the drops in the air between them, the world's water and the ground. A drop that comes down on the
// world's water is poured into it; a particle of the world that comes down on a skin becomes drops. One mass: a ledger in picolitres.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "fluid/scene/flow_component.h"
#include "fluid/sim/world/fluid_world.h"

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
    // m^3: emitted + taken = onSurface + inAir + evaporated + drained + poured. Waits for the device.
    struct Ledger {
        double emitted = 0, taken = 0, onSurface = 0, inAir = 0, evaporated = 0, drained = 0, poured = 0;
        double error = 0;  // what is missing
    };
    Ledger ledger() const;
    // The same without waiting: as SurfaceFlow::ledgerLater. Not of no skins.
    void ledgerLater(const std::function<void(const Ledger&)>& then) const;
    size_t inAir() const { return air_.size(); }
    std::vector<vec4> airDrops() const;  // as FluidView::drops
    // What skins and the world will hand to each other in `seconds`, for Sources::expectedDeposit, m^3. 0: the scene has no skins, or no water
    // beside.
    static double expectedPoured(const SceneFile& scene, double seconds);

    // Where they were, with what is in the air.
    struct Snapshot;
    std::shared_ptr<const Snapshot> save() const;  // waits
    // All anew on another device, from there on; null: from the start. Error: as create.
    Status moveTo(Device& device, SceneFile scene, Scene& nodes, const Log& log, const Snapshot* from);

    // The point of a skin that a ray through the world meets first, and a drop put there. false: it meets none.
    bool drip(const dvec3& from, const dvec3& way, uint32_t picolitres);

  private:
    struct First {
        FlowComponent* skin = nullptr;
        SkinSearch::Hit where;
    };
    // Picolitres, in all.
    struct Counted {
        uint64_t emitted = 0, taken = 0, surface = 0, air = 0, evaporated = 0, drained = 0, refused = 0, poured = 0;
        void add(const SurfaceFlow::Ledger& own);
        Ledger ledger() const;
    };
    Counted counted() const;  // all but what SurfaceFlow::Ledger says
    First firstOn(const dvec3& from, const dvec3& to, double then) const;
    bool hasRoom(const FlowComponent* skin, uint32_t count = 1);
    void takeLanding(const SceneFile& scene, FluidWorld& world, double seconds);
    Status fall(const SceneFile& scene, FluidWorld& world, double seconds);

    std::vector<std::unique_ptr<FlowComponent>> skins_;
    std::vector<FlowComponent::AirDrop> air_;
    std::map<const FlowComponent*, uint32_t> room_;  // drops, of those that were asked in this step
    bool pools_ = false;                             // there is water beside
    uint64_t drained_ = 0, dripped_ = 0;             // picolitres
    uint64_t poured_ = 0, taken_ = 0;                // picolitres, into the world and out of it
    uint64_t particles_ = 0;                         // taken
    size_t firstNode_ = 0;                           // of the scene's, where the skins' begin
    double time_ = 0;
    double floor_ = 0;  // m, below which a drop is gone
};

}  // namespace rivulet
