// Session: a scene brought to life. Meshes imported and placed, the static field baked, a FluidWorld made on a Device. The window,
// headless runs, benches and tests share it.
#pragma once

#include <memory>
#include <string>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/scene/scene.h"
#include "fluid/bridge/scene_file.h"
#include "fluid/sim/fluid_world.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

inline constexpr int kFramesPerSecond = 60;  // of simulated time

class Session {
  public:
    // `device` must outlive the session. Error (badInput): a mesh is missing, unreadable or not finite; values that make no sense
    // together. Error (failed): out of memory.
    static Result<std::unique_ptr<Session>> create(SceneFile scene, Device& device, const Log& log);

    const SceneFile& scene() const { return scene_; }
    FluidWorld& world() { return *world_; }
    const VoxelField& field() const { return field_; }  // of all mesh colliders; empty = none
    const Scene& solids() const { return solids_; }     // the visible colliders, to be drawn
    Bounds bounds() const;                              // the fluid's box and the solids, m, world

    // Takes what may change between steps; what is `fixed` needs a new Session.
    void apply(const SceneFile& scene);

    // One frame. The wall time in ms: with `wait`, until the device has done it; without, only what the call took.
    double step(double seconds, bool wait);
    void reset() { world_->reset(); }

  private:
    Session() = default;
    Status importColliders();
    Status bake(const Log& log);

    SceneFile scene_;
    Scene solids_;
    std::vector<Mesh> meshes_;  // of the mesh colliders, in the world
    VoxelField field_;
    std::unique_ptr<FluidWorld> world_;
};

}  // namespace rivulet
