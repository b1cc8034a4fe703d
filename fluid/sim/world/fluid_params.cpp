#include "fluid/sim/world/fluid_params.h"

#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/liquids.h"

namespace rivulet {

namespace {
constexpr double kFast = 1.0e3;      // m/s, rad/s
constexpr double kSteepest = 1.0e4;  // 1/s
}  // namespace

void BlockParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "ball", "cylinder", "cone", "mesh"}, axes = {"x", "y", "z"};
    v.choice({.name = "shape",
              .doc = "box: all between min and max; ball, cylinder, cone: the ellipsoid, elliptic cylinder or elliptic cone that fits into "
                     "it; mesh: the inside of a mesh between min and max, which cut it",
              .fixed = kFixed},
             shape, shapes);
    v.choice({.name = "axis", .doc = "axis of a cylinder or a cone; a cone has its base at min and its apex at max", .fixed = kFixed}, axis,
             axes);
    v.value({"min", "m", "lower corner", -kMaxPosition, kMaxPosition, kLinear, kFixed}, min);
    v.value({"max", "m", "upper corner", -kMaxPosition, kMaxPosition, kLinear, kFixed}, max);
    v.value({.name = "mesh",
             .doc = "mesh file of shape mesh, searched as a collider's; an open mesh is closed across its holes",
             .fixed = kFixed},
            mesh);
    v.value({"fitSize", "m", "length that the mesh's longest side is scaled to; 0 = not scaled", 0, kMaxPosition, kLog, kFixed}, fitSize);
    v.value({"position", "m", "position of the mesh's origin (with fitSize: of its centre)", -kMaxPosition, kMaxPosition, kLinear, kFixed},
            position);
    v.value({"rotation", "deg", "rotation of the mesh about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"velocity", "m/s", "velocity at the start; of a block with spin or a gradient, that of its centre between min and max", -kFast,
             kFast, kLinear, kFixed},
            velocity);
    v.value({"spin", "rad/s", "angular velocity at the start: the block turns about its centre like a rigid body", -kFast, kFast, kLinear,
             kFixed},
            spin);
    v.value({"gradientX", "1/s", "derivatives of the x component of the velocity along x, y and z at the start", -kSteepest, kSteepest,
             kLinear, kFixed},
            gradientX);
    v.value({"gradientY", "1/s", "derivatives of the y component of the velocity along x, y and z at the start", -kSteepest, kSteepest,
             kLinear, kFixed},
            gradientY);
    v.value({"gradientZ", "1/s", "derivatives of the z component of the velocity along x, y and z at the start", -kSteepest, kSteepest,
             kLinear, kFixed},
            gradientZ);
    visitLiquid(v, "liquid of the block; empty = that of fluid.liquid", liquid);
    visitDye(v, dye, dyeAmount, dyeScattering);
    v.value({"jitter", "spacings",
             "largest random offset of particles from a lattice at the start; then particles move apart until none is too dense. 0 = a "
             "perfect lattice, which resists shear like a crystal until it is stirred",
             0, 0.5, kLinear, kFixed},
            jitter);
    v.value({.name = "cut",
             .doc = "whether solids are meant to cut the block; off: a notice reports how many particles they remove",
             .fixed = kFixed},
            cut);
    v.list({.name = "attributes", .doc = "values of fluid.attributes that the particles of the block have", .fixed = kFixed}, attributes);
}

void BoxParams::visit(ParamVisitor& v) {
    v.value({"min", "m", "lower corner", -kMaxPosition, kMaxPosition, kLinear, kFixed}, min);
    v.value({"max", "m", "upper corner", -kMaxPosition, kMaxPosition, kLinear, kFixed}, max);
    v.value({"restitution", "", "share of the normal speed after impact on a wall: 0 = no rebound, 1 = full rebound", 0, 1}, restitution);
    v.value({.name = "periodicX",
             .doc = "whether the box is periodic along x, without walls: particles that leave on one side enter on the other",
             .fixed = kFixed},
            periodicX);
    v.value({.name = "periodicY", .doc = "whether the box is periodic along y", .fixed = kFixed}, periodicY);
    v.value({.name = "periodicZ", .doc = "whether the box is periodic along z", .fixed = kFixed}, periodicZ);
}

void CollisionParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> walks = {"exact", "thesis"};
    v.value({"friction", "", "Coulomb friction of walls, and of colliders without a value: 0 = slip", 0, 10}, friction);
    v.value(
        {"restitution", "", "share of the normal speed after impact on a collider without a value: 0 = no rebound, 1 = full rebound", 0, 1},
        restitution);
    v.choice(
        {.name = "walk",
         .doc = "collision test along a particle's path; exact: checks every voxel; thesis: as in the thesis, with its leaks and sticking",
         .fixed = kFixed},
        walk, walks);
    static const std::vector<std::string> kinds = {"slip", "no-slip"};
    v.choice({.name = "walls", .doc = "boundary condition of viscosity at walls; slip: none; no-slip: the fluid has the wall's velocity"},
             walls, kinds);
    layers.visit(v);
}

void FoamParams::visit(ParamVisitor& v) {
    v.value({"most", "", "limit on particles of spray, foam and bubbles (Ihmsen et al. 2012); 0 = none", 0, 4.0e6, kLog, kFixed}, most);
    v.value({"trappedAir", "1/s", "foam particles that a fluid particle spawns per second where water falls into water", 0, 1.0e5, kLog},
            trappedAir);
    v.value({"waveCrest", "1/s", "foam particles that a fluid particle spawns per second on a breaking crest", 0, 1.0e5, kLog}, waveCrest);
    v.value({"airFrom", "m/s", "mean approach speed of neighbours at which water begins to trap air", 0, 100}, airFrom);
    v.value({"airTo", "m/s", "mean approach speed of neighbours at which trapped air reaches its maximum; must be above airFrom", 0, 100},
            airTo);
    v.value({"crestFrom", "", "mean 1 - cos between the normals on a crest at which it begins to break", 0, 2}, crestFrom);
    v.value({"crestTo", "", "mean 1 - cos between the normals on a crest at which it breaks fully; must be above crestFrom", 0, 2},
            crestTo);
    v.value({"speedFrom", "m/s", "speed of water below which it spawns no foam", 0, 100}, speedFrom);
    v.value({"speedTo", "m/s", "speed of water at which it spawns the full amount; must be above speedFrom", 0, 100}, speedTo);
    v.value({"life", "s", "longest lifetime of foam on the water; the shortest is half of it", 0.05, 60, kLog}, life);
    v.value({"buoyancy", "", "upward acceleration of bubbles, as a multiple of gravity", 0, 20}, buoyancy);
    v.value({"drag", "1/s", "rate at which bubbles adopt the velocity of the water", 0, 1000}, drag);
}

void SleepParams::visit(ParamVisitor& v) {
    v.value({.name = "on",
             .doc = "whether particles of calm water fall asleep: they are not stepped until the water around them, a solid or a parameter "
                    "moves them; only where there is gravity",
             .fixed = kFixed},
            on);
    v.value({"speed", "", "rms speed below which water is calm, over sqrt(g h), h the support radius", 0, 1, kLog}, speed);
    v.value({"after", "", "time for which it must be calm, over sqrt(h / g)", 0.5, 1000, kLog}, after);
}

void WetnessParams::visit(ParamVisitor& v) {
    v.value({.name = "on",
             .doc = "whether solids that water touches are wet, darker and glossier, until they are dry again; bodies, and colliders that "
                    "do not change their shape",
             .fixed = kFixed},
            on);
    v.value({"dries", "s", "time in which the wetness of a surface without water falls to 1/e; shorter than in nature, where it is minutes",
             0.01, 1.0e5, kLog},
            dries);
    v.value(
        {"runs", "m",
         "distance below a wet place, along a slope, in which the wetness of the water that runs down falls to 1/e; 0 = none runs", 0, 10},
        runs);
}

namespace {

// A group of its own, because states of earlier versions lack it.
struct BodyRoom {
    int& maxSamples;
    void visit(ParamVisitor& v) {
        v.value({"maxSamples", "",
                 "memory for samples of bodies, including bodies added while the world runs: a body has about 1.25 for each square spacing "
                 "of its surface; 0 = those of the bodies at the start",
                 0, 16.0e6, kLog, kFixed},
                maxSamples);
    }
};

}  // namespace

void FluidParams::visit(ParamVisitor& v) {
    const std::vector<std::string> names = methods().names();
    v.choice({.name = "method", .doc = "pressure solver; rivulet list methods describes each", .fixed = kFixed}, method, names);
    static const std::vector<std::string> kernels = {"wendland", "cubic_spline"};
    v.choice({.name = "kernel", .doc = "smoothing kernel; cubic_spline: for comparison, only with method wcsph", .fixed = kFixed}, kernel,
             kernels);
    static const std::vector<std::string> grids = {"sorted", "linked_list"};
    v.choice({.name = "grid",
              .doc = "neighbour search; sorted: particles sorted by cell; linked_list: one list per cell, as in the thesis, for "
                     "comparison: only with method wcsph_thesis on gl or cl",
              .fixed = kFixed},
             grid, grids);
    v.value({"workGroup", "", "threads per work group of the kernels that build the grid, visit neighbours and collide, on gl and cl", 32,
             512, kLog, kFixed},
            workGroup);
    v.value({"spacing", "m", "distance between particles at rest: half the spacing needs eight times as many particles", 1.0e-5, 1, kLog,
             kFixed},
            spacing);
    v.value({"supportSpacings", "", "support radius of the kernel, in spacings: larger is smoother and slower", 1.5, 4, kLinear, kFixed},
            supportSpacings);
    visitLiquid(v, "liquid: its density and viscosity replace restDensity and viscosity; empty = restDensity and viscosity are used",
                liquid);
    v.value({"restDensity", "kg/m^3", "rest density; water 1000", 1, 100000, kLog}, restDensity);
    v.value({"viscosity", "m^2/s", "kinematic viscosity; water 1e-6, honey about 5e-3", 0, 10, kLog}, viscosity);
    v.value({"artificialViscosity", "",
             "artificial viscosity between approaching particles (Monaghan's alpha): 0.02 keeps a free surface calm", 0, 1},
            artificialViscosity);
    v.value({"soundSpeed", "m/s",
             "speed of sound of the weakly compressible methods; 0 = ten times the speed of the highest fall in the scene", 0, 3000},
            soundSpeed);
    v.value({"stiffness", "m^2/s^2", "k of the thesis's pressure k (density - rest density); only method wcsph_thesis", 0.01, 1.0e6, kLog},
            stiffness);
    v.value({"gravity", "m/s^2", "gravitational acceleration", -kMostGravity, kMostGravity}, gravity);
    v.value({"cfl", "", "CFL number: length of a substep over the time in which sound crosses a smoothing length", 0.01, 4, kLog}, cfl);
    v.value({"maxSubsteps", "", "limit on substeps per frame; beyond it simulated time slows down", 1, 100000, kLog}, maxSubsteps);
    v.value({"longestFrame", "s", "limit on the simulated time of one frame: the rest of a longer frame is dropped", 0.001, 10, kLog},
            longestFrame);
    v.value({.name = "ellipsoids",
             .doc = "whether particles are fitted with ellipsoids from their neighbours (Yu and Turk 2013), drawn with look.splats"},
            ellipsoids);
    v.value({"fixedStep", "s",
             "fixed time step, divided into as many substeps as it needs; pictures are interpolated between steps; 0 = one step per frame",
             0, 0.1},
            fixedStep);
    v.value(
        {"frameBudget", "ms", "limit on the computing time of a frame's steps; beyond it simulated time slows down; 0 = no limit", 0, 1000},
        frameBudget);
    v.value({.name = "limits",
             .doc = "whether substeps are kept stable and particles slower than one spacing per substep; off: every frame or fixedStep is "
                    "one step, to show where methods fail"},
            limits);
    vec3 place(origin);
    v.value({"origin", "m", "position of the scene's (0, 0, 0) in the host's world; all other positions are relative to it", -1.0e9, 1.0e9},
            place);
    if (place != vec3(origin)) origin = dvec3(place);  // a host's double stays
    v.value({"maxParticles", "",
             "limit on particles; emitters wait while it is reached; 0 = the particles of all blocks and of the emitters during the "
             "scene's duration",
             0, 64.0e6, kLog, kFixed},
            maxParticles);
    BodyRoom room{maxBodySamples};
    v.group({.name = "bodies", .doc = "rigid bodies, which are added while the world runs, too"}, room);
    for (const MethodRow& row : methods().rows)
        if (row.visit != nullptr) row.visit(*this, v);
    v.group({.name = "forces", .doc = "forces in addition to pressure and gravity"}, forces);
    v.group({.name = "foam", .doc = "spray, foam and bubbles"}, foam);
    v.group({.name = "sleep", .doc = "calm water that is not stepped"}, sleep);
    v.group({.name = "wetness", .doc = "wet surfaces of solids"}, wetness);
    v.group({.name = "box", .doc = "walls around the fluid; particles that leave the box are lost"}, box);
    v.group({.name = "collision", .doc = "contact of the fluid with solids"}, collision);
    v.list({.name = "blocks", .doc = "blocks of fluid at the start", .fixed = kFixed}, blocks);
    v.list(
        {.name = "attributes",
         .doc = "values of each particle that a host sets and its shader reads, at most 4; here those of particles without another value",
         .fixed = kFixed},
        attributes);
    v.list({.name = "probes", .doc = "force, torque and pressure of the fluid on walls and bodies, as results"}, probes);
}

}  // namespace rivulet
