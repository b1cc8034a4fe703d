// The field of a mesh that bends: after each change only the bricks in reach of a moved triangle are baked again.
#pragma once

#include <vector>

#include "fluid/voxel/voxel_field.h"

namespace rivulet {

class DistanceBand;

class DeformingField {
  public:
    // One mesh as it is at first, m. `reach`: a box that holds it at all times (m); the grid covers that, padded as a static field's is,
    // and options.resolution counts voxels along the box's longest side. Errors as bakeVoxelField; more or fewer meshes than one; a vertex
    // outside `reach`. Beside the field 20 bytes a grid point, and 13 a vertex and triangle.
    static Result<DeformingField> create(std::span<const MeshView> restMesh, const Bounds& reach, const VoxelFieldOptions& options);

    struct Change {
        int firstLayer = 0,
            endLayer = 0;   // z layers of grid points [first, end), and voxels with the same z: others are as they were before
        size_t voxels = 0;  // that were voxelised again, with as many grid points
    };
    // New places of all vertices (m), as many and in the same order; what they were is what the last update was given. Bits, distance
    // and normals are then bit for bit those of a bake from nothing. Error: another number of vertices, a vertex of a triangle
    // that is NaN or outside `reach` (nothing has changed then); out of memory (the next update makes good what is half done).
    Result<Change> update(std::span<const vec3> positions);
    // What update would refuse them for.
    Status checkPlaces(std::span<const vec3> positions) const;

    // At the latest places. Unsigned.
    const VoxelField& field() const { return field_; }
    // At every grid point within the band: how far (m) the nearest triangle's nearest point was moved by the last update: xyz, w 0. Zero
    // elsewhere, and after create. Over the update's time step it is the wall's velocity.
    std::span<const vec4> displacement() const { return displacement_; }
    std::span<const vec3> positions() const { return positions_; }  // the latest, m

  private:
    DeformingField() = default;
    size_t findMoved(std::span<const vec3> positions);
    void bakeAll();
    void bakePart(const std::vector<vec3>& before);
    void markMoved(const DistanceBand& band, const std::vector<vec3>& before, std::span<uint8_t> flags, ivec3& low, ivec3& high) const;
    void findNear(const ivec3& low, const ivec3& high, float margin, std::vector<uint32_t>& numbers, std::vector<uint32_t>& corners) const;
    Change displace(const std::vector<vec3>& before);

    VoxelField field_;
    Bounds reach_;
    std::vector<uint8_t> surfaces_;  // of the one mesh; or none
    std::vector<uint32_t> indices_;
    std::vector<vec3> positions_;
    std::vector<uint8_t> used_;      // vertices that a triangle has
    std::vector<uint8_t> moved_;     // triangles, in this update
    std::vector<uint32_t> nearest_;  // to each grid point
    std::vector<vec4> displacement_;
    std::vector<uint8_t> occupied_;   // bricks that a triangle reaches
    std::vector<uint8_t> dirty_;      // bricks done in this update
    std::vector<uint8_t> displaced_;  // bricks with a displacement
    bool stale_ = true;               // something was left half done: bake all
};

}  // namespace rivulet
