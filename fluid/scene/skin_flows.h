// SkinFlows: all skins of a scene, and the drops in the air between them, the world's water and the ground (AirDrops). One mass: a ledger.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "fluid/flow/air_drops.h"
#include "fluid/scene/flow_component.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

struct SceneFile;

class SkinFlows {
  public:
    Status create(const SceneFile& scene, Device& device, Scene& nodes, const Log& log);
    bool empty() const { return skins_.empty(); }
    bool needsNew(const SceneFile& scene) const;
    void apply(const SceneFile& scene, Scene& nodes);
    // Restarts. Error: as create.
    Status reset(const SceneFile& scene, Device& device, Scene& nodes, const Log& log);

    // Advances by a frame of `seconds` (simulated), after the world's step. Error (failed): out of memory.
    Status step(const SceneFile& scene, FluidWorld& world, double seconds, Scene& nodes);
    // The maps, for drawing. Needs a current OpenGL context.
    Status draw();

    std::vector<std::unique_ptr<FlowComponent>>& skins() { return skins_; }
    // m^3: emitted + taken = onSurface + inAir + evaporated + drained + poured. Waits for the device.
    struct Ledger {
        double emitted = 0, taken = 0, onSurface = 0, inAir = 0, evaporated = 0, drained = 0, poured = 0;
        double error = 0;  // the imbalance
    };
    Ledger ledger() const;
    // The same without waiting, as SurfaceFlow::ledgerLater. There must be a skin.
    void ledgerLater(const std::function<void(const Ledger&)>& then) const;
    size_t inAir() const { return air_.drops().size(); }
    std::vector<vec4> airDrops() const { return air_.drawn(); }  // as FluidView::drops
    std::vector<vec4> pendants() const;                          // as FluidView::pendants
    // m^3 that skins may pour into the world in `seconds`, for Sources::expectedDeposit. 0: the scene has no skins or no water.
    static double expectedDeposit(const SceneFile& scene, double seconds);

    // The state of the skins and of the drops in the air.
    struct Snapshot;
    std::shared_ptr<const Snapshot> save() const;  // waits
    // Creates all on another device, from that state; null: from the start. Error: as create.
    Status moveTo(Device& device, SceneFile scene, Scene& nodes, const Log& log, const Snapshot* from);

    // Puts a drop on the first skin that a ray through the world meets. false: it meets none.
    bool drip(const dvec3& from, const dvec3& way, uint32_t picolitres);

  private:
    // Picolitres, in all.
    struct Counted {
        uint64_t emitted = 0, taken = 0, surface = 0, air = 0, evaporated = 0, drained = 0, refused = 0, poured = 0;
        void add(const SurfaceFlow::Ledger& own);
        Ledger ledger() const;
    };
    Counted counted() const;  // all but the flows' own ledgers

    std::vector<std::unique_ptr<FlowComponent>> skins_;
    std::vector<PlacedFlow*> placed_;  // of skins_
    AirDrops air_;
    bool pools_ = false;    // the scene has water, too
    uint64_t dripped_ = 0;  // picolitres
    size_t firstNode_ = 0;  // the first of the skins' nodes in the scene
    double time_ = 0;
    double floor_ = 0;  // m, below which a drop is gone
};

}  // namespace rivulet
