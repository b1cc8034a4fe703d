// The cost of water in a host's frame: saving and restoring its OpenGL state, uploading the particles, drawing into its framebuffer.
#include <EGL/egl.h>
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <optional>

#include "demos/rivulet/bench_cases.h"
#include "engine/app/context_egl.h"
#include "engine/app/gl_count.h"
#include "engine/core/timeline.h"
#include "engine/gpu/framebuffer.h"
#include "engine/gpu/host_state.h"
#include "engine/gpu/load.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

constexpr int kWidth = 640, kHeight = 360;

// A pool that sleeps, drawn with a camera that rests: with what is kept, and as if no particle were known to sleep.
Status benchAsleep(const BenchContext& context, const gpu::Framebuffer& host, const FrameView& view, Device& device, WaterRenderer& water) {
    FluidParams params;
    params.method = "dfsph";
    params.spacing = 0.02F;
    params.ellipsoids = params.sleep.on = true;
    params.box.max = vec3(1.0F, 0.6F, 0.6F);
    params.blocks = {{vec3(0.0F), vec3(1.0F, 0.2F, 0.6F), vec3(0.0F)}};
    auto made = FluidWorld::create(device, params, {}, context.log);
    if (!made) return made.error();
    FluidWorld& world = **made;
    for (int k = 0; k < 600 && world.stats().asleep < world.stats().particles; ++k) world.step({}, 1.0 / 60);
    world.step({}, 1.0 / 60);
    const Result<FluidLook> looks = fluidLookOf({}, {});
    if (!looks) return looks.error();
    for (const bool keeps : {false, true}) {
        std::optional<FluidUpload> upload(std::in_place);
        Status wrong = ok();
        size_t bytes = 0;
        const auto frame = [&] {
            host.clearColour(vec4(0.3F, 0.4F, 0.5F, 1.0F));
            host.clearDepth();
            glFinish();
            const double start = hostSeconds();
            if (!keeps) upload.emplace();
            Result<FluidView> fluid = [&] {
                const gpu::HostState keep;
                return upload->view(world, {});
            }();
            bytes = upload->facts().bytes;
            if (!fluid) wrong = fluid.error();
            if (fluid && !keeps) {
                fluid->asleep = fluid->awake = 0;
                fluid->sleepers = nullptr;
            }
            if (fluid)
                if (Status done = water.draw(view, *fluid, *looks, {.framebuffer = host.name(), .width = kWidth, .height = kHeight}); !done)
                    wrong = done;
            glFinish();
            return 1000 * (hostSeconds() - start);
        };
        for (int k = 0; k < 4; ++k) (void)frame();
        const Spread drawn = repeat(context, frame);
        if (!wrong) return wrong;
        BenchRow result{.name = fmt::format("host: pool of {} asleep, {}", world.stats().particles, keeps ? "kept" : "drawn anew"),
                        .unit = "ms",
                        .value = drawn,
                        .passes = {}};
        for (const PassTime& pass : water.times()) result.passes[pass.name] = pass.ms;
        context.report(result);
        context.report(
            {.name = result.name + ", uploaded", .unit = "bytes", .value = spreadOf({static_cast<double>(bytes)}), .passes = {}});
    }
    return ok();
}

// One and two eyes, one and two worlds, each frame in one scope of HostState, as a host draws it; then the same in calls of OpenGL.
Status benchFrames(const BenchContext& context, const gpu::Framebuffer& host, const FrameView& view,
                   const std::array<FluidWorld*, 2>& worlds, WaterRenderer& water) {
    const Result<FluidLook> look = fluidLookOf({}, {});
    if (!look) return look.error();
    std::array<FluidUpload, 2> uploads;
    FrameView other = view;
    other.view[3].x += 0.06F;
    Status wrong = ok();
    const auto frame = [&](size_t of, int eyes, gpu::HostState::Saves saves) {
        const gpu::HostState scope(saves);
        for (size_t k = 0; k < of; ++k) {
            worlds[k]->step({}, 1.0e-6);  // so that its particles are brought over
            for (int eye = 0; eye < eyes; ++eye) {
                Result<FluidView> fluid = uploads[k].view(*worlds[k], {});
                if (!fluid) wrong = fluid.error();
                if (!fluid) return;
                const HostTarget target{.framebuffer = host.name(), .width = kWidth, .height = kHeight};
                if (Status drawn = water.draw(scope, eye == 0 ? view : other, *fluid, *look, target); !drawn) wrong = drawn;
            }
        }
    };
    const struct {
        const char* name;
        size_t worlds;
        int eyes;
        gpu::HostState::Saves saves;
    } rows[] = {{"one eye", 1, 1, gpu::HostState::rivulets},
                {"one eye, state not asked for", 1, 1, gpu::HostState::nothing},
                {"two eyes", 1, 2, gpu::HostState::rivulets},
                {"two worlds", 2, 1, gpu::HostState::rivulets}};
    for (const auto& row : rows) {
        const Spread drawn = repeat(context, [&] {
            glFinish();
            const double start = hostSeconds();
            frame(row.worlds, row.eyes, row.saves);
            glFinish();
            return 1000 * (hostSeconds() - start);
        });
        if (!wrong) return wrong;
        context.report({.name = fmt::format("host: a frame of {}, 640x360", row.name), .unit = "ms", .value = drawn, .passes = {}});
    }
    if (Status counts = gpu::load(countingFind); !counts) return counts;
    for (const auto& row : rows) {
        frame(row.worlds, row.eyes, row.saves);
        glFinish();
        const GlCalls calls = glCallsOf([&] { frame(row.worlds, row.eyes, row.saves); });
        for (const auto& [what, count] : {std::pair("calls of OpenGL", calls.all()), std::pair("questions", calls.questions())})
            context.report({.name = fmt::format("host: a frame of {}, {}", row.name, what),
                            .unit = "calls",
                            .value = spreadOf({static_cast<double>(count)}),
                            .passes = {}});
    }
    return gpu::load(eglGetProcAddress);
}

}  // namespace

Status benchHost(const BenchContext& context) {
    Result<ContextEgl> egl = ContextEgl::create();
    if (!egl) {
        context.log.notice("the case host needs OpenGL, which is not available: it is skipped");
        return ok();
    }
    constexpr int kScopes = 100;
    Result<gpu::Texture> colour = gpu::Texture::create({.width = kWidth, .height = kHeight});
    if (!colour) return colour.error();
    Result<gpu::Texture> depth = gpu::Texture::create({.width = kWidth, .height = kHeight, .format = gpu::Format::depth32f});
    if (!depth) return depth.error();
    const gpu::Framebuffer host(*colour, &*depth);
    const std::unique_ptr<Device> cpu = makeCpu();
    FluidParams params;
    params.spacing = 0.03125F;
    params.ellipsoids = true;
    params.blocks = {{vec3(0.0F), vec3(0.5F, 1.0F, 0.5F), vec3(0.0F)}};
    auto world = FluidWorld::create(*cpu, params, {}, context.log);
    if (!world) return world.error();
    for (int k = 0; k < 15; ++k) (*world)->step({}, 1.0 / 60);
    auto water = WaterRenderer::create({});
    if (!water) return water.error();
    FluidUpload upload;
    FrameView view;
    view.cameraPosWorld = vec3(0.5F, 0.9F, 2.6F);
    view.view = glm::lookAt(view.cameraPosWorld, vec3(0.5F, 0.3F, 0.5F), vec3(0, 1, 0));
    view.projection = glm::perspective(0.8F, static_cast<float>(kWidth) / kHeight, 0.1F, 20.0F);
    view.nearPlane = 0.1F;
    view.farPlane = 20.0F;

    for (const auto& [name, saves] : {std::pair("host: OpenGL state saved and restored", gpu::HostState::rivulets),
                                      std::pair("host: all OpenGL state saved and restored", gpu::HostState::everything),
                                      std::pair("host: OpenGL state made plain", gpu::HostState::nothing)}) {
        const Spread kept = repeat(context, [&, saves = saves] {
            const double start = hostSeconds();
            for (int k = 0; k < kScopes; ++k) const gpu::HostState keep(saves);
            glFinish();
            return 1000 * (hostSeconds() - start) / kScopes;
        });
        context.report({.name = name, .unit = "ms", .value = kept, .passes = {}});
    }
    for (const bool fast : {false, true}) {
        FluidLookParams look;
        look.quality = fast ? "fast" : "fine";
        const Result<FluidLook> looks = fluidLookOf(look, {});
        if (!looks) return looks.error();
        Status wrong = ok();
        double uploaded = 0;
        const Spread drawn = repeat(context, [&] {
            host.clearColour(vec4(0.3F, 0.4F, 0.5F, 1.0F));
            host.clearDepth();
            glFinish();
            const double start = hostSeconds();
            Result<FluidView> fluid = [&] {
                const gpu::HostState keep;
                return upload.view(**world, look);
            }();
            if (!fluid) wrong = fluid.error();
            glFinish();
            uploaded = 1000 * (hostSeconds() - start);
            if (fluid)
                if (Status done = (*water)->draw(view, *fluid, *looks, {.framebuffer = host.name(), .width = kWidth, .height = kHeight});
                    !done)
                    wrong = done;
            glFinish();
            return 1000 * (hostSeconds() - start);
        });
        if (!wrong) return wrong;
        context.report({.name = fast ? "host: 8,192 particles drawn, 640x360, fast" : "host: 8,192 particles drawn, 640x360, fine",
                        .unit = "ms",
                        .value = drawn,
                        .passes = {{"upload", uploaded}}});
    }
    auto second = FluidWorld::create(*cpu, params, {}, context.log);
    if (!second) return second.error();
    for (int k = 0; k < 15; ++k) (*second)->step({}, 1.0 / 60);
    if (Status done = benchFrames(context, host, view, {world->get(), second->get()}, **water); !done) return done;
    return benchAsleep(context, host, view, *cpu, **water);
}

}  // namespace rivulet
