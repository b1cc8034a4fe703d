#include "engine/scene/scene.h"

#include "engine/core/assert.h"
#include "engine/scene/transform.h"

namespace rivulet {

int Scene::add(Node node) {
    ASSERT(node.parent >= -1 && node.parent < static_cast<int>(nodes_.size()), "add a node's parent before the node");
    nodes_.push_back(std::move(node));
    return static_cast<int>(nodes_.size()) - 1;
}

std::vector<mat4> Scene::worldMatrices() const {
    std::vector<mat4> world;
    world.reserve(nodes_.size());
    for (const Node& node : nodes_) world.push_back(node.parent < 0 ? node.local : world[static_cast<size_t>(node.parent)] * node.local);
    return world;
}

std::vector<bool> Scene::visible() const {
    std::vector<bool> shown;
    shown.reserve(nodes_.size());
    for (const Node& node : nodes_) shown.push_back(node.visible && (node.parent < 0 || shown[static_cast<size_t>(node.parent)]));
    return shown;
}

std::optional<size_t> Scene::bodyOf(size_t node) const {
    for (auto n = static_cast<int>(node); n >= 0; n = nodes_[static_cast<size_t>(n)].parent)
        if (nodes_[static_cast<size_t>(n)].body >= 0) return static_cast<size_t>(n);
    return std::nullopt;
}

mat4 Scene::toBody(size_t node) const {
    mat4 to(1.0F);
    for (size_t n = node; nodes_[n].body < 0; n = static_cast<size_t>(nodes_[n].parent)) {
        ASSERT(nodes_[n].parent >= 0, "ask for a node that moves with a body");
        to = nodes_[n].local * to;
    }
    return to;
}

void Scene::moveBody(size_t node, const mat4& local) {
    const mat4 back = nodes_[node].local * glm::inverse(local);
    for (size_t n = node; n < nodes_.size(); ++n)
        if (nodes_[n].wet && bodyOf(n) == node) nodes_[n].wet->fromWorld *= back;
    nodes_[node].local = local;
}

Bounds Scene::bounds() const {
    Bounds all;
    std::vector<mat4> world = worldMatrices();
    std::vector<bool> shown = visible();
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (!shown[i] || !nodes_[i].mesh) continue;
        for (const vec3& p : nodes_[i].mesh->positions) all.add(transformPoint(world[i], p));
    }
    return all;
}

}  // namespace rivulet
