#include "fluid/validate/surface_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "engine/core/assert.h"
#include "engine/gpu/fence.h"
#include "fluid/render/backend.h"
#include "fluid/render/raymarch.h"
#include "fluid/validate/image_flip.h"
#include "fluid/validate/surface_pictures.h"

namespace rivulet {

namespace {

constexpr double kMoment = 0.6;               // s, of the dam break
constexpr double kSlowMotion = 16;            // times slower than 60 frames a second: water of 2 m/s moves by 0.7 pixels a frame
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
    if (reference) out.look.quality = "fine";  // all of the light, whatever is compared with it
    if (look.reach > 0) out.look.smoothing = look.reach * spacing;
    return out;
}

SurfaceMap referenceMap(const SplatSet& splats, const FrameView& view, bool spray = false) {
    std::vector<vec4> at = splats.at;
    for (vec4& p : at)
        if (spray && p.w >= 0) p.w = 1;
    const Result<IsoSurface> surface =
        IsoSurface::create(bodyAtWalls(at, splats.spacing, splats.box, holdsTogether(splats.viscosity, splats.spacing)), splats.spacing);
    ASSERT(surface, "particles have a spacing of more than 0");
    RaymarchPicture picture = raymarch(*surface, view, {.box = splats.box, .until = {}});
    SurfaceMap map{picture.width, picture.height, std::move(picture.depth), {}};
    for (const vec4& water : picture.water) map.normal.emplace_back(water);
    return map;
}

std::vector<bool> whereThere(const SurfaceMap& map) {
    std::vector<bool> there(map.depth.size());
    for (size_t i = 0; i < there.size(); ++i) there[i] = map.there(i);
    return there;
}

// Without the pixels where the surface lies in a face of the box.
SurfaceMap withoutWalls(SurfaceMap map, const FrameView& view, const Bounds& box) {
    const dmat4 toWorld = glm::inverse(dmat4(view.view)), projection(view.projection);
    const double wall = 1e-4 * double{glm::length(box.size())};
    for (size_t i = 0; i < map.depth.size(); ++i) {
        if (!map.there(i)) continue;
        const auto width = static_cast<size_t>(map.width);
        const size_t row = i / width;
        const double u = 2 * (static_cast<double>(i % width) + 0.5) / map.width - 1,
                     v = 2 * (static_cast<double>(row) + 0.5) / map.height - 1, depth = double{map.depth[i]};
        const glm::dvec4 seen(depth * (u + projection[2][0]) / projection[0][0], depth * (v + projection[2][1]) / projection[1][1], -depth,
                              1);
        const dvec3 p(toWorld * seen), in = glm::min(glm::abs(p - dvec3(box.min)), glm::abs(dvec3(box.max) - p));
        if (std::min({in.x, in.y, in.z}) < wall) map.depth[i] = kNoDepth;
    }
    return map;
}

// The same with the top row first, as pictures have it.
std::vector<bool> topFirst(const std::vector<bool>& bottomFirst, int width) {
    std::vector<bool> out;
    for (auto row = bottomFirst.end(); row != bottomFirst.begin(); row -= width) out.insert(out.end(), row - width, row);
    return out;
}

SplatSet splatsOf(FluidWorld& world) {
    const ParticleView water = world.particles();
    Device& device = world.device();
    SplatSet now{device.readAll<vec4>(*water.drawn, water.slots), world.params().spacing, {}};
    for (size_t k = 0; k < 3 && water.ellipsoids[0] != nullptr; ++k)
        now.ellipsoids[k] = device.readAll<vec4>(*water.ellipsoids[k], water.slots);
    now.viscosity = water.viscosity;
    now.box.add(world.params().box.min);
    now.box.add(world.params().box.max);
    return now;
}

double rmsSpeed(FluidWorld& world) {  // mm/s
    const HostParticles now = readParticles(world);
    double sum = 0;
    for (const vec4& v : now.velocity) sum += double{glm::dot(vec3(v), vec3(v))};
    return 1000 * std::sqrt(sum / std::max<double>(1, static_cast<double>(now.velocity.size())));
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

Result<SurfaceTrial::Seen> SurfaceTrial::seen(const SplatSet& splats, const FrameView& view, const SceneFile& scene) {
    const Result<FluidLook> look = fluidLookOf(scene.look, scene.fluid.liquid);
    if (!look) return look.error();
    const float radius = scene.look.radiusSpacings * splats.spacing;
    Result<SurfaceSeen> found =
        probe_.see(splats.at, {.radius = radius, .spacing = splats.spacing, .viscosity = splats.viscosity, .bounds = splats.box}, view,
                   *look, scene.look.splats == "ellipsoids" && !look->fast ? splats.ellipsoids : HostEllipsoids{});
    if (!found) return found.error();
    Seen seen{{view.width, view.height, std::move(found->depth), {}}, {}};
    fillNormals(seen.map, view, radius);
    for (size_t i = 0; i < found->cover.size(); ++i) {
        seen.covered.push_back(found->cover[i] >= 0.5F);
        if (!seen.covered[i]) seen.map.depth[i] = kNoDepth;
    }
    return seen;
}

Result<std::vector<ShapeErrors>> SurfaceTrial::shapes(const SurfaceLook& look) {
    std::vector<ShapeErrors> all;
    for (const SurfaceShape& shape : shapes_) {
        SurfaceMap map;
        if (look.filter == kSurfaceReference) {
            map = referenceMap(shape.splats, shape.view);
        } else {
            Result<Seen> found = seen(shape.splats, shape.view, sceneOf(scene_, look, shape.splats.spacing));
            if (!found) return found.error();
            map = std::move(found->map);
        }
        all.push_back({&shape, compareSurfaces(map, shape.reference, scene_.look.radiusSpacings * shape.splats.spacing)});
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
    now_ = splatsOf(world);
    view_ = viewOf(scene_, *session_);
    reference_ = referenceMap(now_, view_);
    referenceCovered_ = whereThere(referenceMap(now_, view_, true));
    Result<std::vector<uint8_t>> picture = pictureOf(sceneOf(scene_, {kSurfaceReference}, now_.spacing));
    if (!picture) return picture.error();
    referencePicture_ = std::move(*picture);
    return ok();
}

Result<MomentErrors> SurfaceTrial::moment(const SurfaceLook& look) {
    if (Status s = reachMoment(); !s) return s.error();
    if (stopped_) return MomentErrors{};
    const SceneFile scene = sceneOf(scene_, look, now_.spacing);
    const Result<Seen> found = seen(now_, view_, scene);
    if (!found) return found.error();
    const Result<std::vector<uint8_t>> picture = pictureOf(scene);
    if (!picture) return picture.error();
    if (settings_.savePicture)
        if (Status saved = savePictures(look, *found, *picture); !saved) return saved.error();
    return MomentErrors{compareSurfaces(found->map, withoutWalls(reference_, view_, now_.box), scene.look.radiusSpacings * now_.spacing),
                        compareSurfaces(found->map, reference_, scene.look.radiusSpacings * now_.spacing),
                        overlapOf(found->covered, referenceCovered_), flipMean(referencePicture_, *picture, width(), height())};
}

Result<std::vector<double>> SurfaceTrial::drawMs(const FrameView& view, const SceneFile& scene, const FluidView& fluid, int before,
                                                 int count) {
    std::vector<double> ms;
    for (int k = -before; k < count; ++k) {
        const auto start = std::chrono::steady_clock::now();
        if (Status s = renderer_->draw(view, fluid, session_->solids(), scene); !s) return s.error();
        gpu::Fence::now().wait();
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

std::string SurfaceTrial::drawnBy() const { return currentGlFacts().renderer; }

Result<Watched> SurfaceTrial::watch(const Watch& of, std::span<const SurfaceLook> looks) {
    FluidWorld& world = of.session.world();
    FluidUpload upload;
    std::vector<Flicker> rms;
    std::vector<UnexplainedChange> changes(looks.size(), UnexplainedChange(width(), height()));
    Watched watched;
    for (int f = 0; f < of.frames; ++f) {
        if (!goOn(of.from + (of.to - of.from) * f / of.frames)) return Watched{};
        of.session.step(of.seconds, true);
        if (Status stepped = world.lastStep(); !stepped && !world.interrupted()) return stepped.error();
        const SplatSet now = splatsOf(world);
        const auto pictureBy = [&](const SurfaceLook& look) -> Result<std::vector<uint8_t>> {
            const SceneFile scene = sceneOf(of.scene, look, now.spacing);
            const Result<FluidView> fluid = upload.view(world, scene.look);
            if (!fluid) return fluid.error();
            if (Status s = renderer_->draw(of.view, *fluid, of.session.solids(), scene); !s) return s.error();
            return renderer_->pixels();
        };
        if (f == 0) {
            watched.speed = rmsSpeed(world);
            rms.assign(looks.size(), Flicker(topFirst(whereThere(referenceMap(now, of.view)), width())));
        }
        const Result<std::vector<uint8_t>> reference = pictureBy({kSurfaceReference});
        if (!reference) return reference.error();
        for (size_t k = 0; k < looks.size(); ++k) {
            if (looks[k].filter == kSurfaceReference) {
                rms[k].add(*reference);
                continue;
            }
            const Result<std::vector<uint8_t>> picture = pictureBy(looks[k]);
            if (!picture) return picture.error();
            const Result<Seen> found = seen(now, of.view, sceneOf(of.scene, looks[k], now.spacing));
            if (!found) return found.error();
            rms[k].add(*picture);
            changes[k].add(*picture, *reference, topFirst(found->covered, width()));
        }
    }
    for (size_t k = 0; k < looks.size(); ++k) watched.looks.push_back({rms[k].rms(), changes[k].mean(), changes[k].edges()});
    return watched;
}

Result<Watched> SurfaceTrial::slow(std::span<const SurfaceLook> looks, int frames) {
    if (Status s = reachMoment(); !s) return s.error();
    if (stopped_) return Watched{};
    Result<Watched> watched =
        watch({*session_, scene_, view_, 1.0 / (kSlowMotion * kFramesPerSecond), frames, kMomentShare, kSlowShare}, looks);
    session_.reset();  // the moment is over
    return watched;
}

Result<Watched> SurfaceTrial::still(std::span<const SurfaceLook> looks, int frames) {
    // The drawn surface is judged, not the solver: the pool is as calm as it can be.
    std::vector<std::string> assignments = {"fluid.spacing=0.025",           "fluid.artificialViscosity=0.05", "fluid.dfsph.tolerance=1e-4",
                                            "camera.position=0.95,0.85,1.2", "camera.target=0.25,0.28,0.25",   "camera.fieldOfView=36"};
    assignments.insert(assignments.end(), settings_.assignments.begin(), settings_.assignments.end());
    const Result<SceneFile> scene = loadScene("cases/hydrostatic.json", assignments);
    if (!scene) return scene.error();
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *settings_.device, settings_.log);
    if (!session) return session.error();
    const double settled = kSlowShare + 0.5 * (1 - kSlowShare);
    for (int f = 0; f < kSettling; ++f) {
        if (!goOn(kSlowShare + (settled - kSlowShare) * f / kSettling)) return Watched{};
        (*session)->step(1.0 / kFramesPerSecond, true);
    }
    return watch({**session, *scene, viewOf(*scene, **session), 1.0 / kFramesPerSecond, frames, settled, 1}, looks);
}

Status SurfaceTrial::savePictures(const SurfaceLook& look, const Seen& seen, const std::vector<uint8_t>& picture) const {
    const std::string name = fmt::format("surface_{}{}", look.filter, look.quality.empty() ? "" : "_" + look.quality);
    const auto save = [&](const std::string& as, const std::vector<uint8_t>& rgba) {
        return settings_.savePicture(as, rgba, width(), height());
    };
    if (Status s = save("surface_reference", referencePicture_); !s) return s;
    if (Status s = save(name, picture); !s) return s;
    if (Status s = save(name + "_flip", flipPicture(referencePicture_, picture, width(), height())); !s) return s;
    return save(name + "_normals", errorPicture(seen.map, reference_));
}

}  // namespace rivulet
