// The passes of a step for solids: the walls near each particle, and collision.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/solids/solids.h"
#include "fluid/sim/solids/wet_surface.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/world/step_params.h"
#include "shaders/voxel/motion_params.h"

namespace rivulet {

class ProbePasses;

// The solids of a world, on its Device. Per frame: beginFrame, then a substep's advance, nearWalls, collide, each in that order.
class SolidPasses {
  public:
    // Error (badInput): a plane without direction, too many surfaces or one out of its range, a field whose band is too narrow for the
    // spacing; (failed): out of memory. `device` and the solids' fields must outlive it. Without solids and with a fully periodic box,
    // nothing is created for walls. `threads`: PairTraits::threadDefines().
    static Result<SolidPasses> create(Device& device, const Solids& solids, const FluidParams& params,
                                      std::span<const Define> threads = {});

    // Other solids in place of these; `poses`: of solids.rigid now, whose own poses are those at t = 0. A field that is here already is not
    // read again, and a deforming solid that is here keeps its shape. Error: as create; nothing has changed then.
    Status replace(const Solids& solids, std::span<const Pose> poses, const FluidParams& params, std::span<const Define> threads);

    // True if a particle may be spawned at `p`: on the fluid's side of every plane, outside every mesh at its current pose, and not nearer
    // than its rest distance. For an existing particle, `near` is the least distance as a share of the rest distance, because a wall pushes
    // it out; but not from the voxels of a static mesh's surface.
    bool maySpawn(const vec3& p, float spacing, float near = 1) const;
    // True if `p` is inside a mesh that the last replace() added, or behind a plane.
    bool insideAdded(const vec3& p, float spacing) const;
    bool anyAdded() const;  // false: insideAdded() is false everywhere
    bool any() const { return planeCount() > 0 || static_.field != nullptr || !rigid_.empty() || !deforming_.empty(); }
    uint32_t planeCount() const { return static_cast<uint32_t>(planeSolids_.size()); }
    const Buffer& planes() const { return planes_; }  // in the layout of integrate.kernel

    // Error (badInput): as create; nothing has changed then.
    Status setSurfaces(std::span<const Surface> surfaces);
    bool hasSurfaces(std::span<const Surface> surfaces) const;  // whether it has these already
    // Returns to the poses at t = 0.
    Status reset();

    // The places of all solids.
    struct Places {
        std::vector<Pose> poses;
        std::vector<std::vector<vec3>> shapes;
        uint64_t voxelsRewritten = 0;
    };
    void save(WorldState& state) const;
    // Error: as WorldState::take; other voxels than at the time of saving.
    Result<Places> take(WorldState& state) const;
    Status restore(const Places& places);

    // Sets the poses and shapes of solids `seconds` from now; empty spans: unchanged. Error (badInput): the number of poses or shapes is
    // wrong, a value is not finite, a vertex is beyond its field's reach; then nothing moves.
    // What beginFrame() refuses.
    Status checkFrame(std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes, double seconds) const;
    Status beginFrame(std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes, double seconds);
    // m: boxes around each solid that moves in this frame, over its whole way.
    std::vector<Bounds> moved() const;
    float fastestWall() const { return fastestWall_; }  // m/s, of the frame

    // Moves the solids from the share `from` to the share `to` of the frame's time, 0..1. `gravity` m/s^2. Error: (noMemory), and none of
    // the rigid ones has moved; another, and the solid that cannot deform stays as it was.
    Status advance(const FluidParams& params, const StepParams& step, float gravity, double from, double to);
    // Fills `into` with the walls near each particle and body sample at `position`, sorted: see shaders/fluid/solids/near_walls.h.
    void nearWalls(const StepParams& step, const NeighborGrid& grid, const Buffer& position, Buffer& into);
    // Moves the planes in `walls`, found for particles at `from`, to particles at `to`, both sorted.
    void followWalls(const StepParams& step, const NeighborGrid& grid, const Buffer& from, const Buffer& to, Buffer& walls);
    // Fills `friction` with the effect of no-slip walls at `position`, sorted: see StepContext::wallFriction.
    void friction(const StepParams& step, const NeighborGrid& grid, const Buffer& position, Buffer& friction);
    // Adds the adhesion of static walls to particles.acceleration; step.force.w: see fluid/forces/wall_adhesion.
    void adhesion(const StepParams& step, const NeighborGrid& grid, Particles& particles);
    // Moves particles.positionNext and velocityNext out of the solids. `probes`: measures it; null: nothing does.
    void collide(const StepParams& step, const NeighborGrid& grid, Particles& particles, ProbePasses* probes = nullptr);
    // Other moving points: one vec4 each, xyz m or m/s, w unchanged. `from` is outside all solids.
    struct Movers {
        const Buffer *from, *to, *velocity;
        const Buffer* counts;  // uint; [index]: number of active points
        uint32_t index, slots;
    };
    // Moves these points out of solids, planes and the box. `seconds`: their path covers the frame so far, with the rigid solids' poses
    // since beginFrame; deforming solids have only the shape of the last substep. 0: the path takes no time, and solids stand still.
    void keepOut(const StepParams& step, const Movers& movers, double seconds);
    // What probes read of a field: kind and number, its params (FieldParams, or MotionParams of this substep), distances, normals.
    struct FieldView {
        ProbeOn on = ProbeOn::none;
        uint32_t index = 0;
        const Buffer *block = nullptr, *distance = nullptr, *normal = nullptr, *displacement = nullptr;  // displacement: of deforming
    };
    FieldView stillField() const { return {ProbeOn::still, 0, &staticBlock_, &static_.distance, &static_.normal, nullptr}; }
    std::vector<FieldView> movingFields() const;
    std::vector<WetSurface::Part> wetParts() const;                         // that can get wet
    bool moving() const { return !rigid_.empty() || !deforming_.empty(); }  // some may move

    const std::vector<Pose>& poses() const { return poses_; }      // of the rigid solids, now
    uint64_t voxelsRewritten() const { return voxelsRewritten_; }  // of the deforming ones, since the start

  private:
    struct Field {
        const VoxelField* field = nullptr;
        Buffer bits, distance, normal;
        std::vector<uint8_t> outside;  // of its voxels: reachable from the grid's border; empty where the mesh is closed
        Status upload(Device& device);
        bool maySpawn(const vec3& p, float spacing, float near) const;  // in the field's frame
    };
    struct Moving {
        Field on;
        DeformingField* shape = nullptr;  // null: rigid
        bool added = true;                // by the last replace()
        MotionParams motion{};
        Buffer block;  // a MotionParams
        Pose atStart, from, target;
        std::vector<vec3> shapeAtStart, shapeFrom, shapeTarget, shapeNow;
        int updates = 1, updated = 0;  // of the frame
        float radius = 0;              // m, about the frame's origin
        Buffer displacement;
    };

    static Status check(std::span<const Surface> surfaces);
    Status addMoving(Moving moving);
    void writePlanes();
    static Moving* keep(std::vector<Moving>& all, const VoxelField* field, std::vector<const Moving*>& taken);
    Status settle(Moving& moving, const std::vector<vec3>& shape);
    // `planes`: what is pushed may be beyond the box or a plane. `seconds`: as keepOut; nothing: the way is the last substep's.
    void collide(const StepParams& step, const Movers& movers, bool planes, std::optional<double> seconds, ProbePasses* probes);
    uint64_t voxelsHash() const;  // of what was baked and stays
    Status deform(Moving& moving, double share, double seconds);
    static void setMotion(MotionParams& motion, const Pose& start, const Pose& end, float dt);

    Device* device_ = nullptr;
    std::vector<PlaneSolid> planeSolids_;
    std::vector<Surface> surfaces_;
    Surface otherwise_;
    bool surfacesChanged_ = true;
    Buffer planes_;
    bool walled_ = true;   // the box or solids
    bool thesis_ = false;  // collision.walk
    Kernel nearWalls_, followWalls_, friction_, frictionMoving_, frictionDeforming_, adhesion_, collide_, walls_, nearWallsMoving_,
        collideRigid_, collideDeforming_;
    Field static_;
    bool staticAdded_ = true;  // as Moving::added
    FieldParams block_{};
    Buffer staticBlock_;  // then the planes, see fluid/solids/probe_walls
    float blockDt_ = 0;   // staticBlock_ was written for this step length
    std::vector<Moving> rigid_, deforming_;
    std::vector<Pose> poses_;
    double frameSeconds_ = 0;
    float fastestWall_ = 0;
    uint64_t voxelsRewritten_ = 0;
};

}  // namespace rivulet
