#include "fluid/sim/world/fluid_params.h"

#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/liquids.h"

namespace rivulet {

namespace {
constexpr double kFar = 1.0e5;                // m; beyond this float32 no longer tells millimetres apart
constexpr double kFast = 1.0e3;               // m/s
constexpr bool kLog = true, kLinear = false;  // the slider's scale
constexpr bool kFixed = true;                 // until the scene is loaded anew
}  // namespace

void BlockParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "ball"};
    v.choice({.name = "shape", .doc = "all between min and max, or the ellipsoid that fits there", .fixed = kFixed}, shape, shapes);
    v.value({"min", "m", "low corner", -kFar, kFar, kLinear, kFixed}, min);
    v.value({"max", "m", "high corner", -kFar, kFar, kLinear, kFixed}, max);
    v.value({"velocity", "m/s", "at the start", -kFast, kFast, kLinear, kFixed}, velocity);
    v.value({.name = "liquid", .doc = "what it is of, a row of rivulet list liquids; empty = as fluid.liquid", .fixed = kFixed}, liquid);
    v.colour({"dye", "", "linear colour of the dye in it; white = none", 0, 1, kLinear, kFixed}, dye);
    v.value({"dyeAmount", "1/m", "how much dye: after 1 / this metres light has the dye's colour", 0, 1.0e4, kLog, kFixed}, dyeAmount);
    v.value(
        {"dyeScattering", "1/m", "how cloudy the dye makes it, on top: milk scatters about 3000; 0 = clear as ink", 0, 1.0e4, kLog, kFixed},
        dyeScattering);
    v.value({"jitter", "spacings",
             "how far particles may stand off their lattice at the start: a perfect one resists shear like a crystal until it is stirred",
             0, 0.5, kLinear, kFixed},
            jitter);
    v.value({.name = "cut",
             .doc = "whether it is meant to reach into solids, which cut it to shape; else a notice counts what they leave out",
             .fixed = kFixed},
            cut);
}

void BoxParams::visit(ParamVisitor& v) {
    v.value({"min", "m", "low corner", -kFar, kFar, kLinear, kFixed}, min);
    v.value({"max", "m", "high corner", -kFar, kFar, kLinear, kFixed}, max);
    v.value({"restitution", "", "share of the speed into a wall that comes back: 0 = stays, 1 = bounces", 0, 1}, restitution);
    v.value({.name = "periodicX",
             .doc = "whether the box has no walls along x: what leaves on one side comes in on the other",
             .fixed = kFixed},
            periodicX);
    v.value({.name = "periodicY", .doc = "the same along y", .fixed = kFixed}, periodicY);
    v.value({.name = "periodicZ", .doc = "the same along z", .fixed = kFixed}, periodicZ);
}

void CollisionParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> walks = {"exact", "thesis"};
    v.value({"friction", "", "Coulomb friction of walls, and of colliders that name none: 0 = slips", 0, 10}, friction);
    v.value({"restitution", "", "share of the speed into a collider that comes back, where it names none: 0 = stays, 1 = bounces", 0, 1},
            restitution);
    v.choice({.name = "walk",
              .doc = "exact: nothing passes a voxel; thesis: as the thesis walks and answers, leaks and sticking included",
              .fixed = kFixed},
             walk, walks);
    static const std::vector<std::string> kinds = {"slip", "no-slip"};
    v.choice({.name = "walls", .doc = "what viscosity does at walls: slip: nothing; no-slip: the fluid's velocity there is the wall's"},
             walls, kinds);
}

void FoamParams::visit(ParamVisitor& v) {
    v.value({"most", "", "spray, foam and bubbles (Ihmsen et al. 2012): how many at once; 0 = none", 0, 4.0e6, kLog, kFixed}, most);
    v.value({"trappedAir", "1/s", "how many a particle makes where water falls into water", 0, 1.0e5, kLog}, trappedAir);
    v.value({"waveCrest", "1/s", "how many a particle makes on a crest that breaks", 0, 1.0e5, kLog}, waveCrest);
    v.value({"airFrom", "m/s", "mean speed at which neighbours meet, from which on air is caught", 0, 100}, airFrom);
    v.value({"airTo", "m/s", "and from which on it is no more; above airFrom", 0, 100}, airTo);
    v.value({"crestFrom", "", "mean 1 - cos between normals on a crest, from which on it breaks", 0, 2}, crestFrom);
    v.value({"crestTo", "", "and from which on it does wholly; above crestFrom", 0, 2}, crestTo);
    v.value({"speedFrom", "m/s", "water that is slower makes none", 0, 100}, speedFrom);
    v.value({"speedTo", "m/s", "and from here on as much as it can; above speedFrom", 0, 100}, speedTo);
    v.value({"life", "s", "how long foam lies on the water, at most; some of it half as long", 0.05, 60, kLog}, life);
    v.value({"buoyancy", "", "of bubbles, over gravity", 0, 20}, buoyancy);
    v.value({"drag", "1/s", "how soon bubbles go with the water", 0, 1000}, drag);
}

void FluidParams::visit(ParamVisitor& v) {
    const std::vector<std::string> names = methods().names();
    v.choice({.name = "method", .doc = "how pressure is found; rivulet list says what each is", .fixed = kFixed}, method, names);
    static const std::vector<std::string> kernels = {"wendland", "cubic_spline"};
    v.choice(
        {.name = "kernel", .doc = "how neighbours are weighed; the cubic spline, for comparison, in method wcsph alone", .fixed = kFixed},
        kernel, kernels);
    static const std::vector<std::string> grids = {"sorted", "linked_list"};
    v.choice(
        {.name = "grid",
         .doc = "how neighbours are found. sorted: particles in the order of their cells; linked_list: a list a cell, as the thesis has "
                "it, for comparison: method wcsph_thesis on gl or cl alone",
         .fixed = kFixed},
        grid, grids);
    v.value({"workGroup", "", "threads in a work group of the kernels that build the grid, sweep neighbours and collide, on gl and cl", 32,
             512, kLog, kFixed},
            workGroup);
    v.value({"spacing", "m", "distance between particles at rest: halving it makes eight times as many", 1.0e-5, 1, kLog, kFixed}, spacing);
    v.value(
        {"supportSpacings", "", "reach of a particle (support radius), in spacings: more is smoother and slower", 1.5, 4, kLinear, kFixed},
        supportSpacings);
    v.value(
        {.name = "liquid",
         .doc = "a row of rivulet list liquids, whose density and viscosity hold instead of restDensity and viscosity; empty = these hold",
         .fixed = kFixed},
        liquid);
    v.value({"restDensity", "kg/m^3", "density at rest; water 1000", 1, 100000, kLog}, restDensity);
    v.value({"viscosity", "m^2/s", "kinematic viscosity; water 1e-6, honey about 5e-3", 0, 10, kLog}, viscosity);
    v.value({"artificialViscosity", "", "damping between particles that approach (Monaghan's alpha): 0.02 keeps a free surface calm", 0, 1},
            artificialViscosity);
    v.value(
        {"soundSpeed", "m/s", "speed of sound of the weakly compressible methods; 0 = ten times the fastest fall in the scene", 0, 3000},
        soundSpeed);
    v.value({"stiffness", "m^2/s^2", "k of the thesis's pressure k (density - rest density); method wcsph_thesis alone", 0.01, 1.0e6, kLog},
            stiffness);
    v.value({"gravity", "m/s^2", "acceleration of everything", -1000, 1000}, gravity);
    v.value({"cfl", "", "a step's length, as a share of the time that sound takes across a smoothing length", 0.01, 4, kLog}, cfl);
    v.value({"maxSubsteps", "", "steps in one frame at most; beyond that simulated time slows down", 1, 100000, kLog}, maxSubsteps);
    v.value({"longestFrame", "s", "of a longer frame only this is simulated: the rest is dropped", 0.001, 10, kLog}, longestFrame);
    v.value({.name = "ellipsoids",
             .doc = "whether the ellipsoids that stand for particles amid their neighbours are found (Yu and Turk 2013), to be drawn by "
                    "look.splats"},
            ellipsoids);
    v.value({"fixedStep", "s",
             "time goes on in whole steps of this length (each of as many substeps as it needs), and pictures show what is between; 0 = as "
             "frames come",
             0, 0.1},
            fixedStep);
    v.value({"frameBudget", "ms", "what a frame's steps may take; where they would take longer, simulated time slows down; 0 = no limit", 0,
             1000},
            frameBudget);
    v.value(
        {.name = "limits",
         .doc = "whether steps are kept as short as is stable and particles slower than a spacing a step; off: every frame or fixedStep is "
                "one step, to see where methods fail"},
        limits);
    vec3 place(origin);
    v.value({"origin", "m", "where the scene's (0, 0, 0) is in the host's world; all else in a scene is relative to it", -1.0e9, 1.0e9},
            place);
    if (place != vec3(origin)) origin = dvec3(place);  // a host's double stays
    v.value({"maxParticles", "",
             "room for so many; what more would come in waits. 0 = what blocks hold and emitters let out in the scene's duration", 0,
             64.0e6, kLog, kFixed},
            maxParticles);
    for (const MethodRow& row : methods().rows)
        if (row.visit != nullptr) row.visit(*this, v);
    v.group({.name = "forces", .doc = "beside pressure and gravity"}, forces);
    v.group({.name = "foam", .doc = "what the water carries, and is white"}, foam);
    v.group({.name = "box", .doc = "walls around the fluid; what leaves them is lost"}, box);
    v.group({.name = "collision", .doc = "how fluid meets what is solid"}, collision);
    v.list({.name = "blocks", .doc = "boxes of fluid that are there at the start", .fixed = kFixed}, blocks);
}

}  // namespace rivulet
