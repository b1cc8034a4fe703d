// A collider of a scene file: its shape, its place, its motion and its material.
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "fluid/sim/solids/layers.h"

namespace rivulet {

// A key of a collider's motion. Between keys the motion is smooth; before the first and after the last the collider stands still.
struct ColliderKey {
    float time = 0;       // s
    vec3 position{0.0F};  // m, added to the collider's own
    vec3 rotation{0.0F};  // deg, about x, then y, then z, applied after the collider's own
    void visit(ParamVisitor& v);
};

// Rigid motion of a mesh collider. It turns about its `position`.
struct ColliderMotion {
    vec3 axis{0.0F, 0.0F, 1.0F};
    float spin = 0;            // deg/s about the axis
    vec3 shake{0.0F};          // m, amplitude
    float shakeFrequency = 1;  // Hz
    std::vector<ColliderKey> keys;
    bool moves() const { return spin != 0 || shake != vec3(0.0F) || !keys.empty(); }
    void visit(ParamVisitor& v);
};

// A travelling wave that bends a mesh collider.
struct ColliderWave {
    float amplitude = 0;               // m; 0 = none
    float length = 0.5F;               // m
    float period = 1;                  // s
    vec3 along{1.0F, 0.0F, 0.0F};      // direction of travel
    vec3 direction{0.0F, 1.0F, 0.0F};  // direction of the displacement
    void visit(ParamVisitor& v);
};

// Playback of an animation clip of a mesh file. Water collides with the mesh in its current pose.
struct ColliderAnimation {
    std::string clip;   // "" = the first of the file
    float speed = 0;    // 0 = not played
    bool loops = true;  // false: the clip stops at its end
    void visit(ParamVisitor& v);
};

// A solid. `shape` is a row of colliderKinds() (collider_kinds.h); the row lists the values that it reads.
struct ColliderParams {
    std::string shape = "mesh";  // a row of colliderKinds()
    std::string mesh;            // path, searched as findAsset does
    int resolution = 0;          // voxels along the mesh's longest side; 0 = voxels of a quarter of the fluid's spacing
    vec3 position{0.0F};         // m; plane: a point on it
    vec3 rotation{0.0F};         // deg, about x, then y, then z
    float scale = 1.0F;
    float fitSize = 0.0F;           // m; > 0: the longest side is scaled to this length, and the centre of its bounds is at `position`
    vec3 normal{0.0F, 1.0F, 0.0F};  // plane
    float friction = -1;            // Coulomb; -1 = that of fluid.collision
    float restitution = -1;         // 0..1; -1 = that of fluid.collision
    ColliderMotion motion;
    ColliderWave wave;
    ColliderAnimation animation;
    bool solid = true;  // false: drawn, but not collided with
    LayersParams layers;
    std::string materials = "file";    // file: those of the mesh file; scene: the values below
    vec3 colour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;
    float porosity = -1;     // how much darker when wet, 0..1; -1 = by roughness
    float opacity = 1.0F;    // less than 1: glass
    float grain = 0.0F;      // 0 = smooth and of one colour, 1 = coarse stone
    float grainSize = 0.1F;  // m
    bool visible = true;
    void visit(ParamVisitor& v);
};

// Returns "", or the contradiction between values; the text continues "colliders[2]". checkScene calls it.
std::string contradiction(const ColliderParams& collider);

}  // namespace rivulet
