// Deformer: morphs and bones of one part, on a Device. What flow walks on and what is drawn are the same buffers.
//
//     Result<Deformer> face = Deformer::create(device, part);
//     face->run(weights, bones);  then  face->positions(), face->normals()
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/scene/model.h"

namespace rivulet {

class Deformer {
  public:
    // `device` must outlive it and must know the kernels material/deform and material/normals. At rest until the first run().
    // Error (badInput): morphs, bones or indices that name what the part has not; (failed): out of memory.
    static Result<Deformer> create(Device& device, const ModelPart& part);

    // `weights`: one a morph, in the part's order; those missing are 0. `bones`: Model::boneMatrices; none: nothing is turned. What is not
    // finite counts as 0, or leaves the bone where it was bound. With all weights 0 and no bones the positions are the mesh's, bit for bit.
    void run(std::span<const float> weights, std::span<const mat4> bones = {});

    Device& device() const { return *device_; }
    uint32_t vertices() const { return vertices_; }
    const Buffer& positions() const { return point_; }  // a vec4 a vertex: xyz m, in the part's node's frame
    const Buffer& normals() const { return normal_; }   // a vec4 a vertex: xyz unit; w mean curvature, 1/m
    const Bounds& bounds() const { return bounds_; }    // m; never too small
    uint64_t version() const { return version_; }       // goes up when the buffers change
    size_t bytes() const;                               // on the device

  private:
    Status fillTables(const ModelPart& part);
    Device* device_ = nullptr;
    Kernel deform_, gatherNormals_;
    Buffer rest_, begin_, offset_, amount_, grip_, bone_, point_, ring_, corner_, normal_;
    uint32_t vertices_ = 0;
    std::vector<float> reach_, weights_;  // m, of each morph's longest offset; as last run
    std::vector<mat4> turned_;            // as last run
    size_t boneCount_ = 0;
    Bounds restBounds_, bounds_;
    uint64_t version_ = 0;
};

}  // namespace rivulet
