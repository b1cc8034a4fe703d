// The walls of a host's world: each has an id, and its field is baked at the start or beside the frames.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/background.h"
#include "engine/core/jobs.h"
#include "engine/core/result.h"
#include "fluid/capi/rivulet.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/voxel/deforming_field.h"
#include "fluid/voxel/field_bake.h"

namespace rivulet::capi {

// Error (badInput): it is not finite, or its rotation is not of unit length.
Result<Pose> soundPose(const rivulet_pose& given, const std::string& name);

// Of a mesh with these bounds: voxels along its longest side; 0: of a quarter of the spacing. `memoryLimit` 0: none.
VoxelFieldOptions voxelOptions(const Bounds& bounds, int resolution, float spacing, size_t memoryLimit);
// 0 as rivulet_mesh has it. Error (badInput): a layer that there is not.
Result<LayersParams> layersOf(uint32_t layers, uint32_t meets, const std::string& name);

class Walls {
  public:
    // Bakes those of the options. Errors as rivulet_world_create.
    Status begin(const rivulet_world_options& o, const FluidParams& fluid, size_t memoryLimit, const Jobs& jobs);
    // For FluidWorld::create and setWalls, without bodies.
    Solids solids() const;

    // Begins to bake another one. Its id, or an error as begin().
    Result<uint32_t> add(const rivulet_mesh& wall);
    // It ends with this call, or when those that were baked together with it are baked without it. Error (badInput): there is none.
    Status remove(FluidWorld& world, uint32_t id);
    // Brings walls whose bake has ended into the world. Returns sentences about those that could not be.
    std::vector<std::string> arrive(FluidWorld& world);
    // Empty: it acts, or is being baked. Error (badInput): there is none; as its bake.
    Result<rivulet_wall_state> stateOf(uint32_t id) const;

    size_t moving() const;                   // that move
    void move(std::span<const Pose> poses);  // of these
    // Of solids().rigid, and of all that move.
    struct Targets {
        std::vector<Pose> poses, moving;
        std::vector<std::vector<vec3>> shapes;     // m, of solids().deforming
        std::vector<std::vector<vec3>> deforming;  // m, of all that deform
    };
    // Of those that move and act: which of all that move, and where it is.
    std::vector<std::pair<size_t, Pose>> placesOfMoving(const FluidWorld& world) const;
    size_t deforming() const;  // that deform
    // Of one of these: m, 3 floats for each of its vertices.
    void deform(size_t which, const float* positions);
    Targets targets() const;
    void moveBack(const Targets& before);
    void follow(const std::vector<Pose>& poses);  // of solids().rigid: where a reset or a restored state has put them

  private:
    struct Wall {
        uint32_t id = 0;
        bool moves = false, deforms = false;
        bool together = false;  // baked with others that stand still
        bool meets = true;      // the water; else nothing is baked
        bool leaves = false;    // while the others are baked without it
        bool arrives = false;   // its shape was baked, and is not in the world yet
        uint8_t surface = 0;
        int resolution = 0;
        BakedMesh mesh;  // of those baked together
        Pose start, now;
        std::unique_ptr<VoxelField> field;
        std::unique_ptr<DeformingField> deforming;
        std::vector<vec3> shape;  // m, of one that deforms: the last requested
        std::unique_ptr<FieldBake> bake;
        std::unique_ptr<Background<DeformingField>> bakeShape;
        std::string failure;
        bool acts() const { return field != nullptr; }  // as a rigid solid
        bool bakes() const { return bake != nullptr || bakeShape != nullptr; }
    };
    const Wall* find(uint32_t id) const;
    // A number for these values. Nothing: there are too many.
    std::optional<uint8_t> surfaceFor(const Surface& surface, bool own);
    VoxelFieldOptions optionsFor(std::span<const BakedMesh> meshes, int resolution) const;
    // A function that bakes it. Error (badInput): its reach is no box.
    Result<std::function<Result<DeformingField>()>> deformingOf(const Wall& wall, const rivulet_mesh& given) const;
    bool takeShape(Wall& wall);  // that was baked; false: it failed
    Result<Wall> read(const rivulet_mesh& wall, const std::string& name, bool ownSurface);
    std::vector<BakedMesh> standing(int& finest) const;
    Status apply(FluidWorld& world);

    float spacing_ = 0;
    LayersParams water_;
    size_t memoryLimit_ = 0;
    Jobs jobs_;
    uint32_t next_ = 0;  // id
    std::vector<Wall> all_;
    std::vector<Surface> surfaces_;
    std::unique_ptr<VoxelField> standing_;  // those that were baked together
    std::unique_ptr<FieldBake> standingBake_;
    std::vector<uint32_t> acting_;  // ids of the world's rigid solids
};

}  // namespace rivulet::capi
