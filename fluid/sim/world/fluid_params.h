// The "fluid" section of a scene: the values that a FluidWorld is created from. SI units.
#pragma once

#include <rivulet_lists/forces.h>

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "fluid/sim/methods/method_dfsph.h"
#include "fluid/sim/methods/method_pbf.h"
#include "fluid/sim/solids/layers.h"
#include "fluid/sim/solids/probes.h"

namespace rivulet {

// A value of a particle that a host gives to it and reads: it has no effect on the water. Fixed: it cannot change while the water runs.
template <bool Fixed>
struct AttributeParamsOf {
    std::string name = {};
    float x = 0, y = 0, z = 0, w = 0;
    vec4 value() const { return {x, y, z, w}; }
    void visit(ParamVisitor& v) {
        v.value({.name = "name", .doc = "name of the attribute", .fixed = Fixed}, name);
        v.value({.name = "x", .doc = "first component of the value", .fixed = Fixed}, x);
        v.value({.name = "y", .doc = "second component", .fixed = Fixed}, y);
        v.value({.name = "z", .doc = "third component", .fixed = Fixed}, z);
        v.value({.name = "w", .doc = "fourth component", .fixed = Fixed}, w);
    }
};
using AttributeParams = AttributeParamsOf<kFixed>;
using LiveAttributeParams = AttributeParamsOf<!kFixed>;

// A body of particles at rest spacing, present at t = 0.
struct BlockParams {
    vec3 min{0.0F}, max{0.0F};
    vec3 velocity{0.0F};
    std::string liquid = {};     // a row of liquids(); "" = the world's
    vec3 dye{1.0F};              // linear; white = none
    float dyeAmount = 20.0F;     // 1/m
    float dyeScattering = 0.0F;  // 1/m
    float jitter = 0.2F;         // spacings: largest random offset of a particle from its lattice point, before the start is relaxed
    std::string shape = "box";   // box | ball | cylinder | cone: fits between min and max; mesh: the inside of `mesh` between them
    bool cut = false;            // solids are meant to cut the block: no notice about the particles that they remove
    std::string axis = "y";      // x | y | z: of a cylinder or a cone; a cone has its apex at max
    std::string mesh = {};       // file, as of a collider
    float fitSize = 0.0F;        // m, mesh: its longest side; 0 = as it is
    vec3 position{0.0F};         // m, mesh: where its origin goes
    vec3 rotation{0.0F};         // deg, mesh
    vec3 spin{0.0F};             // rad/s, about the centre between min and max
    vec3 gradientX{0.0F}, gradientY{0.0F}, gradientZ{0.0F};  // 1/s: of the velocity's x, y, z about that centre
    std::vector<AttributeParams> attributes = {};            // of its particles; others have the values of FluidParams::attributes
    void visit(ParamVisitor& v);
};

struct BoxParams {
    vec3 min{0.0F}, max{1.0F};
    float restitution = 0.0F;
    bool periodicX = false, periodicY = false, periodicZ = false;
    bvec3 periodic() const { return {periodicX, periodicY, periodicZ}; }
    void visit(ParamVisitor& v);
};

struct CollisionParams {
    float friction = 0.0F;       // Coulomb, of mesh colliders and walls
    float restitution = 0.0F;    // of mesh colliders
    std::string walk = "exact";  // exact | thesis
    std::string walls = "slip";  // slip | no-slip
    LayersParams layers = {};    // of the water
    void visit(ParamVisitor& v);
};

// The Params of all forces as keys of fluid.forces (force.h).
template <class... Forces>
struct ParamsOfAll : Forces... {
    void visit(ParamVisitor& v) { (Forces::visit(v), ...); }
};
using ForcesParams = ParamsOfAll<RIVULET_FORCE_PARAMS>;

// Spray, foam and bubbles. Defaults after Ihmsen et al. 2012, in SI units.
struct FoamParams {
    int most = 0;                               // largest number of particles at a time; 0 = none
    float trappedAir = 1500, waveCrest = 1500;  // 1/s, largest rate of one fluid particle
    float airFrom = 0.3F, airTo = 1.5F;         // m/s, mean speed at which neighbours meet
    float crestFrom = 0.1F, crestTo = 0.4F;     // mean 1 - cos between a crest's normals
    float speedFrom = 0.5F, speedTo = 3.0F;     // m/s
    float life = 2.5F;                          // s, longest life on the water
    float buoyancy = 2.0F, drag = 10.0F;        // of bubbles: buoyancy over gravity; drag in 1/s
    void visit(ParamVisitor& v);
};

// Particles of calm water are not stepped.
struct SleepParams {
    bool on = false;
    float speed = 0.015F;  // over sqrt(g h), h the support radius
    float after = 5.0F;    // over sqrt(h / g)
    void visit(ParamVisitor& v);
};

// Solids that water has touched stay wet for a while. For pictures: the motion of the water does not depend on it.
struct WetnessParams {
    bool on = false;
    float dries = 20.0F;  // s
    float runs = 0.06F;   // m
    void visit(ParamVisitor& v);
};

inline constexpr float kMostGravity = 1000;   // m/s^2, along each axis
inline constexpr size_t kMostAttributes = 4;  // of a world

struct FluidParams {
    std::string method = "pbf";       // a row of methods()
    std::string kernel = "wendland";  // wendland | cubic_spline
    std::string grid = "sorted";      // sorted | linked_list
    int workGroup = 64;               // threads per work group of a GPU
    float spacing = 0.02F;            // m
    float supportSpacings = 2.3F;     // h = this * spacing
    std::string liquid = {};          // a row of liquids(), which then sets restDensity and viscosity; "" = the values below
    float restDensity = 1000.0F;      // kg/m^3
    float viscosity = 1.0e-6F;        // m^2/s, kinematic
    float artificialViscosity = 0.02F;
    float soundSpeed = 0.0F;  // m/s; 0 = ten times the highest speed of a fall in the scene
    float stiffness = 20.0F;  // thesis mode: k of (4), m^2/s^2
    vec3 gravity{0.0F, -9.81F, 0.0F};
    float cfl = 0.4F;           // dt <= cfl * hs / (c0 + v)
    int maxSubsteps = 1000;     // a frame
    float longestFrame = 0.1F;  // s
    float fixedStep = 0.0F;     // s; 0 = none
    float frameBudget = 0.0F;   // ms; 0 = none
    bool limits = true;         // limits steps to the stable length, and particles to a spacing a step
    dvec3 origin{0.0};          // m: position of the scene's (0, 0, 0) in the host's world. A scene file stores it as floats
    bool ellipsoids = false;    // computed for drawing
    int maxParticles = 0;       // 0 = as many as blocks and emitters need
    int maxBodySamples = 0;     // 0 = as many as the bodies at the start have
    PbfParams pbf = {};
    DfsphParams dfsph = {};
    ForcesParams forces = {};
    FoamParams foam = {};
    SleepParams sleep = {};
    WetnessParams wetness = {};
    BoxParams box = {};
    CollisionParams collision = {};
    std::vector<BlockParams> blocks = {};
    std::vector<ProbeParams> probes = {};
    std::vector<AttributeParams> attributes = {};  // kMostAttributes at most
    void visit(ParamVisitor& v);
};

}  // namespace rivulet
