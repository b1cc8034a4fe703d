// The kinds of colliders, one row each: which values a kind needs, and what it is made of. The scene file, the session and, through the
// Solids that a row fills, the passes and Bullet read the row. No other file compares the name of a kind.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "engine/core/table.h"
#include "engine/scene/model.h"
#include "fluid/scene/collider_params.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

struct ColliderKind {
    const char *name, *doc;
    // "", or what is wrong with the values that this kind needs; it continues "colliders[2]".
    std::string (*contradiction)(const ColliderParams& collider);
    // One of the next two is null. A kind of triangles is baked to voxels and drawn; it may move, bend or play a clip.
    // Error (badInput): as importWhole. `folder`: of the scene file.
    Result<Model> (*model)(const ColliderParams& collider, const std::string& folder);
    // Any other kind is a wall that the passes know by its formula. It stands still and is not drawn. `surface`: of Solids::surfaces.
    void (*addTo)(const ColliderParams& collider, uint32_t surface, Solids& solids);

    bool hasTriangles() const { return model != nullptr; }
};

Table<ColliderKind> colliderKinds();
const ColliderKind& kindOf(const ColliderParams& collider);
// What messages and the scene tree call a collider: its file, or the name of its kind where it has none.
const std::string& labelOf(const ColliderParams& collider);

}  // namespace rivulet
