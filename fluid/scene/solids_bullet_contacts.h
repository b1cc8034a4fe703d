// Contacts that may act in a frame, found with Bullet: for BodyHost::contacts. Used by BulletSolids alone.
#pragma once

#include <span>
#include <vector>

#include "fluid/scene/bullet.h"
#include "fluid/sim/solids/bodies.h"
#include "fluid/sim/solids/layers.h"

namespace rivulet {

inline btVector3 toBullet(const vec3& v) { return {v.x, v.y, v.z}; }
inline vec3 fromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
inline btTransform toBullet(const Pose& p) {
    return btTransform(btQuaternion(p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w), toBullet(p.position));
}

// An object's layers are its user indices.
constexpr LayersParams kBoxLayers{LayersParams::kAll, LayersParams::kAll};  // walls of the box: they meet all
inline LayersParams layersOf(const btCollisionObject& object) { return {object.getUserIndex(), object.getUserIndex2()}; }

struct ContactBody {
    btCollisionObject* object = nullptr;  // its shape has polyhedral features; its transform is changed
    btCollisionObject* hull = nullptr;    // the same as one hull, if it has parts; else the same object
    std::span<const btVector3> corners;   // m, own frame; none: a ball
    vec4 ball{0.0F};                      // xyz m, own frame; w m, radius
    bool moves = true;
};
struct ContactSolid {
    btCollisionObject* object = nullptr;  // where it is when the frame begins
    vec3 velocity{0.0F}, spin{0.0F};      // m/s, of its origin; rad/s
    double seconds = 0;                   // that it moves so
};

// Adds to `found`, as BodyHost::contacts. At most 8 of a pair.
void findContacts(btCollisionWorld& world, std::span<const ContactBody> bodies, std::span<const ContactSolid> solids,
                  std::span<const BodyState> states, std::span<const vec4> balls, double seconds, std::vector<BodyContact>& found);

}  // namespace rivulet
