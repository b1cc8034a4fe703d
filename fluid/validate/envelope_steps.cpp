// Rows of the stability envelope whose limit is a step length: sound, viscosity, capillary waves, distance per step, long frames, the
// iterations of PBF and the warm start of DFSPH.
#include <fmt/format.h>

#include <cmath>

#include "fluid/sim/forces/force.h"
#include "fluid/validate/envelope_run.h"

namespace rivulet {

namespace {

double smoothing(const FluidParams& p) { return 0.5 * double{p.supportSpacings} * double{p.spacing}; }

// The speed at the floor after a fall from the top of the highest block.
double fallSpeed(const FluidParams& p) {
    double high = 0;
    for (const BlockParams& b : p.blocks) high = std::max(high, double{b.max.y - p.box.min.y});
    return std::sqrt(2 * glm::length(p.gravity) * high);
}

}  // namespace

Result<std::vector<EnvelopeFinding>> envelopeOfSound(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("sound", {});
    if (!scene) return scene.error();
    const double hs = smoothing(scene->fluid), v = fallSpeed(scene->fluid);
    std::vector<Sweep> sweeps;
    for (const double c0 : {30.0, 300.0})
        sweeps.push_back(stepSweep("sound", "wcsph", fmt::format("step, c0 = {} m/s", c0), 0.4 * hs / (c0 + v), kGainsEnergy,
                                   {.scene = "sound",
                                    .assignments = {fmt::format("fluid.soundSpeed={}", c0)},
                                    .seconds = c0 > 100 ? 0.1 : 0,
                                    .fails = gainsEnergy()}));
    // The thesis's lattice starts up to a half too dense, which stores energy: k (ln r + 1 / r - 1) per kilogram.
    const BlockParams& block = scene->fluid.blocks[0];
    const vec3 size = block.max - block.min;
    const double mass = double{scene->fluid.restDensity} * double{size.x} * double{size.y} * double{size.z};
    constexpr double kStiffness = 20;
    sweeps.push_back(stepSweep("sound", "wcsph_thesis", fmt::format("step, k = {} m^2/s^2", kStiffness),
                               0.4 * hs / (std::sqrt(kStiffness) + v), kGainsEnergy,
                               {.scene = "sound",
                                .assignments = {"fluid.method=wcsph_thesis", fmt::format("fluid.stiffness={}", kStiffness)},
                                .fails = gainsEnergy(mass * kStiffness * (std::log(1.5) + 1 / 1.5 - 1))}));
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfViscosity(const EnvelopeSettings& settings) {
    std::vector<Sweep> sweeps;
    for (const auto& [method, viscosity] :
         {std::pair("wcsph", 5.0), std::pair("wcsph", 1.0), std::pair("pbf", 5.0), std::pair("dfsph", 5.0)}) {
        const std::vector<std::string> assignments = {fmt::format("fluid.method={}", method), fmt::format("fluid.viscosity={}", viscosity)};
        const Result<SceneFile> scene = stabilityScene("viscosity", assignments);
        if (!scene) return scene.error();
        sweeps.push_back(stepSweep("viscosity", method, fmt::format("step, nu = {} m^2/s", viscosity), explicitViscousLimit(scene->fluid),
                                   kGainsEnergy, {.scene = "viscosity", .assignments = assignments, .fails = gainsEnergy()}));
    }
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfTension(const EnvelopeSettings& settings) {
    std::vector<Sweep> sweeps;
    for (const auto& [method, tension] : {std::pair("pbf", 10.0), std::pair("dfsph", 10.0), std::pair("dfsph", 0.1)}) {
        const std::vector<std::string> assignments = {fmt::format("fluid.method={}", method),
                                                      fmt::format("fluid.forces.tension={}", tension)};
        const Result<SceneFile> scene = stabilityScene("tension", assignments);
        if (!scene) return scene.error();
        const FluidParams& p = scene->fluid;
        const double edge = double{p.blocks[0].max.x - p.blocks[0].min.x};
        sweeps.push_back(stepSweep("tension", method, fmt::format("step, sigma = {} N/m", tension), capillaryLimit(p),
                                   "as much kinetic energy as the whole surface holds, or a value not finite, or a particle lost",
                                   {.scene = "tension",
                                    .assignments = assignments,
                                    .seconds = double{scene->duration} * std::sqrt(10 / tension),
                                    .fails = gainsEnergy(1 / 1.1 * tension * 6 * edge * edge)}));
    }
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfLargeSteps(const EnvelopeSettings& settings) {
    std::vector<Sweep> sweeps;
    for (const char* method : {"pbf", "dfsph"}) {
        const std::vector<std::string> assignments = {fmt::format("fluid.method={}", method)};
        const Result<SceneFile> scene = stabilityScene("large_steps", assignments);
        if (!scene) return scene.error();
        const double speed = double{scene->fluid.blocks[0].velocity.x - scene->fluid.blocks[1].velocity.x}, spacing = scene->fluid.spacing;
        sweeps.push_back(stepSweep("large_steps", method, fmt::format("step, blocks meet at {} m/s", speed), spacing / speed,
                                   kGainsEnergyOrIsSqueezed,
                                   {.scene = "large_steps", .assignments = assignments, .fails = gainsEnergyOrIsSqueezed()}));
    }
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfSpikes(const EnvelopeSettings& settings) {
    std::vector<Sweep> sweeps;
    const Result<SceneFile> scene = stabilityScene("frame_spike", {});
    if (!scene) return scene.error();
    // The column has fallen for kBefore when the long frame begins; in this step it falls (v + g dt) dt, which is set to a diameter.
    constexpr double kBefore = 0.04;
    const double g = glm::length(scene->fluid.gravity), v = g * kBefore;
    const double predicted = (std::sqrt(v * v + 4 * g * double{scene->fluid.spacing}) - v) / (2 * g);
    constexpr int kFrames = 10;
    for (const char* method : {"pbf", "dfsph"})
        sweeps.push_back({.row = "frame_spike",
                          .method = method,
                          .what = fmt::format("one frame after {} frames of {} ms", kFrames, 1000 * kBefore / kFrames),
                          .unit = "s",
                          .predicted = predicted,
                          .least = kBefore / kFrames,
                          .most = 0.25,
                          .ask = 0.25,
                          .criterion = kGainsEnergy,
                          .run = [method](double at, bool) {
                              return StabilityRun{.scene = "frame_spike",
                                                  .assignments = {fmt::format("fluid.method={}", method)},
                                                  .asFrames = true,
                                                  .fails = gainsEnergy(),
                                                  .frameOf = [at](int k) { return k == kFrames ? at : kBefore / kFrames; }};
                          }});
    return sweepAll(settings, sweeps);
}

// With k corrections per step and relaxation r, the weight of a column of height H compresses its floor by a g H dt^2 / (k r h^2); a, the
// diagonal of the lattice times h^2, is summed over the lattice.
Result<std::vector<EnvelopeFinding>> envelopeOfPbf(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("pbf", {});
    if (!scene) return scene.error();
    const FluidParams& p = scene->fluid;
    const double support = double{p.supportSpacings}, h = support * double{p.spacing}, g = glm::length(p.gravity);
    const double high = double{p.blocks[0].max.y - p.blocks[0].min.y};
    double shape = 0, squares = 0;  // of W h^3, and of h^4 |grad W|
    const int reach = static_cast<int>(std::ceil(support));
    for (int z = -reach; z <= reach; ++z)
        for (int y = -reach; y <= reach; ++y)
            for (int x = -reach; x <= reach; ++x) {
                const double q = std::sqrt(x * x + y * y + z * z) / support;
                if (q >= 1) continue;
                shape += std::pow(1 - q, 4) * (1 + 4 * q);
                squares += std::pow(20 * q * std::pow(1 - q, 3), 2);
            }
    const double diagonal = squares / (shape * shape);  // scaled to a lattice of density 1
    std::vector<Sweep> sweeps;
    for (const auto& [iterations, relaxation] : {std::pair(1, 0.5), std::pair(1, 1.0), std::pair(3, 1.0), std::pair(8, 1.0)}) {
        constexpr double kTooDense = 0.1;
        const double predicted = h * std::sqrt(kTooDense * iterations * relaxation / (diagonal * g * high));
        sweeps.push_back(stepSweep(
            "pbf", "pbf", fmt::format("step, {} iterations, relaxation {}", iterations, relaxation), predicted, kGainsEnergy,
            {.scene = "pbf",
             .assignments = {fmt::format("fluid.pbf.iterations={}", iterations), fmt::format("fluid.pbf.relaxation={}", relaxation)},
             .fails = gainsEnergy()}));
    }
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfDfsph(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("dfsph", {});
    if (!scene) return scene.error();
    std::vector<Sweep> sweeps;
    for (const double warm : {0.0, 0.5, 1.0})
        sweeps.push_back(stepSweep(
            "dfsph", "dfsph", fmt::format("step, warm start {}", warm), double{scene->fluid.spacing} / fallSpeed(scene->fluid),
            kGainsEnergy, {.scene = "dfsph", .assignments = {fmt::format("fluid.dfsph.warmStart={}", warm)}, .fails = gainsEnergy()}));
    return sweepAll(settings, sweeps);
}

}  // namespace rivulet
