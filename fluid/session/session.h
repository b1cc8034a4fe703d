// Session: a scene brought to life. Meshes imported and placed, their voxels baked, a FluidWorld made on a Device, solids and bodies moved.
// The window, headless runs, benches and tests share it.
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
    // `device` must outlive the session. A scene's budget is opened first: scene() is then what it picked. Error (badInput): a mesh is
    // missing, unreadable or not finite; values that make no sense together. Error (failed): out of memory; `steps` gave up.
    static Result<std::unique_ptr<Session>> create(SceneFile scene, Device& device, const Log& log, const OpeningSteps& steps = {});

    const SceneFile& scene() const { return scene_; }
    FluidWorld& world() { return *world_; }
    const FluidWorld& world() const { return *world_; }
    const std::optional<Budget>& budget() const { return budget_; }
    const VoxelField& field() const { return solids_.stillField(); }  // of the mesh colliders that stand still; empty = none
    SolidFields fields() const { return solids_.fields(); }
    const Scene& solids() const { return solids_.nodes(); }  // the visible colliders, to be drawn
    SkinFlows& flows() { return flows_; }
    const SkinFlows& flows() const { return flows_; }
    Bounds bounds() const;  // the fluid's box and the solids, m, world

    // Whether a collider of `scene` moves, bends or stands still where it did not before: its voxels are of another kind then.
    bool needsNew(const SceneFile& scene) const;
    // Takes what may change between steps; what is `fixed` needs a new Session. What a budget picks stays its own.
    void apply(const SceneFile& scene);

    // One frame. The wall time in ms: with `wait`, until the device has done it; without, only what the call took.
    // `deviceMs`: as FluidInputs. A budget watches, and may pick other values: scene() has them then, and the log says so.
    double step(double seconds, bool wait, double deviceMs = 0) {
        work(seconds, wait, deviceMs);
        return settle();
    }
    // The same in two parts: the first may run on another thread while this one draws what was uploaded before, of a session that
    // mayWorkAside(): it changes nothing that drawing reads. Nothing else of the session may be called until it is done.
    void work(double seconds, bool wait, double deviceMs = 0);
    double settle();
    bool mayWorkAside() const;  // on the cpu, without skins and bending models, which are drawn from what is being stepped
    void reset();

    using Thing = SceneThing;
    Thing thingOf(size_t node) const { return solids_.thingOf(node); }  // of solids(): whose it is; none: a skin's
    std::optional<MetThing> meet(const vec3& origin, const vec3& direction) const { return solids_.meet(origin, direction); }
    // m, world, as it is drawn now; of an emitter or sink, what the scene says
    Bounds boundsOf(const Thing& thing) const { return solids_.boundsOf(scene_, thing); }
    // A hand at a body (solids_bullet.h), until it lets go (nothing).
    void hold(const std::optional<BulletSolids::Hold>& hand) { solids_.hold(hand); }
    // Water falls from a hand onto that place (m, world) from the next step on; nothing: no more does. Where scene().pour has no room for
    // any, or what is shown was recorded, none falls.
    void pourOnto(const std::optional<vec3>& place);

    // Goes on on another device, in the place of one that is full or lost: from what that one holds, or else from the last snapshot, which
    // a session on cl takes of itself now and then. time() of the world says from when on. Error (failed): out of memory; the session
    // is then of no more use. On the cpu fluid.grid linked_list, which it does not know, becomes sorted.
    Status moveTo(Device& device);
    void hold(std::unique_ptr<Device> device) { held_ = std::move(device); }  // as long as itself: of a move that failed half way

    // From now on a step shows the recording's next frame instead of simulating; seek() says which, reset() begins anew. The world stays
    // as it is. Error (badInput): the solids that move are others.
    Status replay(Replay replay);
    const Replay* replaying() const { return replay_ ? &*replay_ : nullptr; }         // null: it simulates
    Status replayed() const { return replay_ ? replay_->status() : ok(); }            // Error: the last step's frame is damaged
    void seek(size_t frame) { replay_->seek(frame); }                                 // while replaying
    double time() const { return replay_ ? replay_->shown().time : world_->time(); }  // s simulated, of what is shown
    void placesInto(RecordedFrame& frame) const { solids_.placesInto(frame); }        // where the solids that move are

    // The world and what the session knows of its solids. Error: as FluidWorld::restore; all is then as it was.
    void save(WorldState& state);
    Status restore(WorldState& state);

    // Whether the water of a session of `before` may go on in one of `after`: only things in it, emitters and the look are others.
    static bool sameWater(const SceneFile& before, const SceneFile& after);
    // Goes on with another session's water and at its time (FluidWorld::goOnFrom); skins begin anew. Error: as there, or it is replaying;
    // then the session is at its start.
    Status goOnFrom(Session& other);

  private:
    Session() = default;
    void notify(const Status& status) const;  // the person, of what went wrong with a slider
    Status makeWorld(Device& device, const FluidParams& params, const Log& log);
    bool anyMoves() const { return solids_.anyMoves() || !flows_.empty(); }
    void advance(double seconds, double deviceMs);
    void watchBudget(double ms, double seconds);
    void toStart();  // solids, of a world that is there
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
        double ms = 0, seconds = 0, costMs = 0;  // on the wall; simulated; what a budget counts
    } worked_;
    SnapshotKeeper snapshots_;
};

}  // namespace rivulet
