#include "fluid/validate/gpu_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <limits>

#include "fluid/render/fluid_upload.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/sim/world/host_particles.h"

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

// The largest distance; infinite where one of the two has other particles, or no numbers.
double farthest(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        const double apart = double{glm::length(vec3(a[i]) - vec3(b[i]))};
        if (!(apart <= most)) most = std::isnan(apart) ? std::numeric_limits<double>::infinity() : apart;
    }
    return most;
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
    return passed() ? fmt::format("{}: {} agree within {:.2g} {}", device, what, difference, unit)
                    : fmt::format("{}: {} differ by {:.3g} {}, allowed are {:.2g}", device, what, difference, unit, limit);
}

Result<std::vector<GpuFinding>> checkDevice(Device& device, Device& cpu) {
    std::vector<GpuFinding> found;
    FluidParams forces = oneStepDam("dfsph", kSpacing);
    forces.forces.tension = 0.07F;
    forces.forces.vorticity = 0.1F;
    forces.viscosity = 1.0e-3F;
    const std::pair<const char*, FluidParams> cases[] = {{"wcsph", oneStepDam("wcsph", kSpacing)},
                                                         {"pbf", oneStepDam("pbf", kSpacing)},
                                                         {"dfsph", oneStepDam("dfsph", kSpacing)},
                                                         {"dfsph with tension and vorticity", forces}};
    for (const auto& [name, params] : cases) {
        const Result<State> here = stateAfter(cpu, params);
        if (!here) return here.error();
        const Result<State> there = stateAfter(device, params);
        if (!there) return there.error();
        const double fall = std::sqrt(2 * 9.81 * 1.0);
        found.push_back({backendName(device.backend()), fmt::format("{}: positions after {} steps", name, kSteps), "spacings",
                         farthest(here->position, there->position) / double{params.spacing}, kPositionLimit});
        found.push_back({backendName(device.backend()), fmt::format("{}: velocities after {} steps", name, kSteps), "of a fall's speed",
                         farthest(here->velocity, there->velocity) / fall, kSpeedLimit});
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
    return GpuFinding{"gl", "picture: pixels of the water that show none", "of all", all > 0 ? 1 - shown / all : 1, 0.1};
}

}  // namespace rivulet
