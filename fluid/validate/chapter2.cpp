#include "fluid/validate/chapter2.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/render/fluid_upload.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

namespace {

constexpr int kWidth = 640, kHeight = 480;  // pixels; half as many per side where a CPU draws
constexpr int kFrames = 6;                  // per run, after one frame that is not counted

// Water in free fall in a box of 1 m: `times` half cubes on top of each other.
Result<SceneFile> sceneOf(int particles, int times) {
    Result<SceneFile> scene = loadScene("scenes/falling_cube.json", {});
    if (!scene) return scene.error();
    FluidParams& f = scene->fluid;
    f.method = "wcsph_thesis";
    f.supportSpacings = 2;
    const float wide = std::round(std::cbrt(2 * static_cast<float>(particles)));
    f.spacing = 0.5F / std::cbrt(static_cast<float>(particles * times));
    f.maxSubsteps = 1;  // a frame is one step of the stable length
    const vec3 size = f.spacing * vec3(wide, 0.5F * wide * static_cast<float>(times), wide);
    const vec3 low(0.5F - 0.5F * size.x, 0.2F, 0.5F - 0.5F * size.z);
    f.blocks = {{.min = low, .max = low + size, .velocity = vec3(0.0F)}};
    f.box.max.y = std::max(1.0F, low.y + size.y + 0.1F);
    scene->look.quality = "fast";
    return scene;
}

}  // namespace

Result<Chapter2> runChapter2(const Chapter2Request& request) {
    Chapter2 chapter;
    chapter.drawnBy = request.gl.renderer;
    const int smaller = request.gl.software ? 2 : 1;
    chapter.width = kWidth / smaller;
    chapter.height = kHeight / smaller;
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    if (!renderer) return renderer.error();
    std::vector<std::unique_ptr<Device>> devices;
    for (const char* backend : {"cpu", "gl", "cl"}) {
        std::unique_ptr<Device> device = makeDevice(backend, request.gl, request.log);
        if (std::string_view(backend) != backendName(device->backend())) continue;  // the log has reported it
        chapter.devices.push_back(fmt::format("{}: {}", backend, device->info().name));
        devices.push_back(std::move(device));
    }
    FluidUpload upload;
    const DrawFrame draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
        const SceneFile& scene = session.scene();
        Result<FluidView> fluid = upload.view(session.world(), scene.look);
        if (!fluid) return fluid.error();
        const FrameView view = frameViewOf(cameraOf(scene.camera, session.bounds()), scene.light, chapter.width, chapter.height, 0);
        uploaded();
        if (Status drawn = (*renderer)->draw(view, *fluid, session.solids(), scene); !drawn) return drawn;
        (*renderer)->finish();
        passes = (*renderer)->times();
        return ok();
    };
    for (const int times : request.times) {
        Result<SceneFile> scene = sceneOf(request.particles, times);
        if (!scene) return scene.error();
        std::vector<Autotune> all;
        for (const std::unique_ptr<Device>& device : devices)
            for (const Plan plan : {Plan::alone, device->backend() == Backend::cpu ? Plan::behind : Plan::thesis}) {
                Result<Autotune> made = Autotune::create(*scene, *device, plan, request.log);
                if (!made) return made.error();
                all.push_back(std::move(*made));
            }
        for (int run = 0; run < request.runs; ++run)
            for (size_t turn = 0; turn < all.size(); ++turn) {
                chapter.stopped = chapter.stopped || !request.goOn();
                if (chapter.stopped) return chapter;
                Autotune& trial = all[(turn + static_cast<size_t>(run)) % all.size()];  // no variant is always the first
                if (Status done = trial.run(draw, kFrames); !done) return done.error();
            }
        const size_t first = chapter.rows.size();
        for (const Autotune& trial : all) {
            chapter.rows.push_back({static_cast<int>(trial.session().world().stats().particles), trial.result()});
            request.report(chapter.rows.back());
        }
        all.clear();
        // The choice of auto, by its own short measurement.
        const Result<std::vector<PlanTried>> tried = tryPlans({*scene, request.gl, draw});
        if (!tried) return tried.error();
        Chapter2::Picked picked{chapter.rows.back().particles, nameOf(tried->front()), 0};
        const PlanTried* best = nullptr;
        const PlanTried* own = nullptr;
        for (const Chapter2Row& r : std::span(chapter.rows).subspan(first)) {
            if (best == nullptr || r.way.frameMs.median < best->frameMs.median) best = &r.way;
            if (nameOf(r.way) == picked.name) own = &r.way;
        }
        picked.behind = beyond(*own, *best);
        chapter.picked.push_back(std::move(picked));
    }
    return chapter;
}

}  // namespace rivulet
