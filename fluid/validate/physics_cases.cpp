#include <fmt/format.h>

#include <cmath>

#include "fluid/session/cpu_fallback.h"
#include "fluid/validate/surface.h"
#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

constexpr PhysicsCase kCases[] = {
    {"hydrostatic", "a pool at rest: pressure at gauges a support radius wide against rho g (H - z); the residual speed after 2 s",
     "fluid.spacing=0.025", runHydrostatic},
    {"dam_break", "front and height of a collapsing column: inviscid flow, Martin and Moyce 1952, Koshizuka and Oka 1996",
     "fluid.spacing=0.0017859375; fluid.box.max=0.3429,0.15,0.00714375; fluid.blocks.0.max=0.05715,0.1143,0.00714375", runDamBreak},
    {"poiseuille", "flow between plates, started from rest: series solution at 0.1 and 1 s", "fluid.spacing=2.5e-5", runPoiseuille},
    {"couette", "flow under a plate that starts to slide: series solution at 0.1 and 1 s", "fluid.spacing=2.5e-5", runCouette},
    {"taylor_green", "decay rate of vortices in a periodic box, Re = 100",
     "fluid.spacing=0.025; fluid.box.max=1,1,0.2; fluid.blocks.0.max=1,1,0.2", runTaylorGreen},
    {"standing_wave", "period of the lowest mode, w^2 = g k tanh(k H), and the viscosity of its decay",
     "fluid.spacing=0.0166666667; fluid.box.max=1,0.8,0.0666666667; fluid.blocks.0.max=1,0.5,0.0666666667", runStandingWave},
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
    Result<Trial> trial = Trial::open(row.name, settings);
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
    half.outcome = trial->outcome({}, {});
    return half;
}

}  // namespace

Table<PhysicsCase> physicsCases() { return {kCases}; }

std::vector<std::string> methodsOf(const PhysicsCase& row) {
    if (std::string_view(row.judged) == "flow") return {"flow", "flow_thesis"};
    if (row.run == runSurface) return surfaceMethods();
    return {"dfsph", "pbf", "wcsph", "wcsph_thesis"};
}

Result<Outcome> runCase(const PhysicsCase& row, const CaseSettings& settings, Device* cpu) {
    const bool compared = cpu != nullptr && !ownMethods(row);
    Result<Outcome> outcome = compared ? compareWithCpu(row, settings, *cpu) : row.run(settings);
    if (outcome)
        if (Status sound = stillWorks(*settings.device); !sound) return sound.error();
    if (outcome || ownMethods(row) || outcome.error().fault != Fault::badInput || settings.method == "dfsph") return outcome;
    // If dfsph accepts the case, the method has refused it; if not, the scene or the assignments are wrong.
    CaseSettings other = settings;
    other.method = "dfsph";
    if (!Trial::open(row.name, other)) return outcome;
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
