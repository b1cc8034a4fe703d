// FieldBake: a voxel field that is baked beside the frames of a host.
#pragma once

#include <memory>
#include <vector>

#include "engine/core/jobs.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// A mesh, m.
struct BakedMesh {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;  // three a triangle
    uint8_t surface = 0;            // as VoxelFieldOptions::surfaces
};

// The checks of a bake, which take no time. Errors as bakeVoxelField.
Status checkVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options);

class FieldBake {
  public:
    // Begins to bake, as bakeVoxelField does, by Jobs::start of `jobs`. It takes one core: its loops run on one thread. The options'
    // surfaces are those of the meshes.
    FieldBake(std::vector<BakedMesh> meshes, const VoxelFieldOptions& options, const Jobs& jobs = {});
    ~FieldBake();  // cancels it, and waits until it has stopped: some hundredths of a second of a mesh of 80,000 triangles
    FieldBake(const FieldBake&) = delete;
    FieldBake& operator=(const FieldBake&) = delete;

    bool done() const;  // never waits
    // Once; waits until it is done. Error: as bakeVoxelField.
    Result<VoxelField> take();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace rivulet
