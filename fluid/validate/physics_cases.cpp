#include <fmt/format.h>

#include <cmath>

#include "fluid/session/chart_table.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/validate/known_misses.h"
#include "fluid/validate/surface.h"
#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

constexpr const char* kChannelTuned =
    "fluid.supportSpacings=2.3; fluid.artificialViscosity=0; fluid.forces.viscosity=implicit; fluid.forces.viscosityTolerance=1e-3";

// A lattice resists shear and carries loads, so tuned rows jitter the start. Steps of a quarter of the stable length, because pressure
// responds to the surface of the last step.
constexpr const char* kTensionTuned =
    "fluid.supportSpacings=2.3; fluid.artificialViscosity=0; fluid.blocks.0.jitter=0.3; fluid.dfsph.minSubsteps=59";

constexpr PhysicsCase kCases[] = {
    {.name = "hydrostatic",
     .doc = "a pool at rest: pressure at gauges a support radius wide against rho g (H - z); the residual speed after 2 s",
     .quick = "fluid.spacing=0.025",
     .run = runHydrostatic,
     .sizes = "fluid.spacing=0.0625 | "
              "fluid.spacing=0.05 | "
              "fluid.spacing=0.0357142857 | "
              "fluid.spacing=0.025"},
    {"dam_break", "front and height of a collapsing column: inviscid flow, Martin and Moyce 1952, Koshizuka and Oka 1996",
     "fluid.spacing=0.0017859375; fluid.box.max=0.3429,0.15,0.0089296875; fluid.blocks.0.max=0.05715,0.1143,0.0089296875", runDamBreak},
    {.name = "poiseuille",
     .doc = "flow between plates, started from rest: series solution at 0.1 and 1 s",
     .quick = "fluid.spacing=2.5e-5",
     .run = runPoiseuille,
     .sizes = "fluid.spacing=6.25e-05; fluid.box.max=0.000375,1e-3,0.000375; fluid.blocks.0.max=0.000375,1e-3,0.000375 | "
              "fluid.spacing=5e-05; fluid.box.max=0.0003,1e-3,0.0003; fluid.blocks.0.max=0.0003,1e-3,0.0003 | "
              "fluid.spacing=3.57142857e-05; fluid.box.max=0.000214285714,1e-3,0.000214285714; "
              "fluid.blocks.0.max=0.000214285714,1e-3,0.000214285714 | "
              "fluid.spacing=2.5e-05; fluid.box.max=0.00015,1e-3,0.00015; fluid.blocks.0.max=0.00015,1e-3,0.00015"},
    {.name = "couette",
     .doc = "flow under a plate that starts to slide: series solution at 0.1 and 1 s",
     .quick = "fluid.spacing=2.5e-5",
     .run = runCouette,
     .sizes = "fluid.spacing=6.25e-05; fluid.box.max=0.000375,1.2e-3,0.000375; fluid.blocks.0.max=0.000375,1e-3,0.000375 | "
              "fluid.spacing=5e-05; fluid.box.max=0.0003,1.2e-3,0.0003; fluid.blocks.0.max=0.0003,1e-3,0.0003 | "
              "fluid.spacing=3.57142857e-05; fluid.box.max=0.000214285714,1.2e-3,0.000214285714; "
              "fluid.blocks.0.max=0.000214285714,1e-3,0.000214285714 | "
              "fluid.spacing=2.5e-05; fluid.box.max=0.00015,1.2e-3,0.00015; fluid.blocks.0.max=0.00015,1e-3,0.00015"},
    {.name = "poiseuille_mesh",
     .doc = "flow between meshes in place of the box's walls: the same series",
     .quick = "fluid.spacing=2.5e-5",
     .run = runPoiseuilleMesh},
    {.name = "pipe",
     .doc = "flow in a pipe, a mesh, started from rest: series solution at 0.1 and 1 s",
     .quick = "fluid.spacing=2.5e-5",
     .run = runPipe},
    {.name = "taylor_green",
     .doc = "decay rate of vortices in a periodic box, Re = 100",
     .quick = "fluid.spacing=0.025; fluid.box.max=1,1,0.2; fluid.blocks.0.max=1,1,0.2",
     .run = runTaylorGreen,
     .sizes = "fluid.spacing=0.0625; fluid.box.max=1,1,0.5; fluid.blocks.0.max=1,1,0.5 | "
              "fluid.spacing=0.05; fluid.box.max=1,1,0.4; fluid.blocks.0.max=1,1,0.4 | "
              "fluid.spacing=0.0357142857; fluid.box.max=1,1,0.285714286; fluid.blocks.0.max=1,1,0.285714286 | "
              "fluid.spacing=0.025; fluid.box.max=1,1,0.2; fluid.blocks.0.max=1,1,0.2"},
    {.name = "standing_wave",
     .doc = "period of the lowest mode, w^2 = g k tanh(k H), and the viscosity of its decay",
     .quick = "fluid.spacing=0.0166666667; fluid.box.max=1,0.8,0.0833333335; fluid.blocks.0.max=1,0.5,0.0833333335",
     .run = runStandingWave,
     .sizes = "fluid.spacing=0.05; fluid.box.max=1,0.8,0.25; fluid.blocks.0.max=1,0.5,0.25 | "
              "fluid.spacing=0.0357142857; fluid.box.max=1,0.8,0.178571429; fluid.blocks.0.max=1,0.5,0.178571429 | "
              "fluid.spacing=0.025; fluid.box.max=1,0.8,0.125; fluid.blocks.0.max=1,0.5,0.125 | "
              "fluid.spacing=0.0178571429; fluid.box.max=1,0.8,0.0892857145; fluid.blocks.0.max=1,0.5,0.0892857145"},
    {"momentum", "two drops collide without gravity: drift of momentum and angular momentum", "fluid.spacing=0.035", runMomentum},
    {"floating", "floating and sinking boxes: draught against Archimedes, impulse between water and boxes", "fluid.spacing=0.0125",
     runFloating},
    {"spheric2", "a dam break against a box: pressures and heights against the measurements of Kleefsman et al. 2005",
     "fluid.spacing=0.0454545455; duration=2", runSpheric2},
    {"tension", "drops without gravity: pressure against 2 sigma / R, frequency of oscillation against Lamb 1932", "fluid.spacing=0.0025",
     runTension},
    {"flow", "drops and films on skins: Nusselt 1916, Furmidge 1962, Le Grand et al. 2005, one path for every UV layout, the ledger", "",
     runFlow, "flow"},
    {"surface", "the drawn surface against a sphere, a plane and the ray-marched reference, and the flicker of a pool at rest", "",
     runSurface, "narrow_range"},
    {.name = "sloshing",
     .doc = "gravity tilts at t = 0: period and decay of the first mode, H/L 0.2 and 0.5, with and without side walls, waves of 0.5 to 3 "
            "spacings (Lamb 1932)",
     .quick = "fluid.box.max=1,0.8,0.08; fluid.blocks.0.max=1,0.2,0.08",
     .run = runSloshing,
     .everyMethod = true,
     .sizes = "fluid.spacing=0.04; fluid.box.max=1,0.8,0.16; fluid.blocks.0.max=1,0.2,0.16 | "
              "fluid.spacing=0.0333333333; fluid.box.max=1,0.8,0.133333333; fluid.blocks.0.max=1,0.2,0.133333333 | "
              "fluid.spacing=0.025; fluid.box.max=1,0.8,0.1; fluid.blocks.0.max=1,0.2,0.1 | "
              "fluid.spacing=0.02; fluid.box.max=1,0.8,0.08; fluid.blocks.0.max=1,0.2,0.08"},
    {.name = "u_tube",
     .doc = "unequal levels in two arms 6, 10 and 20 spacings wide: period, T = 2 pi sqrt(L / 2 g), and the levels at rest",
     .quick = "duration=3",
     .run = runUTube,
     .everyMethod = true},
    {.name = "cavity",
     .doc = "flow in a closed box under a moving lid, Re = 100: the profile of Ghia, Ghia and Shin 1982",
     .quick = "fluid.spacing=0.005; fluid.box.max=0.1,0.12,0.03; fluid.blocks.0.max=0.1,0.1,0.03; duration=1.5",
     .run = runCavity,
     .everyMethod = true,
     .sizes = "fluid.spacing=0.00714285714; fluid.box.max=0.1,0.12,0.0428571429; fluid.blocks.0.max=0.1,0.1,0.0428571429 | "
              "fluid.spacing=0.005; fluid.box.max=0.1,0.12,0.03; fluid.blocks.0.max=0.1,0.1,0.03 | "
              "fluid.spacing=0.00357142857; fluid.box.max=0.1,0.12,0.0214285714; fluid.blocks.0.max=0.1,0.1,0.0214285714 | "
              "fluid.spacing=0.0025; fluid.box.max=0.1,0.12,0.015; fluid.blocks.0.max=0.1,0.1,0.015"},
    {.name = "cavity_400",
     .doc = "flow in a trough that slides under a wall at rest, Re = 400: the profile of Ghia, Ghia and Shin 1982",
     .quick = "fluid.spacing=0.005; fluid.box.max=2.2,0.1,0.03; fluid.blocks.0.max=0.1,0.1,0.03; duration=2.5",
     .run = runCavity400,
     .everyMethod = true},
    {.name = "drag",
     .doc = "a sphere held in a stream at Re 20, 100 and 200: drag coefficient (Schiller and Naumann 1935)",
     .quick = "fluid.spacing=0.00909090909; fluid.box.max=0.290909091,0.181818182,0.181818182; "
              "fluid.blocks.0.max=0.290909091,0.181818182,0.181818182; colliders.0.position=0.1,0.0909090909,0.0909090909",
     .run = runDrag,
     .everyMethod = true},
    {.name = "drag_cylinder",
     .doc = "a cylinder held across a stream at Re 20 and 40: drag coefficient (Dennis and Chang 1970)",
     .quick = "fluid.spacing=0.01; fluid.box.max=0.6,0.36,0.06; fluid.blocks.0.max=0.6,0.36,0.06; colliders.0.position=0.2,0.18,0.03",
     .run = runDragCylinder,
     .everyMethod = true},
    {.name = "rotating_patch",
     .doc = "a square turns without gravity (Colagrossi 2005): it stays in one piece and keeps its area",
     .quick = "fluid.spacing=0.04; fluid.box.max=2,2,0.24; fluid.blocks.0.max=0.5,0.5,0.24",
     .run = runRotatingPatch,
     .everyMethod = true},
    {.name = "siphon",
     .doc = "water flows over a weir above both levels until they are equal; water inside the hood is under tension",
     .quick = "",
     .run = runSiphon},
    {.name = "elliptical_drop",
     .doc = "a cylinder of water stretches without gravity (Monaghan 1994): its semi-axes, and its kinetic energy",
     .quick = "fluid.spacing=0.0625; fluid.box.max=3,3,0.375; fluid.blocks.0.max=1,1,0.375",
     .run = runEllipticalDrop,
     .everyMethod = true,
     .sizes = "fluid.spacing=0.1; fluid.box.max=3,3,0.6; fluid.blocks.0.max=1,1,0.6 | "
              "fluid.spacing=0.0714285714; fluid.box.max=3,3,0.428571429; fluid.blocks.0.max=1,1,0.428571429 | "
              "fluid.spacing=0.05; fluid.box.max=3,3,0.3; fluid.blocks.0.max=1,1,0.3 | "
              "fluid.spacing=0.0357142857; fluid.box.max=3,3,0.214285714; fluid.blocks.0.max=1,1,0.214285714"},
    {.name = "pool", .doc = "a pool at rest: the speed that is left after 4 s", .quick = "", .run = runPool, .everyMethod = true},
    {.name = "submerged",
     .doc = "a sphere under water: released, its acceleration by added mass (Lamb 1932); held, its weight; as dense as water, it stays",
     .quick = "fluid.spacing=0.0125; fluid.box.max=0.3,0.4,0.3; fluid.blocks.0.max=0.3,0.275,0.3",
     .run = runSubmerged,
     .everyMethod = true},
    {.name = "hydrostatic_tuned",
     .doc = "hydrostatic with a tighter solver and more artificial viscosity",
     .quick = "",
     .run = runHydrostatic,
     .judged = "",
     .of = "hydrostatic",
     .tuned = "fluid.artificialViscosity=0.05; fluid.dfsph.tolerance=1e-4"},
    {.name = "poiseuille_tuned",
     .doc = "poiseuille with a larger support radius, a tight solver of viscosity and no artificial viscosity",
     .quick = "",
     .run = runPoiseuille,
     .judged = "",
     .of = "poiseuille",
     .tuned = kChannelTuned},
    {.name = "couette_tuned",
     .doc = "couette with a larger support radius, a tight solver of viscosity and no artificial viscosity",
     .quick = "",
     .run = runCouette,
     .judged = "",
     .of = "couette",
     .tuned = kChannelTuned},
    {.name = "taylor_green_tuned",
     .doc = "taylor_green with many neighbours, jittered start positions and no artificial viscosity",
     .quick = "",
     .run = runTaylorGreen,
     .judged = "",
     .of = "taylor_green",
     .tuned = "fluid.supportSpacings=4; fluid.artificialViscosity=0; fluid.blocks.0.jitter=0.5"},
    {.name = "standing_wave_tuned",
     .doc = "standing_wave with jittered start positions and no artificial viscosity",
     .quick = "",
     .run = runStandingWave,
     .judged = "",
     .of = "standing_wave",
     .tuned = "fluid.artificialViscosity=0; fluid.blocks.0.jitter=0.3"},
    {.name = "tension_tuned",
     .doc = "tension with a larger support radius, jittered start positions, short steps and no artificial viscosity",
     .quick = "",
     .run = runTension,
     .judged = "",
     .of = "tension",
     .tuned = kTensionTuned},
};

// Cases that are not run as a scene of particles on a device.
bool ownMethods(const PhysicsCase& row) { return row.run == runFlow || row.run == runSurface; }

struct Half {
    dvec3 centre{0.0};
    double kinetic = 0, mostKinetic = 0, compression = 0;
    Outcome outcome;
    bool done = false;
};

double kineticOf(const HostParticles& all) {
    double sum = 0;
    for (size_t i = 0; i < all.velocity.size(); ++i)
        sum += 0.5 * double{all.mass[i]} * glm::dot(glm::dvec3(all.velocity[i]), glm::dvec3(all.velocity[i]));
    return sum;
}

// Half a second of a case at its quick size. Figures are computed from the particles, not from delayed statistics.
Result<Half> halfSecond(const PhysicsCase& row, CaseSettings settings, Device& device) {
    settings.device = &device;
    settings.quick = true;
    settings.assignments.emplace_back("duration=0.5");
    Result<Trial> trial = Trial::open(row.sceneName(), settings);
    if (!trial) return trial.error();
    Half half;
    double compression = 0;
    int frames = 0;
    half.done = trial->run(1.0 / 60, [&] {
        const HostParticles all = trial->particles();
        double sum = 0;
        for (const vec4& x : all.position) sum += std::max(double{x.w} - 1, 0.0);
        compression += sum / static_cast<double>(std::max<size_t>(all.position.size(), 1));
        half.mostKinetic = std::max(half.mostKinetic, kineticOf(all));
        ++frames;
    });
    const HostParticles all = trial->particles();
    double mass = 0;
    for (size_t i = 0; i < all.position.size(); ++i) {
        mass += double{all.mass[i]};
        half.centre += double{all.mass[i]} * dvec3(all.position[i]);
    }
    half.kinetic = kineticOf(all);
    half.centre /= std::max(mass, 1e-30);
    half.compression = compression / std::max(frames, 1);
    Result<Outcome> outcome = trial->outcome({}, {});
    if (!outcome) return outcome.error();
    half.outcome = std::move(*outcome);
    return half;
}

}  // namespace

Table<PhysicsCase> physicsCases() { return {kCases}; }

std::vector<std::string> methodsOf(const PhysicsCase& row) {
    if (std::string_view(row.judged) == "flow") return {"flow", "flow_thesis"};
    if (row.run == runSurface) return surfaceMethods();
    if (*row.of != '\0') return {"dfsph"};
    return {"dfsph", "pbf", "wcsph", "wcsph_thesis"};
}

bool judges(const PhysicsCase& row, std::string_view method) {
    return method == row.judged || (row.everyMethod && (method == "pbf" || method == "wcsph"));
}

double toleranceOf(const CaseSettings& settings) { return settings.method == "dfsph" ? 0.05 : 0.1; }

Result<Outcome> runCase(const PhysicsCase& row, const CaseSettings& asked, Device* cpu) {
    CaseSettings settings = asked;
    const std::vector<std::string> tuned = assignmentsOf(row.tuned);
    settings.assignments.insert(settings.assignments.begin(), tuned.begin(), tuned.end());
    const bool compared = cpu != nullptr && !ownMethods(row);
    Result<Outcome> outcome = compared ? compareWithCpu(row, settings, *cpu) : row.run(settings);
    if (outcome)
        if (Status sound = stillWorks(*settings.device); !sound) return sound.error();
    if (outcome)
        for (Finding& f : outcome->findings)
            if (!f.pass()) f.known = knownMiss(row.name, settings.method, f.what);
    if (outcome || ownMethods(row) || outcome.error().fault != Fault::badInput || settings.method == "dfsph") return outcome;
    // If dfsph accepts the case, the method has refused it; if not, the scene or the assignments are wrong.
    CaseSettings other = settings;
    other.method = "dfsph";
    if (!Trial::open(row.sceneName(), other)) return outcome;
    Outcome refused;
    refused.method = settings.method;
    refused.refused = outcome.error().message;
    refused.findings.push_back({"refused: " + refused.refused, "", std::nan(""), std::nan(""), std::nan(""), {}});
    return refused;
}

Result<Outcome> compareWithCpu(const PhysicsCase& row, const CaseSettings& settings, Device& cpu) {
    const Result<Half> here = halfSecond(row, settings, cpu), there = halfSecond(row, settings, *settings.device);
    if (!here) return here.error();
    if (!there) return there.error();
    Outcome o = there->outcome;
    if (!here->done || !there->done) return o;
    const double far = glm::length(here->centre), near = glm::length(there->centre), apart = glm::length(there->centre - here->centre);
    const auto finding = [&](const char* what, const char* unit, double measured, double reference, double error) {
        o.findings.push_back({what, unit, measured, reference, error, 0.01});
    };
    finding("centre of mass against the cpu's", "m", near, far, apart / std::max(far, 1e-30));
    finding("kinetic energy against the cpu's", "J", there->kinetic, here->kinetic,
            std::abs(there->kinetic - here->kinetic) / std::max(here->mostKinetic, 1e-30));
    finding("mean compression against the cpu's", "", there->compression, here->compression,
            std::abs(there->compression - here->compression) / std::max(here->compression, 1e-30));
    return o;
}

}  // namespace rivulet
