#include "fluid/validate/chapter2.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/bridge/fluid_upload.h"
#include "fluid/bridge/scene_renderer.h"

namespace rivulet {

namespace {

constexpr int kWidth = 640, kHeight = 480;  // pixels; half of them a side where a CPU draws
constexpr int kFrames = 6;                  // of a run; one before them is not counted

// Water in free fall in a box of 1 m: half a cube, and so many of them on top of each other.
Result<SceneFile> sceneOf(int particles, int times) {
    Result<SceneFile> scene = loadScene("scenes/falling_cube.json", {});
    if (!scene) return scene.error();
    FluidParams& f = scene->fluid;
    f.method = "wcsph_thesis";
    const float wide = std::round(std::cbrt(2 * static_cast<float>(particles)));
    f.spacing = 0.5F / std::cbrt(static_cast<float>(particles * times));
    f.maxSubsteps = 1;  // a frame is a step, as long as is stable
    const vec3 size = f.spacing * vec3(wide, 0.5F * wide * static_cast<float>(times), wide);
    const vec3 low(0.5F - 0.5F * size.x, 0.2F, 0.5F - 0.5F * size.z);
    f.blocks = {{.min = low, .max = low + size, .velocity = vec3(0.0F)}};
    f.box.max.y = std::max(1.0F, low.y + size.y + 0.1F);
    scene->look.quality = "fast";
    return scene;
}

// One of what takes turns.
struct Contender {
    Chapter2Row row;
    std::unique_ptr<Session> session;
    std::unique_ptr<Timeline> timeline;
    std::unique_ptr<Cooperation> work;
    FluidUpload upload;
    std::vector<double> frame, step, draw;  // ms a frame, of each run
    int frames = 0;

    static Result<Contender> create(const SceneFile& scene, const Chapter2Row& row, Device& device, const Log& log) {
        auto session = Session::create(scene, device, {});
        if (!session) return session.error();
        Contender c{row, std::move(*session), std::make_unique<Timeline>(), nullptr, {}, {}, {}, {}, 0};
        c.row.particles = static_cast<int>(c.session->world().stats().particles);
        c.work = std::make_unique<Cooperation>(*c.session, row.way.plan, c.timeline.get(), log);
        return c;
    }
    Status run(SceneRenderer& renderer, const Chapter2& chapter) {
        const SceneFile& scene = session->scene();
        Device& device = session->world().device();
        double whole = 0, stepping = 0, drawing = 0;
        for (int k = 0; k <= kFrames; ++k) {
            const double start = hostSeconds();
            if (!work->started()) work->start(frameSeconds(scene), true);
            work->finish();
            for (const PassTime& t : device.takeTimes())
                if (k > 0) row.passes[t.name] += t.ms;
            const double stepped = hostSeconds();
            Result<FluidView> fluid = upload.view(session->world(), scene.look);
            if (!fluid) return fluid.error();
            const FrameView view = frameViewOf(cameraOf(scene.camera, session->bounds()), scene.light, chapter.width, chapter.height, 0);
            work->start(frameSeconds(scene), true);  // in the last one, too: all that are counted are drawn beside a step, or none
            {
                const TimedSpan span(timeline.get(), kDrawingLane, "drawn");
                if (Status drawn = renderer.draw(view, *fluid, session->solids(), scene); !drawn) return drawn;
                renderer.finish();
            }
            if (k == 0) continue;
            const double done = hostSeconds();
            whole += done - start;
            stepping += stepped - start;
            drawing += done - stepped;
        }
        work->drop();
        device.takeTimes();
        if (const DeviceHealth health = device.health(); health.state != DeviceHealth::works)
            return failed(fmt::format("{} {}: nothing it took can be believed", device.info().name, health.why));
        frames += kFrames;
        frame.push_back(1000 * whole / kFrames);
        step.push_back(1000 * stepping / kFrames);
        draw.push_back(1000 * drawing / kFrames);
        return ok();
    }
    void sumUp() {
        row.frameMs = spreadOf(frame);
        row.way.frameMs = row.frameMs.median;
        row.stepMs = spreadOf(step).median;
        row.drawMs = spreadOf(draw).median;
        row.overlapMs = work->stats().overlapMs;
        for (auto& [name, ms] : row.passes) ms /= frames;
    }
};

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
        if (std::string_view(backend) != backendName(device->backend())) continue;  // and the log has said so
        chapter.devices.push_back(fmt::format("{}: {}", backend, device->info().name));
        devices.push_back(std::move(device));
    }
    for (const int times : request.times) {
        Result<SceneFile> scene = sceneOf(request.particles, times);
        if (!scene) return scene.error();
        std::vector<Contender> all;
        for (const std::unique_ptr<Device>& device : devices)
            for (const Plan plan : {Plan::alone, device->backend() == Backend::cpu ? Plan::behind : Plan::thesis}) {
                const Chapter2Row row{.particles = 0, .way = {.backend = backendName(device->backend()), .plan = plan, .passes = {}}};
                Result<Contender> made = Contender::create(*scene, row, *device, request.log);
                if (!made) return made.error();
                all.push_back(std::move(*made));
            }
        for (int run = 0; run < request.runs; ++run)
            for (size_t turn = 0; turn < all.size(); ++turn) {
                chapter.stopped = chapter.stopped || !request.goOn();
                if (chapter.stopped) return chapter;
                Contender& c = all[(turn + static_cast<size_t>(run)) % all.size()];  // nobody always comes first
                if (Status done = c.run(**renderer, chapter); !done) return done.error();
            }
        for (Contender& c : all) {
            c.sumUp();
            request.report(c.row);
            chapter.rows.push_back(std::move(c.row));
        }
        if (!chapter.picked.empty()) continue;
        // What auto would pick of these, by its own short look.
        FluidUpload upload;
        const auto draw = [&](Session& session, const std::function<void()>& uploaded, std::vector<PassTime>& passes) -> Status {
            Result<FluidView> fluid = upload.view(session.world(), session.scene().look);
            if (!fluid) return fluid.error();
            const FrameView view =
                frameViewOf(cameraOf(session.scene().camera, session.bounds()), session.scene().light, chapter.width, chapter.height, 0);
            uploaded();
            if (Status drawn = (*renderer)->draw(view, *fluid, session.solids(), session.scene()); !drawn) return drawn;
            (*renderer)->finish();
            passes = (*renderer)->times();
            return ok();
        };
        const Result<std::vector<PlanTried>> tried = tryPlans(*scene, request.gl, draw, {});
        if (!tried) return tried.error();
        chapter.picked = nameOf(tried->front());
        double best = 1.0e30, own = 1.0e30;
        for (const Chapter2Row& r : chapter.rows) {
            best = std::min(best, r.frameMs.median);
            if (nameOf(r.way) == chapter.picked) own = r.frameMs.median;
        }
        chapter.pickedBehind = own / best - 1;
    }
    return chapter;
}

}  // namespace rivulet
