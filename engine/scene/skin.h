// Deformer: applies morphs and bones to one part, on a Device. Flow on the skin and rendering use the same result buffers.
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

class Deformer;

// The vertices of a Deformer at a time, in the host's memory. They may outlive it and its device.
struct DeformedVertices {
    std::vector<vec4> positions, normals;  // as the Deformer's buffers; empty: they have not arrived
    Bounds bounds;                         // m; conservative
    uint64_t version = 0;                  // the Deformer's
    std::weak_ptr<const Deformer> of;
};
// Reads the vertices that a deformer has now, without waiting: they arrive within a later Device::poll(), on the cpu at once.
std::shared_ptr<const DeformedVertices> readLater(const std::shared_ptr<const Deformer>& deformer);

class Deformer {
  public:
    // `device` must outlive it and must have the kernels material/deform and material/normals. In rest pose until the first run().
    // Error (badInput): an index of a morph, bone or triangle is out of range; (failed): out of memory.
    static Result<Deformer> create(Device& device, const ModelPart& part);

    // `weights`: one per morph, in the part's order; missing ones are 0. `bones`: Model::boneMatrices; empty: no skinning. A weight that is
    // not finite counts as 0, and a matrix that is not finite as the bind pose. With all weights 0 and no bones the positions are exactly
    // the mesh's.
    void run(std::span<const float> weights, std::span<const mat4> bones = {});

    Device& device() const { return *device_; }
    uint32_t vertices() const { return vertices_; }
    const Buffer& positions() const { return point_; }  // one vec4 per vertex: xyz m, in the frame of the part's node
    const Buffer& normals() const { return normal_; }   // one vec4 per vertex: xyz unit normal, w mean curvature, 1/m
    const Bounds& bounds() const { return bounds_; }    // m; conservative
    uint64_t version() const { return version_; }       // incremented when the buffers change
    size_t bytes() const;                               // allocated on the device

  private:
    Status fillTables(const ModelPart& part);
    Device* device_ = nullptr;
    Kernel deform_, gatherNormals_;
    Buffer rest_, begin_, offset_, amount_, grip_, bone_, point_, ring_, corner_, normal_;
    uint32_t vertices_ = 0;
    std::vector<float> reach_, weights_;  // m, the longest offset of each morph; the weights of the last run()
    std::vector<mat4> turned_;            // bone matrices of the last run()
    size_t boneCount_ = 0;
    Bounds restBounds_, bounds_;
    uint64_t version_ = 0;
};

}  // namespace rivulet
