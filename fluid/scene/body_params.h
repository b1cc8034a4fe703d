// A rigid body of a scene file.
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "fluid/sim/solids/layers.h"

namespace rivulet {

// A mesh that is drawn with a body. It has no mass and no contact.
struct BodyPartParams {
    std::string mesh;  // in the frame of the body's mesh
    vec3 colour{0.1F};
    float roughness = 0.4F;
    void visit(ParamVisitor& v);
};

// A rigid body that floats or sinks; a fixed one is a wall of boundary particles.
struct BodyParams {
    std::string shape = "box";  // box | sphere | hull | mesh
    std::string mesh;           // of a hull or mesh: a closed mesh file, searched as findAsset does
    vec3 size{0.1F};            // m, of a box
    float radius = 0.05F;       // m, of a sphere
    float scale = 1.0F;         // of a hull or mesh
    float fitSize = 0.0F;       // m; as fitSize of a collider
    vec3 position{0.0F};        // m
    vec3 rotation{0.0F};        // deg, about x, then y, then z
    vec3 velocity{0.0F};        // m/s
    vec3 spin{0.0F};            // deg/s
    float density = 500.0F;     // kg/m^3
    float mass = 0.0F;          // kg; 0 = density times volume
    vec3 ballast{0.0F};         // m, from the centre of its volume to its centre of mass, before `rotation`
    float friction = 0.5F;      // Coulomb, against walls and other bodies
    float restitution = 0.1F;   // 0..1
    bool fixed = false;
    bool sticks = false;  // no-slip (true) or free slip
    LayersParams layers;
    std::vector<BodyPartParams> parts;
    vec3 colour{0.85F, 0.45F, 0.2F};  // linear
    float roughness = 0.4F;
    float porosity = -1;  // as porosity of a collider
    bool visible = true;
    void visit(ParamVisitor& v);
};

// Returns "", or the contradiction between values; the text continues "bodies[2]". checkScene calls it.
std::string contradiction(const BodyParams& body);

}  // namespace rivulet
