#include "fluid/validate/surface_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/render/raymarch.h"
#include "fluid/validate/image_flip.h"

namespace rivulet {

namespace {

constexpr double kMoment = 0.6;               // s, of the dam break
constexpr int kWarmUpDraws = 3, kDraws = 15;  // draws of a timed picture: before counting, and counted
// Frames until the pool is at rest: motion started by tension, walls and the lattice has decayed, and the largest speed is 6 mm/s. After
// half as many frames it is 130 mm/s, and the picture of the reference changes more than the drawn one (1.55 and 1.11 of 255).
constexpr int kSettling = 240;

// `spacing`: of the drawn particles, m.
SceneFile sceneOf(const SceneFile& scene, const SurfaceLook& look, float spacing) {
    SceneFile out = scene;
    const bool reference = look.filter == kSurfaceReference;
    out.look.renderer = reference ? "reference" : "screen_space";
    if (!reference) out.look.filter = look.filter;
    if (!look.quality.empty()) out.look.quality = look.quality;
    if (look.reach > 0) out.look.smoothing = look.reach * spacing;
    return out;
}

SurfaceMap referenceMap(const SplatSet& splats, const FrameView& view) {
    const Result<IsoSurface> surface = IsoSurface::create(splats.at, splats.spacing);
    ASSERT(surface, "particles have a spacing of more than 0");
    RaymarchPicture picture = raymarch(*surface, view, {.box = splats.box, .until = {}});
    SurfaceMap map{picture.width, picture.height, std::move(picture.depth), {}};
    for (const vec4& water : picture.water) map.normal.emplace_back(water);
    return map;
}

}  // namespace

Result<SurfaceTrial> SurfaceTrial::create(const CaseSettings& settings) {
    // A gl device has a current context.
    Result<SurfaceProbe> probe = SurfaceProbe::create(settings.device->backend() != Backend::gl);
    if (!probe) return failed(fmt::format("the case surface needs OpenGL to draw: {}", probe.error().message));
    SurfaceTrial trial(settings, std::move(*probe));
    Result<SceneFile> scene = loadScene("dam_break.json", settings.assignments);
    if (!scene) return scene.error();
    trial.scene_ = std::move(*scene);
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    if (!renderer) return renderer.error();
    trial.renderer_ = std::move(*renderer);
    trial.shapes_ = surfaceShapes(trial.width(), trial.height());
    for (SurfaceShape& shape : trial.shapes_) {
        Result<HostEllipsoids> found = ellipsoidsOf(*settings.device, shape.splats.at, shape.splats.spacing);
        if (!found) return found.error();
        shape.splats.ellipsoids = std::move(*found);
    }
    return trial;
}

FrameView SurfaceTrial::viewOf(const SceneFile& scene, const Session& session) const {
    return frameViewOf(cameraOf(scene.camera, session.bounds()), scene.light, width(), height(), 0);
}

bool SurfaceTrial::goOn(double share) {
    stopped_ = stopped_ || !settings_.goOn(share);
    return !stopped_;
}

Result<SurfaceMap> SurfaceTrial::drawn(const SplatSet& splats, const FrameView& view, const SceneFile& scene) {
    const Result<FluidLook> look = fluidLookOf(scene.look, scene.fluid.liquid);
    if (!look) return look.error();
    const float radius = scene.look.radiusSpacings * splats.spacing;
    Result<std::vector<float>> depth =
        probe_.depth(splats.at, {.radius = radius, .spacing = splats.spacing, .bounds = splats.box}, view, *look,
                     scene.look.splats == "ellipsoids" && !look->fast ? splats.ellipsoids : HostEllipsoids{});
    if (!depth) return depth.error();
    SurfaceMap map{view.width, view.height, std::move(*depth), {}};
    fillNormals(map, view, radius);
    return map;
}

Result<std::vector<ShapeErrors>> SurfaceTrial::shapes(const SurfaceLook& look) {
    std::vector<ShapeErrors> all;
    for (const SurfaceShape& shape : shapes_) {
        Result<SurfaceMap> map = look.filter == kSurfaceReference
                                     ? referenceMap(shape.splats, shape.view)
                                     : drawn(shape.splats, shape.view, sceneOf(scene_, look, shape.splats.spacing));
        if (!map) return map.error();
        all.push_back({&shape, compareSurfaces(*map, shape.reference, scene_.look.radiusSpacings * shape.splats.spacing)});
    }
    return all;
}

Result<std::vector<uint8_t>> SurfaceTrial::pictureOf(const SceneFile& scene) {
    const Result<FluidView> fluid = upload_.view(session_->world(), scene.look);
    if (!fluid) return fluid.error();
    if (Status s = renderer_->draw(view_, *fluid, session_->solids(), scene); !s) return s.error();
    return renderer_->pixels();
}

Status SurfaceTrial::reachMoment() {
    if (session_) return ok();
    Result<std::unique_ptr<Session>> session = Session::create(scene_, *settings_.device, settings_.log);
    if (!session) return session.error();
    session_ = std::move(*session);
    FluidWorld& world = session_->world();
    while (world.time() < kMoment - 1e-6) {
        if (!goOn(kMomentShare * world.time() / kMoment)) return ok();
        session_->step(1.0 / kFramesPerSecond, true);
        if (Status stepped = world.lastStep(); !stepped && !world.interrupted()) return stepped;
    }
    const ParticleView water = world.particles();
    Device& device = world.device();
    now_ = {device.readAll<vec4>(*water.drawn, water.slots), world.params().spacing, {}};
    for (size_t k = 0; k < 3 && water.ellipsoids[0] != nullptr; ++k)
        now_.ellipsoids[k] = device.readAll<vec4>(*water.ellipsoids[k], water.slots);
    now_.box.add(world.params().box.min);
    now_.box.add(world.params().box.max);
    view_ = viewOf(scene_, *session_);
    reference_ = referenceMap(now_, view_);
    Result<std::vector<uint8_t>> picture = pictureOf(sceneOf(scene_, {kSurfaceReference}, now_.spacing));
    if (!picture) return picture.error();
    referencePicture_ = std::move(*picture);
    return ok();
}

Result<MomentErrors> SurfaceTrial::moment(const SurfaceLook& look) {
    if (Status s = reachMoment(); !s) return s.error();
    if (stopped_) return MomentErrors{};
    const SceneFile scene = sceneOf(scene_, look, now_.spacing);
    const Result<SurfaceMap> map = drawn(now_, view_, scene);
    if (!map) return map.error();
    const Result<std::vector<uint8_t>> picture = pictureOf(scene);
    if (!picture) return picture.error();
    return MomentErrors{compareSurfaces(*map, reference_, scene.look.radiusSpacings * now_.spacing),
                        flipMean(referencePicture_, *picture, width(), height())};
}

Result<std::vector<double>> SurfaceTrial::drawMs(const FrameView& view, const SceneFile& scene, const FluidView& fluid, int before,
                                                 int count) {
    std::vector<double> ms;
    for (int k = -before; k < count; ++k) {
        const auto start = std::chrono::steady_clock::now();
        if (Status s = renderer_->draw(view, fluid, session_->solids(), scene); !s) return s.error();
        glFinish();
        if (k >= 0) ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    return ms;
}

Result<DrawTimes> SurfaceTrial::times(const SurfaceLook& look) {
    if (Status s = reachMoment(); !s) return s.error();
    if (stopped_) return DrawTimes{};
    const SceneFile scene = sceneOf(scene_, look, now_.spacing);
    const Result<FluidView> fluid = upload_.view(session_->world(), scene.look);
    if (!fluid) return fluid.error();
    const bool reference = look.filter == kSurfaceReference;
    // The ray-marcher caches its picture; a slightly moved camera forces a new one.
    FrameView view = view_;
    if (reference) view.view[3].x += 1.0e-5F;
    const Result<std::vector<double>> dry = drawMs(view, scene, FluidView{}, kWarmUpDraws, kDraws);
    if (!dry) return dry.error();
    Result<std::vector<double>> wet = drawMs(view, scene, *fluid, reference ? 0 : kWarmUpDraws, reference ? 1 : kDraws);
    if (!wet) return wet.error();
    DrawTimes times{spreadOf(*wet), {}};
    const double without = spreadOf(*dry).median;
    for (double& ms : *wet) ms -= without;
    times.water = spreadOf(std::move(*wet));
    return times;
}

std::string SurfaceTrial::drawnBy() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

Result<StillPool> SurfaceTrial::flicker(std::span<const SurfaceLook> looks, int stillFrames) {
    // The drawn surface is judged, not the solver: the pool is as calm as it can be.
    std::vector<std::string> assignments = {"fluid.spacing=0.025",           "fluid.artificialViscosity=0.05", "fluid.dfsph.tolerance=1e-4",
                                            "camera.position=0.95,0.85,1.2", "camera.target=0.25,0.28,0.25",   "camera.fieldOfView=36"};
    assignments.insert(assignments.end(), settings_.assignments.begin(), settings_.assignments.end());
    const Result<SceneFile> scene = loadScene("cases/hydrostatic.json", assignments);
    if (!scene) return scene.error();
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *settings_.device, settings_.log);
    if (!session) return session.error();
    FluidWorld& world = (*session)->world();
    const FrameView view = viewOf(*scene, **session);
    const int frames = kSettling + stillFrames;
    FluidUpload upload;
    std::vector<Flicker> all;
    StillPool pool;
    for (int f = 0; f < frames; ++f) {
        if (!goOn(kMomentShare + (1 - kMomentShare) * f / frames)) return StillPool{};
        (*session)->step(1.0 / kFramesPerSecond, true);
        if (f < kSettling) continue;
        if (f == kSettling) {
            const HostParticles now = readParticles(world);
            double sum = 0;
            for (const vec4& v : now.velocity) sum += double{glm::dot(vec3(v), vec3(v))};
            pool.speed = 1000 * std::sqrt(sum / std::max<double>(1, static_cast<double>(now.velocity.size())));
            const SurfaceMap map = referenceMap({now.position, scene->fluid.spacing, {}}, view);
            std::vector<bool> water(map.depth.size());  // pictures store the top row first
            const auto row = static_cast<size_t>(width()), rows = static_cast<size_t>(height());
            for (size_t i = 0; i < water.size(); ++i) water[i] = map.there((rows - 1 - i / row) * row + i % row);
            all.assign(looks.size(), Flicker(std::move(water)));
        }
        const Result<FluidView> fluid = upload.view(world, scene->look);
        if (!fluid) return fluid.error();
        for (size_t k = 0; k < looks.size(); ++k) {
            if (Status s = renderer_->draw(view, *fluid, (*session)->solids(), sceneOf(*scene, looks[k], scene->fluid.spacing)); !s)
                return s.error();
            all[k].add(renderer_->pixels());
        }
    }
    for (const Flicker& flicker : all) pool.flicker.push_back(flicker.rms());
    return pool;
}

}  // namespace rivulet
