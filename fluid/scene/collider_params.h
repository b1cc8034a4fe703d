// What a scene file says of a collider: its shape, where it is, how it moves and how it is drawn.
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"

namespace rivulet {

// A collider's place at a time, from where its scene puts it; between keys it moves smoothly, after the last it stays.
struct ColliderKey {
    float time = 0;       // s
    vec3 position{0.0F};  // m, added to the collider's
    vec3 rotation{0.0F};  // deg, about x, then y, then z, after the collider's own
    void visit(ParamVisitor& v);
};

// How a mesh collider moves as a whole. It turns about its `position`.
struct ColliderMotion {
    vec3 axis{0.0F, 0.0F, 1.0F};
    float spin = 0;            // deg/s about the axis
    vec3 shake{0.0F};          // m, amplitude
    float shakeFrequency = 1;  // Hz
    std::vector<ColliderKey> keys;
    bool moves() const { return spin != 0 || shake != vec3(0.0F) || !keys.empty(); }
    void visit(ParamVisitor& v);
};

// A wave that runs through a mesh collider and bends it.
struct ColliderWave {
    float amplitude = 0;               // m; 0 = none
    float length = 0.5F;               // m
    float period = 1;                  // s
    vec3 along{1.0F, 0.0F, 0.0F};      // the way it runs
    vec3 direction{0.0F, 1.0F, 0.0F};  // the way it lifts
    void visit(ParamVisitor& v);
};

// A clip of a mesh file that plays. What it bends, water meets as it is at the time.
struct ColliderAnimation {
    std::string clip;   // "" = the file's first
    float speed = 0;    // 0 = it stands as in its file
    bool loops = true;  // or it stays as it ends
    void visit(ParamVisitor& v);
};

// A solid. "mesh": a file, scaled, turned, moved. "plane": water on the side the normal points to; it stands still.
struct ColliderParams {
    std::string shape = "mesh";  // mesh | plane
    std::string mesh;            // path: as given, beside the scene file, in RIVULET_ASSETS (a list of folders), in assets/
    int resolution = 0;          // voxels along the mesh's longest side; 0 = so many that one is a quarter of the fluid's spacing
    vec3 position{0.0F};         // m; plane: a point on it
    vec3 rotation{0.0F};         // deg, about x, then y, then z
    float scale = 1.0F;
    float fitSize = 0.0F;           // m; > 0: scaled so that the longest side has this length, and its bounds' centre put at `position`
    vec3 normal{0.0F, 1.0F, 0.0F};  // plane
    float friction = -1;            // Coulomb; -1 = as fluid.collision says
    float restitution = -1;         // 0..1; -1 = as fluid.collision says
    ColliderMotion motion;
    ColliderWave wave;
    ColliderAnimation animation;
    bool solid = true;                 // or only drawn
    std::string materials = "file";    // file | scene: what follows
    vec3 colour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;
    float opacity = 1.0F;    // less than 1: glass
    float grain = 0.0F;      // 0 = smooth and of one colour, 1 = coarse stone
    float grainSize = 0.1F;  // m
    bool visible = true;
    void visit(ParamVisitor& v);
};

// "", or what makes no sense together; it continues "colliders[2]". checkScene calls it.
std::string contradiction(const ColliderParams& collider);

}  // namespace rivulet
