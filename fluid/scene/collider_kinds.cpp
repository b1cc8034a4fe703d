#include "fluid/scene/collider_kinds.h"

#include <fmt/format.h>

#include "engine/core/assert.h"
#include "engine/scene/import_model.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

namespace {

std::string meshContradiction(const ColliderParams& collider) {
    return collider.mesh.empty() ? ".mesh is empty: name a mesh file, or set another shape" : "";
}

Result<Model> meshModel(const ColliderParams& collider, const std::string& folder) {
    const Result<std::string> path = findAsset(collider.mesh, folder);
    if (!path) return path.error();
    return importWhole(*path);
}

std::string planeContradiction(const ColliderParams& collider) {
    const vec3& n = collider.normal;
    return glm::length(n) < 1.0e-6F ? fmt::format(".normal is ({}, {}, {}): its length must not be 0", n.x, n.y, n.z) : "";
}

void addPlane(const ColliderParams& collider, uint32_t surface, Solids& solids) {
    solids.planes.push_back({collider.position, collider.normal, surface});
}

constexpr ColliderKind kKinds[] = {
    {"mesh", "triangles of a file", meshContradiction, meshModel, nullptr},
    {"plane", "a half-space, with fluid on the side of its normal", planeContradiction, nullptr, addPlane},
};

}  // namespace

Table<ColliderKind> colliderKinds() { return {kKinds}; }

const ColliderKind& kindOf(const ColliderParams& collider) {
    const ColliderKind* kind = colliderKinds().find(collider.shape);
    ASSERT(kind != nullptr, "a collider's shape must be a name of colliderKinds()");
    return *kind;
}

const std::string& labelOf(const ColliderParams& collider) { return collider.mesh.empty() ? collider.shape : collider.mesh; }

}  // namespace rivulet
