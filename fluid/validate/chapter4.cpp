#include "fluid/validate/chapter4.h"

#include <fmt/format.h>

#include <chrono>

#include "engine/compute/device_cpu.h"
#include "engine/core/assert.h"
#include "engine/core/wall_clock.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {

namespace {

using Clock = std::chrono::steady_clock;
constexpr int kPictureWidth = 640, kPictureHeight = 480;  // pixels; half as many per side where a CPU draws, else drawing dominates
constexpr int kVoxels = 128;
constexpr double kFall = 0.2;                          // s: the column has hit the mesh, and water lies on it
constexpr int kWarmUpFrames = 4, kMeasuredFrames = 8;  // frames not measured; frames per run
constexpr float kColumnSpacing = 0.0125F;              // m
constexpr float kColumnBase = 0.51F;                   // m: above the mesh
constexpr const char* kMesh = "spot.obj";

// A column of `particles`, a power of two; its height is one, two or four times its width.
BlockParams column(int particles) {
    int wide = 1;
    while (8 * wide * wide * wide <= particles) wide *= 2;
    const int high = particles / (wide * wide);
    const vec2 half = vec2(0.5F * kColumnSpacing * static_cast<float>(wide));
    const vec2 middle(0.4F, 0.4F);  // over the mesh
    return {.min = vec3(middle.x - half.x, kColumnBase, middle.y - half.y),
            .max = vec3(middle.x + half.x, kColumnBase + kColumnSpacing * static_cast<float>(high), middle.y + half.y),
            .velocity = vec3(0.0F, -2.0F, 0.0F)};
}

Result<SceneFile> sceneOf(const Chapter4Row& row) {
    Result<SceneFile> scene = loadScene("scenes/column_over_spot.json", {});
    if (!scene) return scene.error();
    FluidParams& f = scene->fluid;
    f.method = "wcsph_thesis";
    f.supportSpacings = 2;
    f.grid = row.grid;
    f.workGroup = row.workGroup;
    f.spacing = kColumnSpacing;
    f.viscosity = 5.0e-3F;
    f.maxSubsteps = 1;  // a frame is one step of the stable length
    f.blocks = {column(row.particles)};
    f.box.max.y = std::max(f.box.max.y, f.blocks[0].max.y + 0.1F);
    if (!row.walk.empty()) f.collision.walk = row.walk;
    scene->colliders[0].resolution = kVoxels;
    scene->look.renderer = "points";
    scene->look.quality = "fast";
    return scene;
}

// The moment at which frames are measured. It is reached on the cpu with the exact walk, so that all variants start from the same water
// outside the mesh.
struct Moment {
    std::unique_ptr<Device> cpu;
    std::unique_ptr<Session> session;
    WorldState state;
};

Result<Moment> reach(int particles) {
    Result<SceneFile> scene = sceneOf({.particles = particles, .grid = "sorted", .walk = "exact", .workGroup = kThesisWorkGroup});
    if (!scene) return scene.error();
    const std::vector<CpuKernelRow> rows = cpuKernels();
    Moment moment;
    moment.cpu = makeCpuDevice(rows);
    auto session = Session::create(*scene, *moment.cpu, {});
    if (!session) return session.error();
    moment.session = std::move(*session);
    FluidWorld& world = moment.session->world();
    while (world.time() < kFall) {
        moment.session->step(1.0 / kFramesPerSecond, true);
        if (const Status stepped = world.lastStep(); !stepped) return stepped.error();
    }
    world.save(moment.state);
    return moment;
}

// One variant of those that run in turn.
struct Contender {
    Chapter4Row row;
    std::unique_ptr<Session> session;
    FluidUpload upload;
    std::vector<double> step, draw;  // ms per frame of each run

    // The water of `moment` in a world of its own.
    static Result<Contender> create(const Chapter4Row& row, Device& device, const Moment& moment) {
        Result<SceneFile> scene = sceneOf(row);
        if (!scene) return scene.error();
        if (row.walk.empty()) scene->colliders.clear();
        auto session = Session::create(*scene, device, {});
        if (!session) return session.error();
        Contender c{row, std::move(*session), {}, {}, {}};
        ASSERT(c.session->world().stats().particles == static_cast<uint32_t>(row.particles), "ask for a power of two");
        WorldState state;
        c.session->world().save(state);
        for (const char* name : {"world.numbers", "particles.position", "particles.velocity", "particles.id"}) {
            if (Result<WorldState::Bytes> own = state.takeBytes(name); !own) return own.error();
            state.putBytes(name, moment.state.sections().at(name));
        }
        if (Status taken = c.session->world().restore(state); !taken) return taken.error();
        return c;
    }
    // `scenery`: everything drawn besides the water, the same for all variants.
    Status run(SceneRenderer& renderer, const Session& scenery, const Chapter4& chapter, int frames) {
        double stepping = 0, drawing = 0;
        Device& device = session->world().device();
        device.finish();
        device.takeTimes();
        for (int k = 0; k < frames; ++k) {
            const Clock::time_point start = Clock::now();
            session->step(1.0 / kFramesPerSecond, true);
            stepping += msSince(start);
            const Clock::time_point stepped = Clock::now();
            const SceneFile& scene = scenery.scene();
            Result<FluidView> fluid = upload.view(session->world(), scene.look);
            if (!fluid) return fluid.error();
            const FrameView view = frameViewOf(cameraOf(scene.camera, scenery.bounds()), scene.light, chapter.width, chapter.height, 0);
            if (Status drawn = renderer.draw(view, *fluid, scenery.solids(), scene); !drawn) return drawn;
            device.finish();
            drawing += msSince(stepped);
        }
        for (const PassTime& t : device.takeTimes()) row.passes[t.name] += t.ms;
        step.push_back(stepping / frames);
        draw.push_back(drawing / frames);
        row.runMs.push_back((stepping + drawing) / frames);
        return ok();
    }
    void sumUp() {
        std::vector<double> perSecond;
        for (const double ms : row.runMs) perSecond.push_back(1000 / ms);
        row.frames = spreadOf(perSecond);
        row.frameMs = spreadOf(row.runMs).median;
        row.stepMs = spreadOf(step).median;
        row.drawMs = spreadOf(draw).median;
        for (auto& [name, ms] : row.passes) ms /= static_cast<double>(row.runMs.size()) * kMeasuredFrames;
    }
    void forget() {
        row.runMs.clear();
        step.clear();
        draw.clear();
        row.passes.clear();
    }
};

// Runs all variants of one number of particles in turn.
Status compare(std::vector<Chapter4Row> wanted, const Chapter4Request& request, SceneRenderer& renderer, Chapter4& chapter) {
    Result<Moment> moment = reach(wanted.front().particles);
    if (!moment) return moment.error();
    std::vector<Contender> all;
    for (const Chapter4Row& row : wanted) {
        Result<Contender> made = Contender::create(row, *request.device, *moment);
        if (!made) return made.error();
        all.push_back(std::move(*made));
        if (Status warm = all.back().run(renderer, *moment->session, chapter, kWarmUpFrames); !warm) return warm;
        all.back().forget();
    }
    for (int run = 0; run < request.runs; ++run)
        for (size_t turn = 0; turn < all.size(); ++turn) {
            Contender& c = all[(turn + static_cast<size_t>(run)) % all.size()];  // no variant is always the first
            chapter.stopped = chapter.stopped || !request.goOn();
            if (chapter.stopped) return ok();
            if (Status done = c.run(renderer, *moment->session, chapter, kMeasuredFrames); !done) return done;
        }
    for (Contender& c : all) {
        c.sumUp();
        request.report(c.row);
        chapter.rows.push_back(std::move(c.row));
    }
    return ok();
}

}  // namespace

Result<Chapter4> runChapter4(const Chapter4Request& request) {
    ASSERT(request.device->backend() == Backend::gl && !request.particles.empty(), "chapter 4 runs on gl, with some particles");
    Chapter4 chapter;
    chapter.drawnBy = request.device->info().name;
    const int smaller = request.device->info().software ? 2 : 1;
    chapter.width = kPictureWidth / smaller;
    chapter.height = kPictureHeight / smaller;
    chapter.mesh = kMesh;
    chapter.voxels = kVoxels;
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    if (!renderer) return renderer.error();
    for (const int particles : request.particles) {
        std::vector<Chapter4Row> rows;
        for (const auto& [grid, walk] : {std::pair("linked_list", ""), std::pair("linked_list", "thesis"),
                                         std::pair("linked_list", "exact"), std::pair("sorted", ""), std::pair("sorted", "exact")})
            rows.push_back({.particles = particles, .grid = grid, .walk = walk, .workGroup = kThesisWorkGroup});
        if (Status done = compare(rows, request, **renderer, chapter); !done) return done.error();
        if (chapter.stopped) return chapter;
    }
    const int at = request.particles[request.particles.size() > 1 ? request.particles.size() - 2 : 0];
    std::vector<Chapter4Row> sizes;
    for (const int size : request.workGroups)
        sizes.push_back({.particles = at, .grid = "linked_list", .walk = "thesis", .workGroup = size, .sizes = true});
    if (!sizes.empty())
        if (Status done = compare(sizes, request, **renderer, chapter); !done) return done.error();
    return chapter;
}

}  // namespace rivulet
