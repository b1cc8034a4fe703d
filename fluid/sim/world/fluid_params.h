// The "fluid" section of a scene: what a FluidWorld is made from. SI units.
#pragma once

#include <rivulet_lists/forces.h>

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "fluid/sim/methods/method_dfsph.h"
#include "fluid/sim/methods/method_pbf.h"

namespace rivulet {

// A body of particles at rest spacing, present at t = 0.
struct BlockParams {
    vec3 min{0.0F}, max{0.0F};
    vec3 velocity{0.0F};
    std::string liquid = {};     // a row of liquids(); "" = the world's
    vec3 dye{1.0F};              // linear; white = none
    float dyeAmount = 20.0F;     // 1/m
    float dyeScattering = 0.0F;  // 1/m
    float jitter = 0.0F;         // spacings that a particle may stand off its place in the lattice, along each axis
    std::string shape = "box";   // box | ball: the ellipsoid between min and max
    bool cut = false;            // solids cut it to shape, and nothing is said of what they leave out
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
    int most = 0;                               // at once; 0 = none
    float trappedAir = 1500, waveCrest = 1500;  // 1/s, that a particle makes at most
    float airFrom = 0.3F, airTo = 1.5F;         // m/s, mean speed at which neighbours meet
    float crestFrom = 0.1F, crestTo = 0.4F;     // mean 1 - cos between a crest's normals
    float speedFrom = 0.5F, speedTo = 3.0F;     // m/s
    float life = 2.5F;                          // s, on the water; the longest
    float buoyancy = 2.0F, drag = 10.0F;        // of bubbles: over gravity; 1/s
    void visit(ParamVisitor& v);
};

struct FluidParams {
    std::string method = "pbf";       // a row of methods()
    std::string kernel = "wendland";  // wendland | cubic_spline
    std::string grid = "sorted";      // sorted | linked_list
    int workGroup = 64;               // threads, of a GPU
    float spacing = 0.02F;            // m
    float supportSpacings = 2.0F;     // h = this * spacing
    std::string liquid = {};          // a row of liquids(), which then says restDensity and viscosity; "" = as given
    float restDensity = 1000.0F;      // kg/m^3
    float viscosity = 1.0e-6F;        // m^2/s, kinematic
    float artificialViscosity = 0.02F;
    float soundSpeed = 0.0F;  // m/s; 0 = ten times the fastest speed the scene can fall to
    float stiffness = 20.0F;  // thesis mode: k of (4), m^2/s^2
    vec3 gravity{0.0F, -9.81F, 0.0F};
    float cfl = 0.4F;           // dt <= cfl * hs / (c0 + v)
    int maxSubsteps = 1000;     // a frame
    float longestFrame = 0.1F;  // s
    float fixedStep = 0.0F;     // s; 0 = none
    float frameBudget = 0.0F;   // ms; 0 = none
    bool limits = true;         // steps no longer than is stable, no particle faster than a spacing a step
    dvec3 origin{0.0};          // m: where the scene's (0, 0, 0) is in the host's world. A scene file gives it as floats
    bool ellipsoids = false;    // found for drawing
    int maxParticles = 0;       // 0 = what blocks and emitters need
    PbfParams pbf = {};
    DfsphParams dfsph = {};
    ForcesParams forces = {};
    FoamParams foam = {};
    BoxParams box = {};
    CollisionParams collision = {};
    std::vector<BlockParams> blocks = {};
    void visit(ParamVisitor& v);
};

}  // namespace rivulet
