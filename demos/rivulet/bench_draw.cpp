// The cost of a picture with water, pass by pass: GPU time, and the bytes that the passes read and write.
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <map>

#include "demos/rivulet/bench_cases.h"
#include "engine/app/context_egl.h"
#include "engine/core/timeline.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"

namespace rivulet {

namespace {

constexpr int kDrawnWidth = 1920, kDrawnHeight = 1080;
constexpr double kDrawnAt = 0.6;       // s, of the dam break
constexpr double kBytesPerMs = 1.0e9;  // 1 TB/s, of a current GPU
constexpr double kMegabyte = 1.0e6;    // bytes

struct Traffic {
    std::vector<gpu::PassTraffic> passes;
    double count = 0, read = 0, written = 0;
};
Traffic trafficOf(const SceneRenderer& renderer) {
    Traffic t;
    if (renderer.description()) t.passes = gpu::trafficOf(*renderer.description());
    for (const gpu::PassTraffic& p : t.passes) {
        t.count += static_cast<double>(p.passes);
        t.read += static_cast<double>(p.read);
        t.written += static_cast<double>(p.written);
    }
    return t;
}

}  // namespace

Status benchDraw(const BenchContext& context) {
    const Result<ContextEgl> egl = ContextEgl::create();
    if (!egl) {
        context.log.notice("the case draw needs OpenGL, which is not available: it is skipped");
        return ok();
    }
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    const std::unique_ptr<Device> cpu = makeCpu();
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *cpu, context.log);
    if (!session) return session.error();
    while ((*session)->time() < kDrawnAt - 1e-6) {
        (*session)->step(1.0 / kFramesPerSecond, true);
        if (Status stepped = (*session)->world().lastStep(); !stepped) return stepped;
    }
    Result<std::unique_ptr<SceneRenderer>> made = SceneRenderer::create(ShaderFiles::developer());
    if (!made) return made.error();
    SceneRenderer& renderer = **made;
    renderer.describe(true);
    const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, kDrawnWidth, kDrawnHeight, 0);
    for (const char* quality : {"fine", "fast"}) {
        scene->look.quality = quality;
        FluidUpload upload;
        Status wrong = ok();
        std::map<std::string, std::vector<double>> ms;
        const auto draw = [&](const FluidView& fluid) {
            const double start = hostSeconds();
            if (Status drawn = renderer.draw(view, fluid, (*session)->solids(), *scene); !drawn) wrong = drawn;
            renderer.finish();
            return 1000 * (hostSeconds() - start);
        };
        draw({});
        const Traffic dry = trafficOf(renderer);
        const Result<FluidView> fluid = upload.view((*session)->world(), scene->look);
        if (!fluid) return fluid.error();
        draw(*fluid);
        const Spread frame = repeat(context, [&] {
            const double whole = draw(*fluid);
            for (const PassTime& pass : renderer.times())
                if (pass.calls > 0) ms[pass.name].push_back(pass.ms);
            return whole;
        });
        if (!wrong) return wrong;
        const Traffic all = trafficOf(renderer);
        const auto row = [&](const std::string& what, const char* unit, const Spread& value) {
            context.report({.name = fmt::format("draw, {}: {}", quality, what), .unit = unit, .value = value, .passes = {}});
        };
        row("whole picture, 1920x1080", "ms", frame);
        for (const gpu::PassTraffic& pass : all.passes) {
            std::vector<double>& times = ms[pass.name];
            if (!times.empty()) times.erase(times.begin());  // of the first, which repeat() does not count either
            const std::string what = pass.passes > 1 ? fmt::format("{}, {} passes", pass.name, pass.passes) : pass.name;
            if (!times.empty()) row(what, "ms", spreadOf(times));
            row(what, "MB", spreadOf({static_cast<double>(pass.bytes()) / kMegabyte}));
        }
        struct Sum {
            const char* of;
            double count, read, written;
        };
        for (const Sum& s : {Sum{"all passes", all.count, all.read, all.written},
                             Sum{"passes of the water", all.count - dry.count, all.read - dry.read, all.written - dry.written}}) {
            row(s.of, "passes", spreadOf({s.count}));
            row(fmt::format("{}, read", s.of), "MB", spreadOf({s.read / kMegabyte}));
            row(fmt::format("{}, written", s.of), "MB", spreadOf({s.written / kMegabyte}));
            row(fmt::format("{}, at 1 TB/s", s.of), "ms", spreadOf({(s.read + s.written) / kBytesPerMs}));
        }
    }
    return ok();
}

}  // namespace rivulet
