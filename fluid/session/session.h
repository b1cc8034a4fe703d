// Session: a scene brought to life. Meshes imported and placed, their voxels baked, a FluidWorld made on a Device, solids and bodies moved.
// The window, headless runs, benches and tests share it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/scene/scene.h"
#include "fluid/scene/collider_model.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/skin_flows.h"
#include "fluid/scene/solids_bullet.h"
#include "fluid/session/budget.h"
#include "fluid/session/replay.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/voxel/deforming_field.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

inline constexpr int kFramesPerSecond = 60;  // of simulated time, where a scene is not in slow motion
// Simulated time from picture to picture, s.
inline double frameSeconds(const SceneFile& scene) { return double{scene.timeScale} / kFramesPerSecond; }

// The voxels of a scene's meshes. Pointers hold as long as the session.
struct SolidFields {
    const VoxelField* still = nullptr;     // of all meshes that stand still; null = none
    std::vector<const VoxelField*> rigid;  // each in its own frame: FluidWorld::poses() has the frames
    std::vector<const VoxelField*> deforming;
    // One of them: that of what stands still, if there is one. null: there is no mesh.
    const VoxelField* first() const {
        return still != nullptr ? still : !rigid.empty() ? rigid[0] : !deforming.empty() ? deforming[0] : nullptr;
    }
};

// Told what is done next ("voxels of rocks.obj") and which share of all is done, 0..1. false: it is given up.
using OpeningSteps = std::function<bool(const std::string& next, double share)>;

class Session {
  public:
    // `device` must outlive the session. A scene's budget is opened first: scene() is then what it picked. Error (badInput): a mesh is
    // missing, unreadable or not finite; values that make no sense together. Error (failed): out of memory; `steps` gave up.
    static Result<std::unique_ptr<Session>> create(SceneFile scene, Device& device, const Log& log, const OpeningSteps& steps = {});

    const SceneFile& scene() const { return scene_; }
    FluidWorld& world() { return *world_; }
    const FluidWorld& world() const { return *world_; }
    const std::optional<Budget>& budget() const { return budget_; }
    const VoxelField& field() const { return field_; }  // of the mesh colliders that stand still; empty = none
    SolidFields fields() const;
    const Scene& solids() const { return solids_; }  // the visible colliders, to be drawn
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

    // What of the scene a ray meets first (m, world), of what is drawn.
    struct Thing {
        enum class Kind { none, collider, body, emitter, sink } kind = Kind::none;
        size_t index = 0;  // in the scene
        bool operator==(const Thing&) const = default;
    };
    struct Met {
        Thing thing;
        vec3 place{0.0F}, normal{0.0F};  // m; unit, towards where the ray came from
    };
    Thing thingOf(size_t node) const;  // of solids(): whose it is; none: a skin's
    std::optional<Met> meet(const vec3& origin, const vec3& direction) const;
    Bounds boundsOf(const Thing& thing) const;  // m, world, as it is drawn now; of an emitter or sink, what the scene says
    // A hand at a body (solids_bullet.h), until it lets go (nothing).
    void hold(const std::optional<BulletSolids::Hold>& hand);
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
    const Status& replayed() const { return replayed_; }                              // Error: the last step's frame is damaged
    void seek(size_t frame) { replay_->seek(frame); }                                 // while replaying
    double time() const { return replay_ ? replay_->shown().time : world_->time(); }  // s simulated, of what is shown
    void placesInto(RecordedFrame& frame) const;                                      // where the solids that move are

    // The world and what the session knows of its solids. Error: as FluidWorld::restore; all is then as it was.
    void save(WorldState& state);
    Status restore(WorldState& state);

    // Whether the water of a session of `before` may go on in one of `after`: only things in it, emitters and the look are others.
    static bool sameWater(const SceneFile& before, const SceneFile& after);
    // Goes on with another session's water and at its time (FluidWorld::goOnFrom); skins begin anew. Error: as there, or it is replaying;
    // then the session is at its start.
    Status goOnFrom(Session& other);

  private:
    void told(const Status& status) const;  // what went wrong with a slider, to the person

    struct Rigid {
        size_t collider = 0, model = 0;
        std::unique_ptr<VoxelField> field;
        double turned = 0;  // deg
    };
    struct Deforming {
        size_t collider = 0, model = 0;
        std::unique_ptr<DeformingField> field;
        std::vector<vec3> rest, shape;
    };

    // What moveTo goes on from.
    struct Snapshot {
        WorldState world;
        std::vector<double> turned;
        std::shared_ptr<const SkinFlows::Snapshot> flows;
    };

    Session() = default;
    void takeSnapshot();
    Status next(const std::string& what);
    Status makeWorld(Device& device, const FluidParams& params, const Log& log);
    Status importColliders();
    Result<Sources> importEmitters() const;
    Sources sourcesNow() const;
    Status bake(const Log& log);
    Status addBodies(Solids& solids);
    Result<VoxelField> bakeMeshes(std::span<const MeshView> views, std::span<const uint8_t> surfaces, float edge, const Log& log) const;
    VoxelFieldOptions fieldOptions(const Bounds& bounds, float edge) const;
    float voxelEdge(const ColliderParams& collider, const Bounds& bounds, const Log& log) const;
    bool anyMoves() const;
    void advance(double seconds, double deviceMs);
    void bend(Deforming& deforming, double time);
    std::optional<uint32_t> moreRoom(const WorldState& state) const;
    Status remake(uint32_t least);
    Status restoreWorld(WorldState& state);
    Pose poseOf(size_t model, double time, double turned) const;
    Node& nodeOf(size_t model) { return solids_.nodes()[models_[model].node()]; }
    const Node& nodeOf(size_t model) const { return solids_.nodes()[models_[model].node()]; }
    void bendNode(const Deforming& deforming, std::span<const vec3> positions);
    void placeModels();
    void placeNodes();
    void startSolids();
    void placeRecorded();
    void watchBudget(double ms, double seconds);

    SceneFile scene_;
    Log log_;
    OpeningSteps steps_;             // while it is made
    int step_ = 0, stepsInAll_ = 1;  // of those
    std::optional<Budget> budget_;
    std::unique_ptr<Device> bender_;  // a cpu, of models with bones and morphs, whichever device the world is on
    Scene solids_;
    std::vector<ColliderModel> models_;  // of the mesh colliders, in the order of the scene
    std::vector<size_t> colliderOf_;     // of each model
    std::vector<uint8_t> surfaceOf_;     // of each collider
    VoxelField field_;
    std::vector<Rigid> rigid_;
    std::vector<size_t> shown_;  // models that move as a whole, but are only drawn
    std::vector<Deforming> deforming_;
    std::vector<size_t> bodyNodes_;           // of each body
    std::unique_ptr<BulletSolids> contacts_;  // null: there are no bodies
    std::unique_ptr<Device> held_;
    Solids given_;                    // what the world was made among
    Sources sources_;                 // and with
    std::optional<vec3> pouredOnto_;  // m, by a hand
    std::unique_ptr<FluidWorld> world_;
    SkinFlows flows_;
    std::optional<Replay> replay_;
    Status replayed_ = ok();
    struct Worked {
        double ms = 0, seconds = 0, costMs = 0;  // on the wall; simulated; what a budget counts
    } worked_;
    std::optional<Snapshot> kept_;  // nothing: the start
    double steppedMs_ = 0;          // since it was taken
    double snapshotMs_ = 0;         // what it took
};

}  // namespace rivulet
