#include "fluid/render/filters.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace rivulet {
namespace {

using gpu::FrameGraph;
using gpu::PassContext;
using gpu::Program;
using gpu::TextureDesc;
using gpu::TextureHandle;

// Steps of the levels, relative; the small ones last: they iron out what the holes of the others leave. The nearer the camera, the more
// pixels the same metres are, and the more levels there are between a pixel and the widest.
constexpr float kFarSteps[] = {3, 5, 7, 4, 2, 1};
constexpr float kMiddleSteps[] = {4, 9, 13, 8, 5, 3, 2, 1};
constexpr float kNearSteps[] = {6, 14, 22, 13, 8, 5, 3, 2, 1};
constexpr float kNearestSteps[] = {10, 24, 37, 22, 13, 8, 5, 3, 2, 1};
constexpr float kUnitPixels = 3.0F;     // a step of 1 is no wider than this
constexpr float kWholePixels = 1.0e6F;  // m: so large that the limit in pixels decides
constexpr float kMostBilateral = 96;    // pixels either side
// With a reach of 1 the dam break's normals are nearer to the particles' iso-surface (docs/surface.md), whose bumps are the particles' and
// not the water's: milk, honey and waves are the worse for it to the eye.
constexpr float kReachSpacings = 1.8F;
constexpr float kRangeSpacings = 4.2F;
constexpr float kBendSpacings = 0.3F;

// The steps, and how long one of 1 is, m. A level of step k adds k^2 / 2 to the variance of the whole; a Gaussian reaches two deviations.
// `pixels`: of a step of 1, where the water is nearest.
struct Levels {
    std::span<const float> steps;
    float unit, pixels;
};
Levels levelsOf(const FluidDraw& d, float reach) {
    const Bounds& box = d.fluid.bounds;
    const float away = box.empty() ? 1.0F : glm::length(d.view.cameraPosWorld - glm::clamp(d.view.cameraPosWorld, box.min, box.max));
    const float pixelsPerMetre =
        0.5F * static_cast<float>(d.view.height) * d.view.projection[1][1] / d.view.spreadAt(std::max(away, d.view.nearPlane));
    Levels levels{};
    for (const std::span<const float> steps : {std::span<const float>(kFarSteps), std::span<const float>(kMiddleSteps),
                                               std::span<const float>(kNearSteps), std::span<const float>(kNearestSteps)}) {
        float squares = 0;
        for (const float step : steps) squares += 0.5F * step * step;
        levels = {steps, 0.5F * reach / std::sqrt(squares), 0.5F * reach / std::sqrt(squares) * pixelsPerMetre};
        if (levels.pixels <= kUnitPixels) break;
    }
    return levels;
}

TextureDesc depthDesc(const FluidDraw& d) { return {.width = d.view.width, .height = d.view.height, .format = gpu::Format::r32f}; }

// A filter's pass; the last one cuts at the box.
template <class Setup>
TextureHandle addStep(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FilterRow& own, TextureHandle tiles,
                      TextureHandle from, bool final, Setup setup) {
    const float huge = 1.0e5F;
    const Bounds box = d.fluid.bounds.empty() ? Bounds{vec3(-huge), vec3(huge)} : d.fluid.bounds;
    return addTiled(graph, "smooth", programs, d, programs.filter(own, final), tiles, from, depthDesc(d), kNoDepth,
                    [=](Program& p, const PassContext&) {
                        setup(p);
                        if (!final && !own.knowsBox) return;
                        p.set("low", box.min);
                        p.set("high", box.max);
                    });
}

TextureHandle addNarrowRange(const FilterRow& own, FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles,
                             TextureHandle spheres) {
    const FilterReach f = filterReach(d.look, d.fluid.spacing);
    const Levels levels = levelsOf(d, f.reach);
    struct Level {
        float metres, mostPixels;
    };
    std::vector<Level> all = {{0, 0}};  // the first marks the walls of the box
    for (const float step : levels.steps) all.push_back({step * levels.unit, step * kUnitPixels});
    // A level of step k leaves what repeats every k pixels. Down to one pixel there is one for each that may be left, whatever the
    // distance.
    for (const float pixels : {2.0F, 1.0F})
        if (pixels == 1 || levels.pixels > 1.5F) all.push_back({kWholePixels, pixels});
    TextureHandle depth = spheres;
    for (size_t k = 0; k < all.size(); ++k)
        depth = addStep(graph, programs, d, own, tiles, depth, k + 1 == all.size(), [=, level = all[k]](Program& p) {
            p.set("step_", level.metres);
            p.set("maxStep", level.mostPixels);
            p.set("range", f.range);
            p.set("bend", f.bend);
            p.set("first", k == 0 ? 1 : 0);
        });
    return depth;
}

TextureHandle addBilateral(const FilterRow& own, FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles,
                           TextureHandle spheres) {
    const FilterReach f = filterReach(d.look, d.fluid.spacing);
    TextureHandle depth = spheres;
    for (const ivec2 axis : {ivec2(1, 0), ivec2(0, 1)})
        depth = addStep(graph, programs, d, own, tiles, depth, axis.y == 1, [=](Program& p) {
            p.set("axis", axis);
            p.set("reach", f.reach);
            p.set("range", f.range);
            p.set("most", kMostBilateral);
        });
    return depth;
}

TextureHandle addCurvatureFlow(const FilterRow& own, FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles,
                               TextureHandle spheres) {
    const FilterReach f = filterReach(d.look, d.fluid.spacing);
    const Levels levels = levelsOf(d, f.reach);
    TextureHandle depth = spheres;
    for (size_t k = 0; k < 2 * levels.steps.size(); ++k) {  // each twice: a step flows half as far as a level smooths
        const float step = levels.steps[k / 2];
        depth = addStep(graph, programs, d, own, tiles, depth, k + 1 == 2 * levels.steps.size(), [=](Program& p) {
            p.set("step_", step * levels.unit);
            p.set("maxStep", step * kUnitPixels);
            p.set("range", f.range);
        });
    }
    return depth;
}

// The spheres as they are: what the others begin with.
TextureHandle addNone(const FilterRow& own, FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles,
                      TextureHandle spheres) {
    return addStep(graph, programs, d, own, tiles, spheres, true, [](Program&) {});
}

constexpr FilterRow kRows[] = {
    {"narrow_range", "treats depths near a straight line as one surface (Truong & Yuksel 2018), in levels with gaps between samples",
     "screen_space/narrow_range.frag", true, addNarrowRange, true},
    {"bilateral",
     "the thesis's filter, weighted by distance in the picture and in depth (Tomasi & Manduchi 1998), one axis after the other",
     "screen_space/bilateral.frag", true, addBilateral},
    {"curvature_flow", "moves the surface by its mean curvature (van der Laan et al. 2009)", "screen_space/curvature_flow.frag", true,
     addCurvatureFlow},
    {"none", "no smoothing: the particles' depth", "screen_space/unfiltered.frag", false, addNone},
};
constexpr Table<FilterRow> kFilters{kRows};

}  // namespace

const Table<FilterRow>& filters() { return kFilters; }

const FilterRow& unfiltered() {
    return *std::find_if(std::begin(kRows), std::end(kRows), [](const FilterRow& row) { return !row.smooths; });
}

FilterReach filterReach(const FluidLook& look, float spacing) {
    const auto orOf = [&](float given, float spacings) { return given > 0 ? given : spacings * spacing; };
    return {orOf(look.smoothing, kReachSpacings), orOf(look.smoothingRange, kRangeSpacings), kBendSpacings * spacing};
}

}  // namespace rivulet
