#include "engine/scene/model.h"

#include <algorithm>
#include <glm/matrix.hpp>

namespace rivulet {

std::vector<mat4> Model::worldMatrices() const {
    std::vector<mat4> locals;
    for (const ModelNode& node : nodes) locals.push_back(node.local);
    return worldMatrices(locals);
}

std::vector<mat4> Model::worldMatrices(const std::vector<mat4>& locals) const {
    std::vector<mat4> world;
    world.reserve(nodes.size());
    for (size_t k = 0; k < nodes.size(); ++k)
        world.push_back(nodes[k].parent < 0 ? locals[k] : world[static_cast<size_t>(nodes[k].parent)] * locals[k]);
    return world;
}

ModelPart* Model::find(std::string_view partName) {
    const auto found = std::find_if(parts.begin(), parts.end(), [&](const ModelPart& part) { return part.name == partName; });
    return found == parts.end() ? nullptr : &*found;
}

std::vector<mat4> Model::boneMatrices(const ModelPart& part, const std::vector<mat4>& world) const {
    // The results are in the frame of the part's node, as the vertices of parts without bones.
    const mat4 toNode = glm::inverse(world[static_cast<size_t>(part.node)]);
    std::vector<mat4> all;
    all.reserve(part.bones.size());
    for (const Bone& bone : part.bones) all.push_back(toNode * world[static_cast<size_t>(bone.node)] * bone.fromMesh);
    return all;
}

}  // namespace rivulet
