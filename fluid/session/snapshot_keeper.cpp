#include "fluid/session/snapshot_keeper.h"

#include <chrono>
#include <utility>

#include "fluid/session/scene_solids.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

constexpr double kShare = 0.01;  // of what steps take

}  // namespace

bool SnapshotKeeper::isDue() const { return steppedMs_ * kShare >= snapshotMs_; }

void SnapshotKeeper::take(FluidWorld& world, const SceneSolids& solids, const SkinFlows& flows) {
    const Device& device = world.device();
    if (device.health().state == DeviceHealth::lost || !world.savable()) return;
    const auto start = std::chrono::steady_clock::now();
    Snapshot now;
    now.turned = solids.turned();
    world.save(now.world);
    now.flows = flows.save();
    if (device.health().state == DeviceHealth::lost) return;  // what was read is nothing
    last_ = std::move(now);
    steppedMs_ = 0;
    snapshotMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void SnapshotKeeper::forget() {
    last_.reset();
    steppedMs_ = snapshotMs_ = 0;
}

SnapshotKeeper::Snapshot SnapshotKeeper::release() {
    Snapshot snapshot = std::move(*last_);
    last_.reset();
    return snapshot;
}

}  // namespace rivulet
