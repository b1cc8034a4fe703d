// Scene: meshes, and the nodes that place them. A node's place is relative to its parent's.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "engine/scene/mesh.h"
#include "engine/scene/skin.h"

namespace rivulet {

struct Node {
    std::string name;
    mat4 local{1.0F};                  // this node -> its parent
    int parent = -1;                   // index of an earlier node, or -1: the world
    std::shared_ptr<const Mesh> mesh;  // null: a group
    Material material;
    bool visible = true;                       // an invisible node hides its children too
    std::shared_ptr<const Deformer> deformer;  // where the mesh's vertices are now; null: as the mesh says. Goes before its device
    std::shared_ptr<const Layer> layer;        // what lies on the material; null: nothing
};

class Scene {
  public:
    // The index of the new node; its parent must have been added before.
    int add(Node node);
    std::vector<Node>& nodes() { return nodes_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    // Each node's transform to the world, in the order of nodes().
    std::vector<mat4> worldMatrices() const;
    std::vector<bool> visible() const;
    // Of all visible meshes, in the world; empty if there are none.
    Bounds bounds() const;

  private:
    std::vector<Node> nodes_;
};

}  // namespace rivulet
