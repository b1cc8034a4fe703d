#include "fluid/validate/gpu_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <limits>
#include <optional>

#include "engine/core/timeline.h"
#include "fluid/flow/surface_flow.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/scene/solids_bullet.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/host_particles.h"
#include "fluid/validate/flow_shapes.h"

namespace rivulet {

namespace {

constexpr int kSteps = 10;
constexpr double kStep = 1.0 / 1600;  // s: one substep for every method at this spacing
// The parity tests allow a step 1e-4 of the spacing. Ten steps carry on what rounding began; a kernel that is wrong moves particles by a
// spacing.
constexpr double kPositionLimit = 0.01;  // spacings
constexpr double kSpeedLimit = 0.01;     // of the speed of a fall by the height of the water
constexpr float kSpacing = 0.05F;        // m

struct State {
    std::vector<vec4> position, velocity;  // by id
};
Result<State> stateAfter(Device& device, const FluidParams& params) {
    Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(device, params, {}, {});
    if (!world) return world.error();
    for (int k = 0; k < kSteps; ++k) {
        (*world)->step({.gravity = params.gravity}, kStep);
        if (Status stepped = (*world)->lastStep(); !stepped) return stepped.error();
    }
    const HostParticles now = readParticles(**world);
    State state;
    const uint32_t most = now.id.empty() ? 0 : *std::max_element(now.id.begin(), now.id.end());
    const vec4 none(std::numeric_limits<float>::quiet_NaN());
    state.position.assign(size_t{most} + 1, none);
    state.velocity.assign(size_t{most} + 1, none);
    for (size_t i = 0; i < now.id.size(); ++i) {
        state.position[now.id[i]] = now.position[i];
        state.velocity[now.id[i]] = now.velocity[i];
    }
    return state;
}

// `most` is the larger of both; infinite where one is not a number.
void raise(double& most, double value) {
    if (!(value <= most)) most = std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
}

// The largest distance; infinite where one of the two has other particles, or no numbers.
double farthest(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) raise(most, double{glm::length(vec3(a[i]) - vec3(b[i]))});
    return most;
}

// Bodies in contact, in water: on a floor stands a box of twice water's density, and another falls on it. Positions of particles that touch
// bodies part soon, by rounding; what is compared is where the boxes are when they have come to rest.
constexpr float kBox = 0.2F;           // m, its edge
constexpr int kPileFrames = 15;        // frames of 1/60 s
constexpr double kHeightLimit = 0.05;  // of the edge
constexpr double kLeanLimit = 0.1;     // of the edge: how far one has gone sideways
Result<std::optional<std::vector<vec3>>> pileAfter(Device& device, double until) {
    FluidParams p;
    p.method = "pbf";
    p.spacing = kSpacing;
    p.fixedStep = 1.0F / 240;
    p.box.max = vec3(0.4F, 0.6F, 0.4F);
    p.blocks = {{vec3(0.0F), vec3(0.4F, 0.2F, 0.4F), vec3(0.0F)}};
    Solids solids;
    std::vector<BodyForm> forms(2);
    for (size_t k = 0; k < forms.size(); ++k) {
        Body& body = solids.bodies.emplace_back();
        body.shape = boxShape(vec3(kBox), 2000, kSpacing);
        body.state.pose.position = vec3(0.2F, kBox * (0.5F + 1.15F * static_cast<float>(k)), 0.2F);
        forms[k].size = vec3(kBox);
    }
    BulletSolids contacts({.box = p.box, .planes = {}, .still = {}, .moving = {}, .poses = {}}, solids.bodies, forms);
    solids.bodyHost = contacts.host();
    Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(device, p, solids, {});
    if (!world) return world.error();
    for (int k = 0; k < kPileFrames; ++k) {
        if (hostSeconds() > until) return std::optional<std::vector<vec3>>();
        (*world)->step({.gravity = p.gravity}, 1.0 / 60);
        device.finish();
        device.poll();
        if (Status stepped = (*world)->lastStep(); !stepped) return stepped.error();
    }
    std::vector<vec3> places;
    for (const BodyState& state : (*world)->bodies()) places.push_back(state.pose.position);
    return std::optional(std::move(places));
}

// Drops on a skin, which run down, merge and leave trails: how much of them is still drops, and where the middle of that is.
constexpr float kSkinRadius = 0.03F;  // m, the skin's radius
constexpr int kRunning = 30;          // frames of 1/60 s
constexpr double kDropsLimit = 0.05;  // of their volume: two that cross one cell share it in the order of the threads, by 2.8 % at most
constexpr double kPlaceLimit = 0.03;  // of the radius
struct Drops {
    double volume = 0;  // m^3
    dvec3 middle{0.0};  // m
};
Result<std::optional<Drops>> dropsAfter(Device& device, double until) {
    Result<FlowMesh> mesh = makeFlowMesh(ballShape(kSkinRadius, 16).view());
    if (!mesh) return mesh.error();
    SurfaceFlowParams p;
    p.capacity = 256;
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*mesh), p);
    if (!flow) return flow.error();
    for (int k = 0; k < kRunning; ++k) {
        if (hostSeconds() > until) return std::optional<Drops>();
        if (k % 2 == 0) {
            const double angle = 0.7 * k;
            const vec3 at = kSkinRadius * glm::normalize(vec3(dvec3(0.5 * std::cos(angle), 0.7, 0.5 * std::sin(angle))));
            flow->add(nearestPoint(flow->mesh(), at), 10000000 + 500000U * static_cast<uint32_t>(k % 7));
        }
        if (Status stepped = flow->step({}, 1.0 / 60); !stepped) return stepped.error();
        device.finish();
        device.poll();
    }
    Drops drops;
    for (const SkinDrop& drop : flow->drops()) {
        drops.volume += drop.volume;
        drops.middle += drop.volume * dvec3(drop.position);
    }
    drops.middle /= drops.volume;  // no drop at all: not a number, which does not pass
    return std::optional(drops);
}

Result<bool> checkWater(Device& device, Device& cpu, const char* name, const FluidParams& params, std::vector<GpuFinding>& found) {
    const Result<State> here = stateAfter(cpu, params), there = stateAfter(device, params);
    if (!here) return here.error();
    if (!there) return there.error();
    const double fall = std::sqrt(2 * 9.81 * 1.0);
    found.push_back({backendName(device.backend()), fmt::format("{}: largest difference of positions after {} steps", name, kSteps),
                     "spacings", farthest(here->position, there->position) / double{params.spacing}, kPositionLimit});
    found.push_back({backendName(device.backend()), fmt::format("{}: largest difference of velocities after {} steps", name, kSteps),
                     "times the speed after a fall of 1 m", farthest(here->velocity, there->velocity) / fall, kSpeedLimit});
    return true;
}

// True if there was time for it.
Result<bool> checkBodies(Device& device, Device& cpu, double until, std::vector<GpuFinding>& found) {
    const Result<std::optional<std::vector<vec3>>> expected = pileAfter(cpu, until), got = pileAfter(device, until);
    if (!expected) return expected.error();
    if (!got) return got.error();
    const std::optional<std::vector<vec3>>&here = *expected, &there = *got;
    if (!here || !there) return false;
    double high = 0, aside = 0;
    for (size_t k = 0; k < here->size(); ++k) {
        const dvec3 apart(there->at(k) - here->at(k));
        raise(high, std::abs(apart.y) / double{kBox});
        raise(aside, std::hypot(apart.x, apart.z) / double{kBox});
    }
    const char* name = backendName(device.backend());
    found.push_back({name, "bodies in contact in water: largest difference of heights at rest", "times a body's edge", high, kHeightLimit});
    found.push_back(
        {name, "bodies in contact in water: largest difference of horizontal positions at rest", "times a body's edge", aside, kLeanLimit});
    return true;
}

Result<bool> checkDrops(Device& device, Device& cpu, double until, std::vector<GpuFinding>& found) {
    const Result<std::optional<Drops>> expected = dropsAfter(cpu, until), got = dropsAfter(device, until);
    if (!expected) return expected.error();
    if (!got) return got.error();
    const std::optional<Drops>&here = *expected, &there = *got;
    if (!here || !there) return false;
    const char* name = backendName(device.backend());
    found.push_back({name, fmt::format("drops on a skin: difference of their volume after {} steps", kRunning), "of the cpu's volume",
                     std::abs(there->volume / here->volume - 1), kDropsLimit});
    found.push_back({name, fmt::format("drops on a skin: distance between their centres of mass after {} steps", kRunning),
                     "times the skin's radius", glm::length(there->middle - here->middle) / double{kSkinRadius}, kPlaceLimit});
    return true;
}

}  // namespace

FluidParams oneStepDam(const char* method, float spacing) {
    FluidParams p;
    p.method = method;
    p.spacing = spacing;
    p.box.max = vec3(1.0F, 1.2F, 1.0F);
    p.blocks = {{vec3(0.0F), vec3(0.5F, 1.0F, 0.5F), vec3(0.0F)}};
    p.soundSpeed = 15;
    p.pbf.reach = p.dfsph.reach = 1;
    p.dfsph.tolerance = 1.0e-6F;
    p.dfsph.maxIterations = 3;
    return p;
}

std::string GpuFinding::sentence() const {
    if (!error.empty()) return fmt::format("{}: {}: {}", device, what, error);
    return fmt::format("{}: {}: {:.3g} {}; at most {:.2g} is allowed", device, what, difference, unit, limit);
}

std::vector<GpuFinding> checkDevice(Device& device, Device& cpu, double until, std::vector<std::string>& leftOut) {
    std::vector<GpuFinding> found;
    FluidParams forces = oneStepDam("dfsph", kSpacing);
    forces.forces.tension = 0.07F;
    forces.forces.vorticity = 0.1F;
    forces.viscosity = 1.0e-3F;
    const auto water = [&](const char* name, const FluidParams& params) { return checkWater(device, cpu, name, params, found); };
    const std::pair<const char*, std::function<Result<bool>()>> checks[] = {
        {"wcsph", [&] { return water("wcsph", oneStepDam("wcsph", kSpacing)); }},
        {"pbf", [&] { return water("pbf", oneStepDam("pbf", kSpacing)); }},
        {"dfsph", [&] { return water("dfsph", oneStepDam("dfsph", kSpacing)); }},
        {"dfsph with tension and vorticity", [&] { return water("dfsph with tension and vorticity", forces); }},
        {"bodies in contact in water", [&] { return checkBodies(device, cpu, until, found); }},
        {"drops on a skin", [&] { return checkDrops(device, cpu, until, found); }}};
    const char* backend = backendName(device.backend());
    bool lost = false, compared = false;
    for (const auto& [name, check] : checks) {
        const size_t before = found.size();
        Result<bool> done = !lost && (!compared || hostSeconds() <= until) ? check() : Result<bool>(false);
        device.finish();
        device.poll();
        if (!lost && device.health().state == DeviceHealth::lost) {  // it computes nothing: what was found then is no difference
            lost = true;
            if (done) done = stillWorks(device).error();
        }
        if (!done) {
            found.resize(before);
            found.push_back({.device = backend, .what = name, .unit = {}, .error = done.error().message});
            device.forgiveFull();
        } else if (*done) {
            compared = true;
        } else {
            leftOut.push_back(fmt::format("{}: comparison of {}", backend, name));
        }
    }
    return found;
}

Result<GpuFinding> checkPicture(FluidWorld& world) {
    constexpr int kWidth = 320, kHeight = 180;
    constexpr int kChanged = 8;  // of 255: a pixel that shows water
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    if (!renderer) return renderer.error();
    const Bounds bounds{world.params().box.min, world.params().box.max};
    scene->camera.target = 0.5F * (bounds.min + bounds.max);
    scene->camera.position = scene->camera.target + 2.2F * glm::length(bounds.max - bounds.min) * glm::normalize(vec3(0.5F, 0.4F, 1.0F));
    const FrameView view = frameViewOf(cameraOf(scene->camera, bounds), scene->light, kWidth, kHeight, 0);
    FluidUpload upload;
    const Result<FluidView> fluid = upload.view(world, scene->look);
    if (!fluid) return fluid.error();
    FluidView dry = *fluid;
    dry.count = 0;
    if (Status drawn = (*renderer)->draw(view, dry, {}, *scene); !drawn) return drawn.error();
    const std::vector<uint8_t> without = (*renderer)->pixels();
    if (Status drawn = (*renderer)->draw(view, *fluid, {}, *scene); !drawn) return drawn.error();
    const std::vector<uint8_t> with = (*renderer)->pixels();

    std::vector<bool> covered(size_t{kWidth} * kHeight);
    const mat4 toClip = view.projection * view.view;
    for (const vec4& x : readParticles(world).position) {
        const vec4 clip = toClip * vec4(vec3(x), 1.0F);
        if (!(clip.w > 0)) continue;
        const vec2 at((clip.x / clip.w * 0.5F + 0.5F) * kWidth, (0.5F - clip.y / clip.w * 0.5F) * kHeight);
        const float radius = 0.5F * fluid->spacing * view.projection[1][1] / clip.w * 0.5F * kHeight;
        for (int y = static_cast<int>(at.y - radius); y <= static_cast<int>(at.y + radius); ++y)
            for (int px = static_cast<int>(at.x - radius); px <= static_cast<int>(at.x + radius); ++px)
                if (px >= 0 && px < kWidth && y >= 0 && y < kHeight)
                    covered[size_t{static_cast<unsigned>(y)} * kWidth + static_cast<unsigned>(px)] = true;
    }
    // Of the pixels that the particles cover, those that show water. A reflection or shadow beside them is no fault.
    double shown = 0, all = 0;
    for (size_t k = 0; k < covered.size(); ++k) {
        if (!covered[k]) continue;
        int change = 0;
        for (size_t c = 0; c < 3; ++c) change = std::max(change, std::abs(int{with[4 * k + c]} - int{without[4 * k + c]}));
        ++all;
        shown += change >= kChanged ? 1 : 0;
    }
    return GpuFinding{"gl", "picture: pixels that particles cover and that show no water", "of all", all > 0 ? 1 - shown / all : 1, 0.1};
}

}  // namespace rivulet
