// SnapshotKeeper: the last snapshot of a session, from which it continues when its device is lost. Taking them costs a hundredth of what
// steps cost.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fluid/scene/skin_flows.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

class FluidWorld;
class SceneSolids;

class SnapshotKeeper {
  public:
    struct Snapshot {
        WorldState world;
        std::vector<double> turned;  // deg, of each rigid collider
        std::shared_ptr<const SkinFlows::Snapshot> flows;
    };

    void count(double stepMs) { steppedMs_ += stepMs; }
    bool isDue() const;
    // Waits for the device. The snapshot before stays where the device is lost or the world cannot be saved.
    void take(FluidWorld& world, const SceneSolids& solids, const SkinFlows& flows);
    void forget();
    const std::optional<Snapshot>& last() const { return last_; }  // nothing: the start
    Snapshot release();                                            // last() leaves

  private:
    std::optional<Snapshot> last_;
    double steppedMs_ = 0;   // since it was taken
    double snapshotMs_ = 0;  // what it took
};

}  // namespace rivulet
