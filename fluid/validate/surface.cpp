// The water's surface as it is drawn, against spheres and planes and against the ray-marched truth (fluid/render/raymarch.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/bridge/run_stats.h"
#include "fluid/bridge/scene_renderer.h"
#include "fluid/bridge/surface_probe.h"
#include "fluid/render/filters.h"
#include "fluid/render/raymarch.h"
#include "fluid/validate/image_flip.h"
#include "fluid/validate/surface.h"
#include "fluid/validate/surface_metrics.h"

namespace rivulet {

namespace {

constexpr int kWidth = 640, kHeight = 360;  // pixels
constexpr float kSpacing = 0.01F;           // m, of the shapes
constexpr float kBall = 0.2F;               // m, radius
constexpr float kPool = 0.3F;               // m, half its side
constexpr float kDepth = 0.1F;              // m, of the pool
constexpr double kMostDegrees = 2;          // mean error of normals on analytic shapes
constexpr double kMostFlicker = 1;          // of 255
constexpr double kFrame = 0.6;              // s: the moment of the real frame
constexpr const char* kTruth = "truth";

struct Particles {
    std::vector<vec4> at;  // w: density ratio
    float spacing = kSpacing;
    Bounds box;
};

// The same numbers on every machine, -1 .. 1.
class Jitter {
  public:
    explicit Jitter(double spacings) : size_(spacings) {}
    vec3 operator()() { return {next(), next(), next()}; }

  private:
    float next() {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<float>(size_ * (static_cast<double>(state_ >> 40U) / 8388608.0 - 1));
    }
    double size_;
    uint64_t state_ = 1;
};

// A cubic lattice, jittered by so many spacings, where `in` (m) says so.
template <class In>
Particles lattice(double jitter, const In& in) {
    Jitter off(jitter);
    Particles p;
    const int reach = static_cast<int>(std::ceil(kPool / kSpacing)) + 1;
    for (int z = -reach; z < reach; ++z)
        for (int y = -reach; y < reach; ++y)
            for (int x = -reach; x < reach; ++x) {
                const vec3 at = kSpacing * (vec3(x, y, z) + 0.5F);
                if (in(at)) p.at.emplace_back(at + kSpacing * off(), 1.0F);
            }
    return p;
}

// As tension leaves a drop: shells one spacing apart, particles evenly on each (Swinbank & Purser 2006), then jittered.
Particles settledBall(double jitter) {
    Jitter off(jitter);
    Particles p;
    for (float r = kBall - 0.5F * kSpacing; r > 0; r -= kSpacing) {
        const int count = std::max(static_cast<int>(std::lround(4 * kPi * r * r / (kSpacing * kSpacing))), 1);
        for (int k = 0; k < count; ++k) {
            const float y = (2.0F * static_cast<float>(k) + 1) / static_cast<float>(count) - 1, flat = std::sqrt(1 - y * y);
            const float turn = 2.39996323F * static_cast<float>(k) + 100 * r;
            p.at.emplace_back(r * vec3(flat * std::cos(turn), y, flat * std::sin(turn)) + kSpacing * off(), 1.0F);
        }
    }
    return p;
}

Particles pool(double jitter) {
    Particles p = lattice(jitter, [](const vec3& x) { return std::abs(x.x) < kPool && std::abs(x.z) < kPool && x.y < 0 && x.y > -kDepth; });
    p.box.add({-kPool, -kDepth, -kPool});
    p.box.add({kPool, kDepth, kPool});
    return p;
}

FrameView viewOf(const vec3& from, const vec3& target, float fieldOfView) {
    Camera camera;
    camera.position = from;
    camera.target = target;
    camera.fieldOfView = fieldOfView;
    camera.nearPlane = 0.05F;
    camera.farPlane = 10;
    return frameViewOf(camera, LightParams{}, kWidth, kHeight, 0);
}

// What `depth` (along a world ray whose view depth is 1, from the camera) says a surface is; normals by `normal` (world).
template <class Depth, class Normal>
SurfaceMap analytic(const FrameView& view, const Depth& depth, const Normal& normal) {
    SurfaceMap map{view.width, view.height, {}, {}};
    const dmat4 projection(view.projection);
    const dmat3 turn = glm::transpose(dmat3(view.view));
    const dvec3 eye(view.cameraPosWorld);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const double u = 2 * (x + 0.5) / view.width - 1, v = 2 * (y + 0.5) / view.height - 1;
            const dvec3 way = turn * dvec3(u / projection[0][0], v / projection[1][1], -1);
            const double t = depth(eye, way);
            map.depth.push_back(static_cast<float>(t));
            map.normal.emplace_back(glm::transpose(turn) * normal(eye + t * way));
        }
    return map;
}

SurfaceMap sphereMap(const FrameView& view, double radius) {
    return analytic(
        view,
        [=](const dvec3& eye, const dvec3& way) {
            const double a = glm::dot(way, way), b = glm::dot(eye, way), root = b * b - a * (glm::dot(eye, eye) - radius * radius);
            return root < 0 ? double{kNoDepth} : (-b - std::sqrt(root)) / a;
        },
        [](const dvec3& p) { return glm::normalize(p); });
}

// The pool's level, away from its walls.
SurfaceMap levelMap(const FrameView& view) {
    return analytic(
        view,
        [](const dvec3& eye, const dvec3& way) {
            const double t = way.y < 0 ? -eye.y / way.y : double{kNoDepth};
            const dvec3 p = eye + t * way;
            const double room = double{kPool} - 6 * double{kSpacing};
            return std::abs(p.x) < room && std::abs(p.z) < room ? t : double{kNoDepth};
        },
        [](const dvec3&) { return dvec3(0, 1, 0); });
}

SurfaceMap truthMap(const Particles& particles, const FrameView& view) {
    const Result<IsoSurface> surface = IsoSurface::create(particles.at, particles.spacing);
    ASSERT(surface, "particles have a spacing of more than 0");
    RaymarchPicture picture = raymarch(*surface, view, {.box = particles.box, .until = {}});
    SurfaceMap map{picture.width, picture.height, std::move(picture.depth), {}};
    for (const vec4& water : picture.water) map.normal.emplace_back(water);
    return map;
}

struct Under {
    const CaseSettings& settings;
    SurfaceProbe probe;
    SceneFile plain;  // whose look the shapes have
    Outcome outcome = {};

    bool truth() const { return settings.method == kTruth; }
    void choose(SceneFile& scene) const {
        if (!truth()) scene.look.filter = settings.method;
    }
    void found(std::string what, const char* unit, double measured, double reference, std::optional<double> tolerance = {}) {
        outcome.findings.push_back({std::move(what), unit, measured, reference, std::abs(measured - reference), tolerance});
    }
    void found(const std::string& of, const SurfaceErrors& e, bool silhouette, std::optional<double> degrees = {}) {
        found(of + ": normals, mean", "deg", e.normalMean, 0, degrees);
        found(of + ": normals, 95 % below", "deg", e.normal95, 0);
        found(of + ": depth, rms", "radii", e.depthRms, 0);
        if (silhouette) found(of + ": silhouettes' overlap", "", e.overlap, 1);
    }

    Result<SurfaceMap> drawn(const Particles& particles, const FrameView& view, const SceneFile& scene) {
        if (truth()) return truthMap(particles, view);
        const Result<FluidLook> look = fluidLookOf(scene);
        if (!look) return look.error();
        const float radius = scene.look.radiusSpacings * particles.spacing;
        Result<std::vector<float>> depth =
            probe.depth(particles.at, {.radius = radius, .spacing = particles.spacing, .bounds = particles.box}, view, *look);
        if (!depth) return depth.error();
        SurfaceMap map{view.width, view.height, std::move(*depth), {}};
        fillNormals(map, view, radius);
        return map;
    }

    Status shape(const std::string& name, const Particles& particles, const FrameView& view, const SurfaceMap& reference, bool whole,
                 bool judged) {
        Result<SurfaceMap> map = drawn(particles, view, plain);
        if (!map) return map.error();
        const SurfaceErrors e = compareSurfaces(*map, reference, plain.look.radiusSpacings * particles.spacing);
        found(name, e, whole, judged ? std::optional(kMostDegrees) : std::nullopt);
        outcome.particles = std::max(outcome.particles, static_cast<uint32_t>(particles.at.size()));
        return ok();
    }

    Status shapes() {
        const FrameView ball = viewOf({0.25F, 0.35F, 0.8F}, vec3(0.0F), 34), level = viewOf({0.1F, 0.42F, 0.85F}, vec3(0, 0, 0), 34);
        const SurfaceMap sphere = sphereMap(ball, double{kBall}), plane = levelMap(level);
        // A ball cut out of a lattice has terraces, a drop at rest has none: the former is only reported.
        const auto inBall = [](const vec3& p) { return glm::length(p) < kBall; };
        if (Status s = shape("sphere", settledBall(0.1), ball, sphere, true, true); !s) return s;
        if (Status s = shape("sphere cut from a lattice", lattice(0, inBall), ball, sphere, true, false); !s) return s;
        if (Status s = shape("sphere cut from a jittered lattice", lattice(0.25, inBall), ball, sphere, true, false); !s) return s;
        if (Status s = shape("slab", pool(0.1), level, plane, false, true); !s) return s;
        return shape("slab, jittered by a quarter", pool(0.25), level, plane, false, false);
    }

    // A dam that breaks, at a moment: the surface and the picture against the truth's.
    Status realFrame() {
        Result<SceneFile> scene = loadScene("dam_break.json", settings.assignments);
        if (!scene) return scene.error();
        choose(*scene);
        Result<std::unique_ptr<Session>> session = Session::create(*scene, *settings.device, settings.log);
        if (!session) return session.error();
        FluidWorld& world = (*session)->world();
        while (world.time() < kFrame - 1e-6) {
            if (!settings.goOn(0.3 * world.time() / kFrame)) return ok();
            (*session)->step(1.0 / kFramesPerSecond, true);
        }
        Particles now{readParticles(world).position, world.params().spacing, {}};
        now.box.add(world.params().box.min);
        now.box.add(world.params().box.max);
        const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, kWidth, kHeight, 0);
        Result<SurfaceMap> map = drawn(now, view, *scene);
        if (!map) return map.error();
        found("dam break", compareSurfaces(*map, truthMap(now, view), scene->look.radiusSpacings * now.spacing), true);

        Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
        if (!renderer) return renderer.error();
        FluidUpload upload;
        std::vector<uint8_t> pictures[2];
        for (const bool truth : {false, true}) {
            SceneFile look = *scene;
            look.look.renderer = truth ? "truth" : "screen_space";
            const Result<FluidView> fluid = upload.view(world, look.look);
            if (!fluid) return fluid.error();
            if (Status s = (*renderer)->draw(view, *fluid, (*session)->solids(), look); !s) return s;
            pictures[truth ? 1 : 0] = (*renderer)->pixels();
        }
        found("dam break: FLIP", "", flipMean(pictures[1], pictures[0], kWidth, kHeight), 0);
        return ok();
    }

    // A pool that has come to rest goes on being simulated: what moves in its picture should not.
    Status still() {
        std::vector<std::string> assignments = {"fluid.spacing=0.025", "camera.position=0.95,0.85,1.2", "camera.target=0.25,0.28,0.25",
                                                "camera.fieldOfView=36"};
        assignments.insert(assignments.end(), settings.assignments.begin(), settings.assignments.end());
        Result<SceneFile> scene = loadScene("cases/hydrostatic.json", assignments);
        if (!scene) return scene.error();
        choose(*scene);
        Result<std::unique_ptr<Session>> session = Session::create(*scene, *settings.device, settings.log);
        if (!session) return session.error();
        Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
        if (!renderer) return renderer.error();
        const int settling = 120, frames = settings.quick ? 30 : 120;
        const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, kWidth, kHeight, 0);
        FluidUpload upload;
        std::optional<Flicker> flicker;
        for (int f = 0; f < settling + frames; ++f) {
            if (!settings.goOn(0.3 + 0.7 * f / (settling + frames))) return ok();
            (*session)->step(1.0 / kFramesPerSecond, true);
            if (f < settling) continue;
            if (!flicker) {
                Particles now{readParticles((*session)->world()).position, scene->fluid.spacing, {}};
                const SurfaceMap map = truthMap(now, view);
                std::vector<bool> water(map.depth.size());  // pictures have their top row first
                for (size_t i = 0; i < water.size(); ++i) water[i] = map.there((size_t{kHeight} - 1 - i / kWidth) * kWidth + i % kWidth);
                flicker.emplace(std::move(water));
            }
            const Result<FluidView> fluid = upload.view((*session)->world(), scene->look);
            if (!fluid) return fluid.error();
            if (Status s = (*renderer)->draw(view, *fluid, (*session)->solids(), *scene); !s) return s;
            flicker->add((*renderer)->pixels());
        }
        found(fmt::format("still pool over {} frames: flicker, rms", frames), "/255", flicker->rms(), 0, kMostFlicker);
        return ok();
    }
};

}  // namespace

std::vector<std::string> surfaceMethods() {
    std::vector<std::string> names;
    for (const FilterRow& row : filters().rows)
        if (std::string_view(row.name) != "none") names.emplace_back(row.name);
    names.emplace_back(kTruth);
    return names;
}

Result<Outcome> runSurface(const CaseSettings& settings) {
    // A gl device has a context that is current.
    Result<SurfaceProbe> probe = SurfaceProbe::create(settings.device->backend() != Backend::gl);
    if (!probe) return failed(fmt::format("the case surface draws what it measures, and that needs OpenGL: {}", probe.error().message));
    Under u{settings, std::move(*probe), {}};
    u.choose(u.plain);
    u.outcome.method = settings.method;
    if (Status s = u.shapes(); !s) return s.error();
    if (!u.truth()) {
        if (Status s = u.realFrame(); !s) return s.error();
        if (Status s = u.still(); !s) return s.error();
    }
    if (settings.method != surfaceMethods().front())
        for (Finding& f : u.outcome.findings) f.tolerance.reset();
    return u.outcome;
}

}  // namespace rivulet
