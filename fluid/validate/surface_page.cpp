// Writes the chart of the drawn surface: a table, a plot, and a page that explains them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/core/file.h"
#include "fluid/render/filters.h"
#include "fluid/validate/surface.h"
#include "fluid/validate/surface_chart.h"

namespace rivulet {

namespace {

// The measures by which filters are compared; smaller is better.
struct Figure {
    const char* name;
    double (*of)(const SurfaceChartRow& row);
};
constexpr Figure kFigures[] = {
    {"the dam break's normals (median)", [](const SurfaceChartRow& r) { return r.moment->errors.normalMedian; }},
    {"the dam break's depth (median)", [](const SurfaceChartRow& r) { return r.moment->errors.depthMedian; }},
    {"the dam break's silhouette", [](const SurfaceChartRow& r) { return 1 - r.moment->errors.overlap; }},
    {"the dam break's picture (FLIP)", [](const SurfaceChartRow& r) { return r.moment->flip; }},
    {"the sphere's normals", [](const SurfaceChartRow& r) { return r.sphere.normalMean; }},
    {"the slab's normals", [](const SurfaceChartRow& r) { return r.slab.normalMean; }},
    {"flicker at rest", [](const SurfaceChartRow& r) { return r.still.rms; }},
    {"flicker in slow motion", [](const SurfaceChartRow& r) { return r.slow.change; }},
    {"flicker of silhouettes", [](const SurfaceChartRow& r) { return r.slow.edges; }},
    {"time", [](const SurfaceChartRow& r) { return r.times.water.median; }},
};

constexpr double kAlike = 0.03;  // a fraction: values this near to the best count as equal to it

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (size_t k = 0; k < words.size(); ++k) text += (k == 0 ? "" : k + 1 == words.size() ? " and " : ", ") + words[k];
    return text;
}

std::string nameOf(const SurfaceLook& look) {
    return look.reach > 0 ? fmt::format("{}, reach {:.1f} spacings", look.filter, look.reach) : look.filter;
}

// How the default filter changes with the shorter reach.
std::string reachText(const SurfaceChart& chart) {
    const auto shorter = std::find_if(chart.rows.begin(), chart.rows.end(), [](const SurfaceChartRow& r) { return r.look.reach > 0; });
    if (shorter == chart.rows.end()) return {};
    std::vector<std::string> better, worse;
    for (const Figure& f : kFigures) {
        const double own = f.of(chart.rows.front()), now = f.of(*shorter);
        if (std::abs(now - own) > kAlike * own)
            (now < own ? better : worse).push_back(fmt::format("{} ({:.3g} to {:.3g})", f.name, own, now));
    }
    return fmt::format(
        "The reach of a filter matters as well as its kind. With a reach of {:.1f} spacings the default is better at {} and worse at {}. "
        "The default reach stays at {:.1f}, because bumps of the iso-surface come from particles and not from the water: with the shorter "
        "reach milk, honey and waves look lumpy.",
        shorter->look.reach, better.empty() ? "nothing" : joined(better), worse.empty() ? "nothing" : joined(worse),
        filterReach({}, 1.0F).reach);
}

std::string verdict(const SurfaceChart& chart, const std::string& quality, float reach = 0) {
    std::vector<const SurfaceChartRow*> rows;
    for (const SurfaceChartRow& row : chart.rows)
        if (row.moment && row.look.quality == quality && row.look.reach == reach) rows.push_back(&row);
    const SurfaceChartRow& standard = *rows.front();
    std::vector<std::vector<std::string>> best(rows.size());
    std::vector<std::string> beaten;
    for (const Figure& f : kFigures) {
        const auto least = std::min_element(rows.begin(), rows.end(), [&](const auto* a, const auto* b) { return f.of(*a) < f.of(*b); });
        const double alike = (1 + kAlike) * f.of(**least);
        // A filter as good as the best counts as the best.
        const size_t winner = f.of(standard) <= alike ? 0 : static_cast<size_t>(least - rows.begin());
        best[winner].emplace_back(f.name);
        if (winner != 0)
            beaten.push_back(fmt::format("{} ({:.3g} against {}'s {:.3g})", f.name, f.of(standard), (*least)->look.filter, f.of(**least)));
    }
    std::string text =
        fmt::format("At quality {}{}, ", quality, reach > 0 ? fmt::format(" and a reach of {:.1f} spacings for all", reach) : "");
    std::vector<std::string> parts;
    for (size_t k = 0; k < rows.size(); ++k)
        parts.push_back(fmt::format("**{}** is best at {}", rows[k]->look.filter, best[k].empty() ? "nothing" : joined(best[k])));
    for (size_t k = 0; k < parts.size(); ++k) text += (k > 0 ? "; " : "") + parts[k];
    text += fmt::format(" (values within {:.0f} % of the best count for the default). ", 100 * kAlike);
    return text + (beaten.empty()
                       ? fmt::format("The default, {}, is nowhere worse than another filter.", standard.look.filter)
                       : fmt::format("The default, {}, is worse than another filter at {}.", standard.look.filter, joined(beaten)));
}

std::string csvOf(const SurfaceChart& chart, const std::string& machine) {
    std::string csv = fmt::format(
        "# {}; {}x{} pixels by {}\n"
        "filter,quality,reach,frameMs,frameMsLeast,frameMsMost,waterMs,waterMsLeast,waterMsMost,normalMean,normalMedian,depthMedian,"
        "depthRms,"
        "overlap,overlapWithSpray,flip,flicker,stillChange,slowChange,slowEdges,sphereNormalMean,sphereDepthRms,slabNormalMean,"
        "slabDepthRms\n",
        machine, chart.width, chart.height, chart.drawnBy);
    for (const SurfaceChartRow& r : chart.rows) {
        csv += fmt::format("{},{},{:g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},", r.look.filter, r.look.quality, r.look.reach,
                           r.times.frame.median, r.times.frame.min, r.times.frame.max, r.times.water.median, r.times.water.min,
                           r.times.water.max);
        csv += r.moment ? fmt::format("{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},", r.moment->errors.normalMean,
                                      r.moment->errors.normalMedian, r.moment->errors.depthMedian, r.moment->errors.depthRms,
                                      r.moment->errors.overlap, r.moment->overlapOfAll, r.moment->flip)
                        : ",,,,,,,";
        csv += fmt::format("{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", r.still.rms, r.still.change, r.slow.change,
                           r.slow.edges, r.sphere.normalMean, r.sphere.depthRms, r.slab.normalMean, r.slab.depthRms);
    }
    return csv;
}

Plot plotOf(const SurfaceChart& chart) {
    Plot plot{"The drawn dam break against the reference", "ms for the water", "normals off, median, deg", {}};
    for (const SurfaceChartRow& r : chart.rows)
        if (r.moment)
            plot.curves.push_back(
                {fmt::format("{}, {}", nameOf(r.look), r.look.quality), false, {{r.times.water.median, r.moment->errors.normalMedian}}});
    return plot;
}

std::string msText(const Spread& ms) {
    return ms.count > 1 ? fmt::format("{:.1f} ({:.1f} to {:.1f})", ms.median, ms.min, ms.max) : fmt::format("{:.0f}", ms.median);
}

std::string pageOf(const SurfaceChart& chart, const std::string& machine, const std::string& command, bool picture) {
    std::string text = fmt::format(
        "# The drawn surface: quality against time\n\n"
        "Written by `{}` on: {}, drawn by {}, at {}x{} pixels, from [surface.csv](surface.csv). The reference is the iso-surface of the "
        "same particles, ray-marched in double precision. All figures are measured as in `rivulet validate surface`.\n\n",
        command, machine, chart.drawnBy, chart.width, chart.height);
    if (picture) text += "![normals' error against ms](surface.svg)\n\n";
    text += verdict(chart, "fine") + "\n\n" + reachText(chart) + " " + verdict(chart, "fine", kShortReach) + "\n\n" +
            verdict(chart, "fast") + "\n\n";
    text += "| filter | method |\n| --- | --- |\n";
    for (const SurfaceChartRow& r : chart.rows)
        if (const FilterRow* filter = filters().find(r.look.filter); filter != nullptr && r.look.quality == "fine" && r.look.reach == 0)
            text += fmt::format("| {} | {} |\n", filter->name, filter->doc);
    text += fmt::format(
        "\n## Dam break, {} particles\n\nTimes are wall milliseconds of a whole picture and of the share that water adds: median (minimum "
        "to maximum). Normals and depth (in radii of a drawn particle) are compared where both pictures show a surface; spray and edges "
        "dominate the means, not the medians. Overlap is that of the silhouettes of the body of the water, and in brackets of body and "
        "spray: pixels in both over pixels in either, of those that are covered at least by half (1 is best). In place of a particle's "
        "droplets the reference of the latter has a ball. FLIP is the difference of the pictures (0 to 1); both have the same light, "
        "shadows and spray, at quality fine the same reflections and caustics too (fast: no reflections of the scene, coarser "
        "caustics).\n\n"
        "| filter | quality | frame, ms | water, ms | normals, mean, deg | median | depth, median, radii | rms | overlap | FLIP |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
        chart.particles);
    for (const SurfaceChartRow& r : chart.rows) {
        text += fmt::format("| {} | {} | {} | {} | ", nameOf(r.look), r.look.quality, msText(r.times.frame), msText(r.times.water));
        text += r.moment ? fmt::format("{:.1f} | {:.1f} | {:.3f} | {:.2f} | {:.3f} ({:.3f}) | {:.4f} |\n", r.moment->errors.normalMean,
                                       r.moment->errors.normalMedian, r.moment->errors.depthMedian, r.moment->errors.depthRms,
                                       r.moment->errors.overlap, r.moment->overlapOfAll, r.moment->flip)
                         : " | | | | | |\n";
    }
    text += fmt::format(
        "\n## Exact shapes, and flicker\n\nA settled drop is compared with a sphere, a pool with a plane. Flicker at rest is measured on a "
        "pool over {} simulated frames: the rms difference of its pixels from their mean. The flicker of the reference shows how far the "
        "water does move. Change is what changes from picture to picture beyond the change of the reference there, max(|change| - "
        "|reference's change|, 0), mean over the pixels with water: at rest, and over {} frames of the dam break, 16 times slower than "
        "real "
        "time; \"edges\" is the same over the pixels within 2 of a silhouette.\n\n"
        "| filter | quality | sphere: normals, mean, deg | depth, rms, radii | slab: normals | depth | at rest: flicker, of 255 | change | "
        "slow: change | edges |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
        chart.stillFrames, chart.slowFrames);
    for (const SurfaceChartRow& r : chart.rows)
        text += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", nameOf(r.look),
                            r.look.quality, r.sphere.normalMean, r.sphere.depthRms, r.slab.normalMean, r.slab.depthRms, r.still.rms,
                            r.still.change, r.slow.change, r.slow.edges);
    return text;
}

}  // namespace

Status writeSurfaceChart(const SurfaceChart& chart, const std::string& folder, const std::string& machine, const std::string& command) {
    const std::filesystem::path to(folder);
    if (Status wrote = writeFileAtomic((to / "surface.csv").string(), csvOf(chart, machine)); !wrote) return wrote;
    const Status drawn = drawPlot(plotOf(chart), (to / "surface.svg").string());
    const std::string page = pageOf(chart, machine, command, static_cast<bool>(drawn));
    if (Status wrote = writeFileAtomic((to / "surface.md").string(), page); !wrote) return wrote;
    return drawn;
}

}  // namespace rivulet
