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
// Of the dam break.
constexpr double kMostMean = 8, kMostMedian = 4;  // degrees
constexpr double kMostMissed = 0.05;              // of the silhouettes' overlap
constexpr double kMostFlip = 0.02;

struct SurfaceRun {
    Outcome outcome = {};

    void found(std::string what, const char* unit, double measured, double reference, std::optional<double> tolerance = {}) {
        outcome.findings.push_back({std::move(what), unit, measured, reference, std::abs(measured - reference), tolerance});
    }
    struct Aims {
        std::optional<double> mean = {}, median = {}, overlap = {};
    };
    void found(const std::string& of, const SurfaceErrors& e, bool silhouette, const Aims& aims) {
        found(of + ": normals, mean", "deg", e.normalMean, 0, aims.mean);
        found(of + ": normals, median", "deg", e.normalMedian, 0, aims.median);
        found(of + ": normals, 95 % below", "deg", e.normal95, 0);
        found(of + ": depth, rms", "radii", e.depthRms, 0);
        found(of + ": depth, median", "radii", e.depthMedian, 0);
        if (silhouette) found(of + ": silhouettes' overlap", "", e.overlap, 1, aims.overlap);
    }
    void found(const std::string& of, const Steadiness& s, int frames, std::optional<double> rms, std::optional<double> change) {
        found(fmt::format("{}, {} frames: flicker, rms", of, frames), "/255", s.rms, 0, rms);
        found(fmt::format("{}: change beyond the reference's", of), "/255", s.change, 0, change);
        found(fmt::format("{}: the same along silhouettes", of), "/255", s.edges, 0);
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
    const SurfaceLook look{settings.method}, looks[] = {{settings.method, "fine"}, {settings.method, "fast"}};
    SurfaceRun u;
    u.outcome.method = settings.method;
    const Result<std::vector<ShapeErrors>> shapes = trial->shapes(look);
    if (!shapes) return shapes.error();
    for (const ShapeErrors& s : *shapes) {
        u.found(s.shape->name, s.errors, s.shape->whole, {.mean = s.shape->judged ? std::optional(kMostDegrees) : std::nullopt});
        u.outcome.particles = std::max(u.outcome.particles, static_cast<uint32_t>(s.shape->splats.at.size()));
    }
    if (settings.method != kSurfaceReference) {
        // Of the full size: at the quick one a spacing has two and a half pixels.
        const auto aim = [&](double most) { return settings.quick ? std::nullopt : std::optional(most); };
        for (const SurfaceLook& drawn : looks) {
            const Result<MomentErrors> moment = trial->moment(drawn);
            if (!moment) return moment.error();
            if (trial->stopped()) return u.outcome;
            const std::string of = "dam break, " + drawn.quality;
            u.found(of, moment->errors, true, {aim(kMostMean), {}, aim(kMostMissed)});
            u.found(of + ", free surface: normals, mean", "deg", moment->free.normalMean, 0);
            u.found(of + ", free surface: normals, median", "deg", moment->free.normalMedian, 0, aim(kMostMedian));
            u.found(of + ": overlap with the spray", "", moment->overlapOfAll, 1);
            u.found(of + ": FLIP", "", moment->flip, 0, aim(kMostFlip));
        }
        const int slowFrames = settings.quick ? 12 : 32, stillFrames = settings.quick ? 16 : 48;
        const Result<Watched> slow = trial->slow(looks, slowFrames);
        if (!slow) return slow.error();
        if (trial->stopped()) return u.outcome;
        const Result<Watched> still = trial->still(looks, stillFrames);
        if (!still) return still.error();
        if (trial->stopped()) return u.outcome;
        for (size_t k = 0; k < std::size(looks); ++k) {
            // At the quick size the halved surface of quality fast has one and a quarter pixels a spacing, and its change is 1.05.
            const std::optional<double> change = looks[k].quality == "fast" ? aim(kMostFlicker) : kMostFlicker;
            u.found("slow dam break, " + looks[k].quality, slow->looks[k], slowFrames, {}, change);
            u.found("still pool, " + looks[k].quality, still->looks[k], stillFrames, kMostFlicker, kMostFlicker);
        }
        u.found("still pool: speed, rms", "mm/s", still->speed, 0);
    }
    if (settings.method != surfaceMethods().front())
        for (Finding& f : u.outcome.findings) f.tolerance.reset();
    return u.outcome;
}

}  // namespace rivulet
