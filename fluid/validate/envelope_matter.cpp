// Rows of the stability envelope that do not depend on the step alone: pairing and clumping, coordinates far from zero, thin walls,
// overlapping particles, light bodies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "fluid/sim/sources/block.h"
#include "fluid/validate/envelope_run.h"
#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

constexpr double kHalfTurn = std::numbers::pi;

// Mean distance to the nearest neighbour, m; periodic where the box has no walls.
double nearestNeighbour(const FluidWorld& world) {
    const HostParticles all = readParticles(world);
    const BoxParams& box = world.params().box;
    double sum = 0;
    for (const vec4& a : all.position) {
        double nearest = 1e30;
        for (const vec4& b : all.position) {
            if (&a == &b) continue;
            dvec3 d = dvec3(a) - dvec3(b);
            for (int k = 0; k < 3; ++k) {
                const double period = double{box.max[k] - box.min[k]};
                if (box.periodic()[k]) d[k] -= period * std::round(d[k] / period);
            }
            nearest = std::min(nearest, glm::dot(d, d));
        }
        sum += std::sqrt(nearest);
    }
    return sum / static_cast<double>(all.position.size());
}

// Moves particles.
Status moveParticles(FluidWorld& world, const std::function<dvec3(const dvec3&)>& to) {
    return changeParticles(world, [&to](vec4& x, vec4&) { x = vec4(vec3(to(dvec3(x))), x.w); });
}

}  // namespace

Result<std::vector<EnvelopeFinding>> envelopeOfPairing(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("pairing", {});
    if (!scene) return scene.error();
    const double spacing = scene->fluid.spacing, edge = double{scene->fluid.box.max.x - scene->fluid.box.min.x};
    double particles = 0;
    for (const BlockParams& b : scene->fluid.blocks) particles += blockCount(b, scene->fluid.spacing);
    const double crowd = particles * std::pow(spacing / edge, 3);  // particles per volume of one
    std::vector<Sweep> sweeps;
    for (const char* kernel : {"cubic_spline", "wendland"})
        sweeps.push_back({.row = "pairing",
                          .method = "wcsph",
                          .what = fmt::format("neighbours, {}", kernel),
                          .unit = "",
                          .predicted = 55,
                          .least = 15,
                          .most = 267,
                          .criterion = "mean distance to the nearest neighbour below 0.7 spacings",
                          .run = [=](double at, bool) {
                              const double support = std::cbrt(at / crowd * 3 / (4 * kHalfTurn));
                              return StabilityRun{
                                  .scene = "pairing",
                                  .assignments = {fmt::format("fluid.kernel={}", kernel), fmt::format("fluid.supportSpacings={}", support)},
                                  .limits = true,
                                  .verdict = [=](Session& s) { return nearestNeighbour(s.world()) < 0.7 * spacing; }};
                          }});
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfClumping(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("clumping", {});
    if (!scene) return scene.error();
    const double spacing = scene->fluid.spacing;
    std::vector<Sweep> sweeps;
    for (const char* method : {"wcsph_thesis", "wcsph", "pbf", "dfsph"})
        sweeps.push_back(
            {.row = "clumping",
             .method = method,
             .what = "volume over the volume at rest",
             .unit = "",
             .predicted = 1,
             .least = 1,
             .most = 2,
             .criterion = "mean distance to the nearest neighbour below 0.8 spacings",
             .run = [=](double at, bool) {
                 return StabilityRun{
                     .scene = "clumping",
                     .assignments = {fmt::format("fluid.method={}", method)},
                     .limits = true,
                     .prepare = [at](Session& s) { return moveParticles(s.world(), [at](const dvec3& x) { return x * std::cbrt(at); }); },
                     .verdict = [=](Session& s) { return nearestNeighbour(s.world()) < 0.8 * spacing; }};
             }});
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfDistance(const EnvelopeSettings& settings) {
    constexpr double kSpeed = 0.1, kStep = 0.004, kDigits = 8388608;  // number of floats from a power of two to the next
    std::vector<Sweep> sweeps;
    for (const char* method : {"wcsph", "pbf", "dfsph"})
        sweeps.push_back({.row = "far_origin",
                          .method = method,
                          .what = "distance, 0.4 mm per step",
                          .unit = "m",
                          .predicted = 2 * kSpeed * kStep * kDigits,
                          .least = 100,
                          .most = 65536,
                          .criterion = "a hundredth of the path is covered, or less",
                          .run = [=](double at, bool limits) {
                              // With the limits on the same position is given as the world's origin.
                              const double away = std::floor(at), low = limits ? 0 : away;
                              std::vector<std::string> assignments = {fmt::format("fluid.method={}", method)};
                              if (limits) assignments.push_back(fmt::format("fluid.origin={},0,0", away));
                              for (const auto& [key, x] : {std::pair("box.min", 0.0), std::pair("box.max", 1.0),
                                                           std::pair("blocks.0.min", 0.5), std::pair("blocks.0.max", 0.57)})
                                  assignments.push_back(fmt::format("fluid.{}={},{},{}", key, low + x, x, x));
                              auto from = std::make_shared<double>(0);
                              const auto place = [](Session& s) { return double{readParticles(s.world()).position[0].x}; };
                              return StabilityRun{
                                  .scene = "far_origin",
                                  .assignments = assignments,
                                  .frame = kStep,
                                  .asFrames = true,
                                  .prepare =
                                      [=](Session& s) {
                                          *from = place(s);
                                          return ok();
                                      },
                                  .verdict = [=](Session& s) { return place(s) - *from < 0.01 * kSpeed * s.world().time(); }};
                          }});
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfTunnelling(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("tunnelling", {});
    if (!scene) return scene.error();
    const double speed = glm::length(scene->fluid.blocks[0].velocity), voxel = 0.25 * double{scene->fluid.spacing};
    const double turned = double{scene->colliders[0].rotation.z} * kHalfTurn / 180;
    const dvec3 up(-std::sin(turned), std::cos(turned), 0);
    std::vector<Sweep> sweeps;
    for (const auto& row : {std::pair("pbf", "exact"), std::pair("dfsph", "exact"), std::pair("dfsph", "thesis")}) {
        const char* const method = row.first;
        const char* const walk = row.second;
        sweeps.push_back({.row = "tunnelling",
                          .method = method,
                          .what = fmt::format("path per step, walk {}", walk),
                          .unit = "walls",
                          .predicted = 1,
                          .least = 0.25,
                          .most = 64,
                          .criterion = "a particle beyond the sheet, or lost",
                          .run = [=](double at, bool) {
                              return StabilityRun{
                                  .scene = "tunnelling",
                                  .assignments = {fmt::format("fluid.method={}", method), fmt::format("fluid.collision.walk={}", walk)},
                                  .frame = at * voxel / speed,
                                  .verdict = [=](Session& s) {
                                      for (const vec4& x : readParticles(s.world()).position)
                                          if (glm::dot(dvec3(x), up) < -2 * voxel) return true;
                                      return false;
                                  }};
                          }});
    }
    return sweepAll(settings, sweeps);
}

// Blocks in one place, compressed until `at` particles share the volume of one.
Result<std::vector<EnvelopeFinding>> envelopeOfSpawning(const EnvelopeSettings& settings) {
    const Result<SceneFile> scene = stabilityScene("spawning", {});
    if (!scene) return scene.error();
    const BlockParams& block = scene->fluid.blocks[0];
    const dvec3 middle = 0.5 * dvec3(block.min + block.max);
    std::vector<Sweep> sweeps;
    for (const auto& row : {std::pair("wcsph", 0.0005), std::pair("pbf", 1.0 / 240), std::pair("dfsph", 1.0 / 480)}) {
        const char* const method = row.first;
        const double step = row.second;
        sweeps.push_back({.row = "spawning",
                          .method = method,
                          .what = fmt::format("density when spawned, steps of {:.3g} ms", 1000 * step),
                          .unit = "",
                          .predicted = 2,
                          .least = 2,
                          .most = 16,
                          .criterion = "a value not finite, or a particle lost",
                          .run = [=](double at, bool) {
                              return StabilityRun{.scene = "spawning",
                                                  .assignments = {fmt::format("fluid.method={}", method)},
                                                  .frame = step,
                                                  .prepare = [=](Session& s) {
                                                      return moveParticles(s.world(), [=](const dvec3& x) {
                                                          return middle + (x - middle) * std::cbrt(2 / at);
                                                      });
                                                  }};
                          }});
    }
    return sweepAll(settings, sweeps);
}

Result<std::vector<EnvelopeFinding>> envelopeOfCoupling(const EnvelopeSettings& settings) {
    std::vector<Sweep> sweeps;
    for (const auto& row : {std::pair("wcsph", 0.0002), std::pair("pbf", 1.0 / 240), std::pair("dfsph", 1.0 / 480)}) {
        const char* const method = row.first;
        const double step = row.second;
        sweeps.push_back(
            {.row = "coupling",
             .method = method,
             .what = fmt::format("density of water over that of the ball, steps of {:.3g} ms", 1000 * step),
             .unit = "",
             .predicted = 2,
             .least = 0.01,
             .most = 100,
             .criterion = "the ball faster than 3 m/s, or a value not finite, or a particle lost",
             .run = [method, step](double at, bool) {
                 auto fast = std::make_shared<double>(0);
                 return StabilityRun{
                     .scene = "coupling",
                     .assignments = {fmt::format("fluid.method={}", method), fmt::format("bodies.0.density={}", 1000 / at)},
                     .frame = step,
                     .fails = [fast](const Seen&) { return !(*fast < 3); },
                     .each = [fast](Session& s) { *fast = std::max(*fast, double{glm::length(s.world().bodies()[0].velocity)}); }};
             }});
    }
    return sweepAll(settings, sweeps);
}

}  // namespace rivulet
