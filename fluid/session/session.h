// Session: a scene that runs. Its solids (SceneSolids), its sources (SceneSources), a FluidWorld on a Device and skins are stepped
// together. The window, headless runs, benchmarks and tests share it.
#pragma once

#include <memory>
#include <optional>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/skin_flows.h"
#include "fluid/session/budget.h"
#include "fluid/session/opening_progress.h"
#include "fluid/session/replay.h"
#include "fluid/session/scene_solids.h"
#include "fluid/session/scene_sources.h"
#include "fluid/session/snapshot_keeper.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

inline constexpr int kFramesPerSecond = 60;  // of simulated time, where a scene is not in slow motion
// Simulated time from picture to picture, s.
inline double frameSeconds(const SceneFile& scene) { return double{scene.timeScale} / kFramesPerSecond; }

class Session {
  public:
    // `device` must outlive the session. A scene's budget is opened first: scene() then has the values that it picked. Error (badInput): a
    // mesh is missing, unreadable or not finite; values contradict each other. Error (failed): out of memory; `steps` cancelled it.
    static Result<std::unique_ptr<Session>> create(SceneFile scene, Device& device, const Log& log, const OpeningSteps& steps = {});

    const SceneFile& scene() const { return scene_; }
    FluidWorld& world() { return *world_; }
    const FluidWorld& world() const { return *world_; }
    const std::optional<Budget>& budget() const { return budget_; }
    const VoxelField& field() const { return solids_.stillField(); }  // of the static mesh colliders; empty = none
    SolidFields fields() const { return solids_.fields(); }
    const Scene& solids() const { return solids_.nodes(); }  // nodes of colliders, bodies and skins, to be drawn
    SkinFlows& flows() { return flows_; }
    const SkinFlows& flows() const { return flows_; }
    Bounds bounds() const;  // the fluid's box and the solids, m, world

    // Whether `scene` needs a new session: a collider moves, deforms or stands still where it did not before, or counts differ.
    bool needsNew(const SceneFile& scene) const;
    // Takes over values that may change between steps; `fixed` ones need a new Session. Values that a budget picked stay.
    void apply(const SceneFile& scene);

    // One frame. Returns ms of wall time: with `wait`, until the device has finished; without, of the call alone. `deviceMs`: as of
    // FluidInputs. A budget may pick other values: scene() then has them, and the log reports it.
    double step(double seconds, bool wait, double deviceMs = 0) {
        work(seconds, wait, deviceMs);
        return settle();
    }
    // The same in two parts. If canStepInBackground(), work() may run on another thread while this one draws what was uploaded before: it
    // changes nothing that drawing reads. Until it returns, no other function of the session may be called.
    void work(double seconds, bool wait, double deviceMs = 0);
    double settle();
    // Whether the last step was interrupted (FluidWorld::interrupted), in the water or on the skins. What it shows may be of neither the
    // state before nor that after the step. Steps then do nothing until reset() or restore().
    bool interrupted() const { return interrupted_; }
    bool canStepInBackground() const;  // on the cpu, without skins and deforming clips: these are drawn from buffers that a step writes
    void reset();

    using Thing = SceneThing;
    Thing thingOf(size_t node) const { return solids_.thingOf(node); }  // that a node of solids() belongs to; none: a skin's
    std::optional<MetThing> meet(const vec3& origin, const vec3& direction) const { return solids_.meet(origin, direction); }
    // m, world, as drawn now; of an emitter or sink, from the scene's values.
    Bounds boundsOf(const Thing& thing) const { return solids_.boundsOf(scene_, thing); }
    // Pulls at a body (solids_bullet.h). Nothing: ends.
    void hold(const std::optional<BodyPull>& hand) { solids_.hold(hand); }
    // FluidInputs::mostMs of the next steps.
    void limitFrames(double ms) { mostMs_ = ms; }
    // From the next step on the jet of scene().pour falls on that point (m, world); nothing: it stops. No effect where pour.litres is 0 or
    // a recording is shown.
    void pourOnto(const std::optional<vec3>& place);

    // Continues on another device after the first is out of memory or lost: from the first's state, or from the last snapshot, which a
    // session on cl takes at intervals. world().time() is then the time it continues from. Error (failed): out of memory; the session is
    // then unusable. On the cpu fluid.grid linked_list, which needs a GPU, becomes sorted.
    Status moveTo(Device& device);
    void hold(std::unique_ptr<Device> device) { held_ = std::move(device); }  // keeps it as long as itself: of a move that failed

    // From now on a step shows the recording's next frame instead of simulating; seek() chooses it, reset() restarts. The world does not
    // change. Error (badInput): the recording has other moving solids.
    Status replay(Replay replay);
    void endReplay();                                                                 // shows and simulates the world again, where it was
    const Replay* replaying() const { return replay_ ? &*replay_ : nullptr; }         // null: it simulates
    Status replayed() const { return replay_ ? replay_->status() : ok(); }            // Error: the last frame is damaged
    void seek(size_t frame) { replay_->seek(frame); }                                 // while replaying
    double time() const { return replay_ ? replay_->shown().time : world_->time(); }  // s simulated, of what is shown
    // Places of moving solids; waits for those of bodies.
    void placesInto(RecordedFrame& frame) const {
        solids_.placesInto(frame, replaying() != nullptr ? std::span<const BodyState>() : world().bodies());
    }

    // The world and the angles of spinning solids. Error: as FluidWorld::restore; nothing has changed then.
    void save(WorldState& state);
    Status restore(WorldState& state);

    // Whether the water of a session of `before` can continue in one of `after`: fixed fluid values are equal.
    static bool sameWater(const SceneFile& before, const SceneFile& after);
    // Continues with another session's water and time (FluidWorld::continueFrom); skins start again. Error: as there, or a recording is
    // shown; then the session is at its start.
    Status continueFrom(Session& other);

  private:
    Session() = default;
    void report(const Status& status) const;  // logs an error
    Status makeWorld(Device& device, const FluidParams& params, const Log& log, const StartProgress& progress = {});
    bool anyMoves() const { return solids_.anyMoves() || !flows_.empty(); }
    void advance(double seconds, double deviceMs);
    void watchBudget(double ms, double seconds);
    void toStart();  // the solids alone
    void takeSnapshot() { snapshots_.take(*world_, solids_, flows_); }
    std::optional<uint32_t> moreRoom(const WorldState& state) const;
    Status remake(uint32_t least);
    Status restoreWorld(WorldState& state);

    SceneFile scene_;
    Log log_;
    std::optional<Budget> budget_;
    SceneSolids solids_;
    std::unique_ptr<Device> held_;
    SceneSources sources_;
    std::unique_ptr<FluidWorld> world_;
    SkinFlows flows_;
    std::optional<Replay> replay_;
    struct Worked {
        double ms = 0, seconds = 0, costMs = 0;  // wall; simulated; as a budget counts it
    } worked_;
    SnapshotKeeper snapshots_;
    double mostMs_ = 0;  // FluidInputs::mostMs
    bool interrupted_ = false;
};

}  // namespace rivulet
