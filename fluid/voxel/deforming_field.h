// The field of a deforming mesh: after each change only the bricks in reach of a moved triangle are baked again.
#pragma once

#include <vector>

#include "fluid/voxel/voxel_field.h"

namespace rivulet {

class DistanceBand;

class DeformingField {
  public:
    // `restMesh`: one mesh at its first places, m. `reach`: a box that contains it at all times (m). The grid covers the box with the
    // padding of a static field; options.resolution counts voxels along the longest side of the box. Errors: those of bakeVoxelField;
    // more or fewer meshes than one; a vertex outside `reach`. Memory in addition to the field: 20 bytes a grid point, 13 a vertex and a
    // triangle.
    static Result<DeformingField> create(std::span<const MeshView> restMesh, const Bounds& reach, const VoxelFieldOptions& options);

    struct Change {
        int firstLayer = 0,
            endLayer = 0;   // z layers [first, end) of grid points, and of voxels with the same z; the others are unchanged
        size_t voxels = 0;  // voxelised again, with the same number of grid points
    };
    // Sets the places of all vertices (m), in the same number and order as before. Bits, distance and normals are then bit for bit those
    // of a complete bake. The last update's places are the previous ones. Errors: another number of vertices, or a vertex of a triangle
    // that is NaN or outside `reach` (the field is unchanged); out of memory (the next update bakes everything).
    Result<Change> update(std::span<const vec3> positions);
    // The error that update would return for these places.
    Status checkPlaces(std::span<const vec3> positions) const;

    // The field at the latest places. Unsigned.
    const VoxelField& field() const { return field_; }
    // At every grid point within the band: the displacement (m) of the nearest triangle's nearest point by the last update: xyz, w 0. Zero
    // elsewhere, and after create. Divided by the time step of the update it is the velocity of the wall.
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
    std::vector<uint8_t> surfaces_;  // of the mesh; may be empty
    std::vector<uint32_t> indices_;
    std::vector<vec3> positions_;
    std::vector<uint8_t> used_;      // vertices of triangles
    std::vector<uint8_t> moved_;     // triangles, in this update
    std::vector<uint32_t> nearest_;  // triangle, of each grid point
    std::vector<vec4> displacement_;
    std::vector<uint8_t> occupied_;   // bricks that a triangle reaches
    std::vector<uint8_t> dirty_;      // bricks baked in this update
    std::vector<uint8_t> displaced_;  // bricks with a displacement
    bool stale_ = true;               // the last update did not finish: bake everything
};

}  // namespace rivulet
