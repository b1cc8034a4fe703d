// SceneSolids: the colliders and bodies of a scene that runs. Their meshes and nodes, their voxels, where they are at a time, and what a
// ray or a hand meets of them. A FluidWorld is made among ofWorld().
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/scene/scene.h"
#include "fluid/scene/collider_model.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/solids_bullet.h"
#include "fluid/session/opening_progress.h"
#include "fluid/sim/solids/solids.h"
#include "fluid/voxel/deforming_field.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

class FluidWorld;
struct RecordedFrame;
struct WetSurface;

// The voxels of a scene's meshes. Pointers hold as long as the session.
struct SolidFields {
    const VoxelField* still = nullptr;     // of all static meshes; null = none
    std::vector<const VoxelField*> rigid;  // each in its own frame: FluidWorld::poses() has the frames
    std::vector<const VoxelField*> deforming;
    // The static one, else the first of the others; null: there is no mesh.
    const VoxelField* first() const {
        return still != nullptr ? still : !rigid.empty() ? rigid[0] : !deforming.empty() ? deforming[0] : nullptr;
    }
};

// An object of a scene that a person can select.
struct SceneThing {
    enum class Kind { none, collider, body, emitter, sink } kind = Kind::none;
    size_t index = 0;  // in the scene
    bool operator==(const SceneThing&) const = default;
};
// The first hit of a ray on what is drawn.
struct MetThing {
    SceneThing thing;
    vec3 place{0.0F}, normal{0.0F};  // m, world; unit, towards the ray's origin
};

class SceneSolids {
  public:
    SceneSolids() = default;
    SceneSolids(const SceneSolids&) = delete;  // the world and Bullet hold pointers into it
    SceneSolids& operator=(const SceneSolids&) = delete;

    // Once. Reads and bakes all colliders and bodies; a camera or light that comes from a file is set in `scene`. Error (badInput): as
    // Session::create.
    Status create(SceneFile& scene, const Log& log, OpeningProgress& progress);

    const Solids& ofWorld() const { return solids_; }
    const Scene& nodes() const { return nodes_; }  // to be drawn; skins add theirs
    Scene& nodes() { return nodes_; }
    const VoxelField& stillField() const { return still_; }
    SolidFields fields() const;
    bool anyMoves() const;
    bool bendsAsDrawn() const;  // some are drawn from the buffers that the world updates
    // One a collider, of `scene` with as many colliders.
    static std::vector<Surface> surfaces(const SceneFile& scene);
    // Whether a collider or body of `scene` moves, bends or stands still where it did not before, or has another surface.
    bool needsNew(const SceneFile& before, const SceneFile& scene) const;
    void apply(const SceneFile& scene);  // looks alone: nodes' materials

    // Where the solids are at world time `time` (s), `ahead` s after the angles that advance() has counted. The shapes are held here.
    struct Motion {
        std::vector<Pose> poses;
        std::vector<std::span<const vec3>> shapes;
        std::vector<Pose> contacts;  // of all that move and bodies can meet: first those of poses
    };
    Motion motionAt(const SceneFile& scene, double time, double ahead);
    void moveContacts(const Motion& motion, double seconds);  // as BulletSolids::moveTo
    void advance(const SceneFile& scene, double seconds);     // counts angles on, when the world has stepped
    void toStart(const FluidWorld& world);                    // with a world that is at its start
    Status rest();                                            // deforming voxels as they were when the world was made

    std::vector<double> turned() const;  // deg, of each rigid collider
    void setTurned(std::span<const double> turned);
    // Angles of colliders with the same number and file. `before`, `scene`: of `other` and of this.
    void setTurned(const SceneFile& scene, const SceneSolids& other, const SceneFile& before);

    // Nodes go where `world` has its solids, those of bodies where it expects them.
    void placeNodes(const SceneFile& scene, const FluidWorld& world);
    // Or where a recorded frame has them: those places, and how many a frame must have.
    // `bodies`: their states; empty: as the nodes show them, which on a GPU may be expected ones.
    void placesInto(RecordedFrame& frame, std::span<const BodyState> bodies) const;
    void placeNodes(const SceneFile& scene, const RecordedFrame& frame);
    bool fits(const RecordedFrame& frame) const;
    size_t recordedPlaces() const { return rigid_.size() + bodyNodes_.size(); }
    size_t recordedCorners() const;

    SceneThing thingOf(size_t node) const;
    std::optional<MetThing> meet(const vec3& origin, const vec3& direction) const;
    Bounds boundsOf(const SceneFile& scene, const SceneThing& thing) const;
    void hold(const std::optional<BodyPull>& hand);
    bool hasBodies() const { return contacts_ != nullptr; }

  private:
    // How water meets a model. Decided by roleOf alone.
    enum class Role { still, rigid, deforming, drawn, dry };  // dry: bodies alone can meet it
    struct Rigid {
        size_t model = 0;
        std::unique_ptr<VoxelField> field;
        double turned = 0;  // deg
    };
    struct Deforming {
        size_t model = 0;
        std::unique_ptr<DeformingField> field;
        std::vector<vec3> rest, shape;
    };

    Status importColliders(SceneFile& scene, const Log& log, OpeningProgress& progress);
    Role roleOf(const SceneFile& scene, size_t model) const;
    Status bake(const SceneFile& scene, const Log& log, OpeningProgress& progress);
    Status addBodies(const SceneFile& scene);
    size_t addBodyNodes(const BodyParams& params, const Pose& pose, Mesh mesh, std::vector<Mesh> parts);
    const ColliderParams& paramsOf(const SceneFile& scene, size_t model) const { return scene.colliders[colliderOf_[model]]; }
    Pose poseOf(const SceneFile& scene, size_t model, double time, double turned) const;
    Node& nodeOf(size_t model) { return nodes_.nodes()[models_[model].node()]; }
    const Node& nodeOf(size_t model) const { return nodes_.nodes()[models_[model].node()]; }
    void wetNodes(const WetSurface* surface);
    void bendNode(const Deforming& deforming, std::span<const vec3> positions);
    void placeModels(const SceneFile& scene, double time);

    std::unique_ptr<Device> bender_;  // a cpu, for models with bones and morph targets, whatever the world's device
    Scene nodes_;
    std::vector<ColliderModel> models_;  // of the colliders with triangles, in the order of the scene
    std::vector<size_t> colliderOf_;     // of each model
    std::vector<uint8_t> surfaceOf_;     // of each collider
    VoxelField still_;
    std::vector<Rigid> rigid_;
    std::vector<size_t> shown_;  // models that move rigidly and are drawn, but the water does not meet them
    std::vector<size_t> dry_;    // those of them that bodies can meet
    std::vector<Pose> dryStart_;
    std::vector<Deforming> deforming_;
    std::vector<size_t> bodyNodes_;           // of each body
    std::unique_ptr<BulletSolids> contacts_;  // null: there are no bodies
    Solids solids_;
};

}  // namespace rivulet
