// The drawn water surface against spheres and planes and against the ray-marched reference (fluid/render/raymarch.h).
#include "fluid/validate/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fluid/render/filters.h"
#include "fluid/validate/surface_trial.h"

namespace rivulet {

namespace {

constexpr double kMostDegrees = 2;  // mean error of normals on analytic shapes
constexpr double kMostFlicker = 1;  // of 255

struct SurfaceRun {
    Outcome outcome = {};

    void found(std::string what, const char* unit, double measured, double reference, std::optional<double> tolerance = {}) {
        outcome.findings.push_back({std::move(what), unit, measured, reference, std::abs(measured - reference), tolerance});
    }
    void found(const std::string& of, const SurfaceErrors& e, bool silhouette, std::optional<double> degrees = {}) {
        found(of + ": normals, mean", "deg", e.normalMean, 0, degrees);
        found(of + ": normals, median", "deg", e.normalMedian, 0);
        found(of + ": normals, 95 % below", "deg", e.normal95, 0);
        found(of + ": depth, rms", "radii", e.depthRms, 0);
        found(of + ": depth, median", "radii", e.depthMedian, 0);
        if (silhouette) found(of + ": silhouettes' overlap", "", e.overlap, 1);
    }
};

}  // namespace

std::vector<std::string> surfaceMethods() {
    std::vector<std::string> names;
    for (const FilterRow& row : filters().rows)
        if (row.smooths) names.emplace_back(row.name);
    names.emplace_back(kSurfaceReference);
    return names;
}

Result<Outcome> runSurface(const CaseSettings& settings) {
    Result<SurfaceTrial> trial = SurfaceTrial::create(settings);
    if (!trial) return trial.error();
    const SurfaceLook look{settings.method};
    SurfaceRun u;
    u.outcome.method = settings.method;
    const Result<std::vector<ShapeErrors>> shapes = trial->shapes(look);
    if (!shapes) return shapes.error();
    for (const ShapeErrors& s : *shapes) {
        u.found(s.shape->name, s.errors, s.shape->whole, s.shape->judged ? std::optional(kMostDegrees) : std::nullopt);
        u.outcome.particles = std::max(u.outcome.particles, static_cast<uint32_t>(s.shape->splats.at.size()));
    }
    if (settings.method != kSurfaceReference) {
        const Result<MomentErrors> moment = trial->moment(look);
        if (!moment) return moment.error();
        if (trial->stopped()) return u.outcome;
        u.found("dam break", moment->errors, true);
        u.found("dam break: FLIP", "", moment->flip, 0);
        const int stillFrames = settings.quick ? 30 : 120;
        const Result<StillPool> pool = trial->flicker(std::span(&look, 1), stillFrames);
        if (!pool) return pool.error();
        if (trial->stopped()) return u.outcome;
        u.found(fmt::format("still pool over {} frames: flicker, rms", stillFrames), "/255", pool->flicker.front(), 0, kMostFlicker);
        u.found("still pool: speed, rms", "mm/s", pool->speed, 0);
    }
    if (settings.method != surfaceMethods().front())
        for (Finding& f : u.outcome.findings) f.tolerance.reset();
    return u.outcome;
}

}  // namespace rivulet
