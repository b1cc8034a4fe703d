// Scene: nodes with meshes. A node's transform is relative to its parent's.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "engine/material/wetness.h"
#include "engine/scene/mesh.h"
#include "engine/scene/skin.h"

namespace rivulet {

struct Node {
    std::string name;
    mat4 local{1.0F};                  // this node -> its parent
    int parent = -1;                   // index of an earlier node, or -1: the world
    std::shared_ptr<const Mesh> mesh;  // null: a group
    Material material;
    bool visible = true;                               // if false, its children are hidden too
    std::shared_ptr<const Deformer> deformer;          // deformed vertices; null: the mesh's. Must be destroyed before its device
    std::shared_ptr<const DeformedVertices> deformed;  // deformed vertices of an earlier time; null: the deformer's
    std::shared_ptr<const Layer> layer;                // liquid on the material; null: none
    std::optional<WetGrid> wet;                        // where it is wet; empty: dry
    // Not negative: the node is a body of this number, and its parent is the world. Where a device has moved bodies and their host does not
    // know where to, `local` is where the body is expected, and a renderer may read its pose from the device.
    int body = -1;
};

class Scene {
  public:
    // The index of the new node; its parent must have been added before.
    int add(Node node);
    std::vector<Node>& nodes() { return nodes_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    // The transform of each node to the world, in the order of nodes().
    std::vector<mat4> worldMatrices() const;
    std::vector<bool> visible() const;
    // The node of the body that `node` moves with: itself or one above it; empty: none. And the transform of `node` to it.
    std::optional<size_t> bodyOf(size_t node) const;
    mat4 toBody(size_t node) const;
    // Moves the node of a body. The wet places of its mesh, and of the nodes below it, move along.
    void moveBody(size_t node, const mat4& local);
    // The bounds of all visible meshes, m, world; empty if there are none.
    Bounds bounds() const;

  private:
    std::vector<Node> nodes_;
};

}  // namespace rivulet
