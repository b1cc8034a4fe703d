// Writes the results of chapter 4: a table, a plot, and a page that explains them.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/file.h"
#include "fluid/validate/chapter4.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

// The variants that run in turn at each number of particles, in the order of the table.
struct SearchVariant {
    const char *grid, *walk, *name;
};
constexpr SearchVariant kSearchVariants[] = {
    {"linked_list", "", "lists, without collision"},   {"linked_list", "thesis", "lists, the thesis's walk"},
    {"linked_list", "exact", "lists, the exact walk"}, {"sorted", "", "sorted, without collision"},
    {"sorted", "exact", "sorted, the exact walk"},
};

const Chapter4Row* find(const Chapter4& chapter, int particles, const SearchVariant& way) {
    const auto row = std::find_if(chapter.rows.begin(), chapter.rows.end(), [&](const Chapter4Row& r) {
        return !r.sizes && r.particles == particles && r.grid == way.grid && r.walk == way.walk;
    });
    return row == chapter.rows.end() ? nullptr : &*row;
}

std::vector<int> counts(const Chapter4& chapter) {
    std::vector<int> all;
    for (const Chapter4Row& r : chapter.rows)
        if (!r.sizes && std::find(all.begin(), all.end(), r.particles) == all.end()) all.push_back(r.particles);
    return all;
}

std::string csvOf(const Chapter4& chapter, const std::string& machine) {
    std::string csv =
        fmt::format("# {}; {}x{} pixels by {}\nparticles,grid,walk,workGroup,framesPerSecond,least,most,frameMs,stepMs,drawMs\n", machine,
                    chapter.width, chapter.height, chapter.drawnBy);
    for (const Chapter4Row& r : chapter.rows)
        csv += fmt::format("{},{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", r.particles, r.grid, r.walk.empty() ? "none" : r.walk,
                           r.workGroup, r.frames.median, r.frames.min, r.frames.max, r.frameMs, r.stepMs, r.drawMs);
    return csv;
}

Plot plotOf(const Chapter4& chapter) {
    Plot plot{"A column of water on a hollow mesh (thesis, fig. 4.8)", "particles", "frames a second", {}, true, true};
    for (const SearchVariant& way : kSearchVariants) {
        Curve curve{way.name, true, {}};
        for (const int particles : counts(chapter))
            if (const Chapter4Row* row = find(chapter, particles, way)) curve.points.emplace_back(particles, row->frames.median);
        plot.curves.push_back(std::move(curve));
    }
    plot.curves.push_back({"the thesis, GTX 650, with collision: above this", false, {{kThesisParticles, kThesisFrames}}});
    return plot;
}

std::string perSecond(const Chapter4Row* row) {
    return row == nullptr ? "" : fmt::format("{:.3g} ({:.3g} to {:.3g})", row->frames.median, row->frames.min, row->frames.max);
}

// Collision's share of a frame, %: each run against the run without collision beside it.
Spread shareOfFrame(const Chapter4Row& with, const Chapter4Row& without) {
    std::vector<double> shares;
    for (size_t k = 0; k < std::min(with.runMs.size(), without.runMs.size()); ++k)
        shares.push_back(100 * (with.runMs[k] - without.runMs[k]) / with.runMs[k]);
    return spreadOf(shares);
}

// The share of collision's kernels in all kernels of a step, %, by the device's clock.
double shareOfStep(const Chapter4Row& row) {
    double all = 0, collision = 0;
    for (const auto& [name, ms] : row.passes) {
        all += ms;
        if (name == "fluid/solids/collide" || name == "fluid/solids/walls") collision += ms;
    }
    return all > 0 ? 100 * collision / all : 0;
}

// Compared with the two figures of the thesis.
std::string verdict(const Chapter4& chapter) {
    std::string text = "| the thesis, on a GTX 650 | here |\n| --- | --- |\n";
    const Chapter4Row *with = find(chapter, kThesisParticles, kSearchVariants[1]),
                      *exact = find(chapter, kThesisParticles, kSearchVariants[4]);
    if (with != nullptr && exact != nullptr)
        text += fmt::format(
            "| {} particles with collision: above {} frames a second | {:.3g} with lists and the thesis's walk ({:.3g} ms per step, {:.3g} "
            "ms of drawing); {:.3g} with the sorted grid and the exact walk |\n",
            kThesisParticles, kThesisFrames, with->frames.median, with->stepMs, with->drawMs, exact->frames.median);
    std::vector<double> frames, steps;
    for (const int particles : counts(chapter)) {
        const Chapter4Row *on = find(chapter, particles, kSearchVariants[1]), *off = find(chapter, particles, kSearchVariants[0]);
        if (particles <= kThesisHalf || on == nullptr || off == nullptr) continue;
        frames.push_back(shareOfFrame(*on, *off).median);
        steps.push_back(shareOfStep(*on));
    }
    const auto range = [](const std::vector<double>& all) {
        const auto [least, most] = std::minmax_element(all.begin(), all.end());
        return all.size() > 1 ? fmt::format("{:.0f} to {:.0f} %", *least, *most) : fmt::format("{:.0f} %", *least);
    };
    if (!frames.empty())
        text += fmt::format(
            "| above {} particles collision costs about half the frame | lists and the thesis's walk, above as many particles: {} of the "
            "frame, {} of the step |\n",
            kThesisHalf, range(frames), range(steps));
    return text + '\n';
}

std::string sharesOf(const Chapter4& chapter) {
    std::string text =
        "\n## The share of collision\n\nFrame: a run with collision against the run without it beside it, median (minimum to maximum); "
        "negative where the times of this machine vary by more than collision costs. Step: the share of collision's kernels in all kernels "
        "of the step, by the device's clock.\n\n"
        "| particles | lists, the thesis's walk: frame | step | lists, the exact walk: frame | step | sorted, the exact walk: frame | step "
        "|\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const auto& [with, without] : {std::pair(1, 0), std::pair(2, 0), std::pair(4, 3)}) {
            const Chapter4Row *on = find(chapter, particles, kSearchVariants[with]),
                              *off = find(chapter, particles, kSearchVariants[without]);
            if (on == nullptr || off == nullptr) continue;
            const Spread of = shareOfFrame(*on, *off);
            text += fmt::format(" {:.0f} % ({:.0f} to {:.0f}) | {:.1f} % |", of.median, of.min, of.max, shareOfStep(*on));
        }
        text += '\n';
    }
    return text;
}

std::string groupsOf(const Chapter4& chapter) {
    std::string rows;
    const Chapter4Row* best = nullptr;
    for (const Chapter4Row& r : chapter.rows) {
        if (!r.sizes) continue;
        if (best == nullptr || r.stepMs < best->stepMs) best = &r;
        rows += fmt::format("| {} | {} | {:.3g} | {:.3g} |\n", r.workGroup, perSecond(&r), r.stepMs, r.drawMs);
    }
    if (best == nullptr) return {};
    return fmt::format(
               "## Work groups\n\nWith {} particles, lists and the thesis's walk. A step is shortest with {} threads (the thesis used "
               "{}).\n\n"
               "| threads | frames a second | step, ms | drawing, ms |\n| --- | --- | --- | --- |\n",
               best->particles, best->workGroup, kThesisWorkGroup) +
           rows;
}

std::string pageOf(const Chapter4& chapter, const std::string& machine, const std::string& command, bool picture) {
    std::string text = fmt::format(
        "# Chapter 4 of the thesis: measurements repeated\n\nWritten by `{}` on: {}, backend gl and pictures by {}, from "
        "[chapter4.csv](chapter4.csv). Scene: a column of water has fallen onto {}, hollow, voxelised at {}. A frame is one step of method "
        "wcsph_thesis and one picture of {}x{} pixels with the mesh and particles as points; each step and picture is waited for. Work "
        "groups have {} threads. \"Lists\" is `fluid.grid: \"linked_list\"`, the four dispatches of the thesis (4.2); \"sorted\" is the "
        "default grid. All variants start from the same water and run in turn. Figures are the median (minimum to maximum) of the runs. "
        "[references.md](references.md) says what the thesis is.\n\n",
        command, machine, chapter.drawnBy, chapter.mesh, chapter.voxels, chapter.width, chapter.height, kThesisWorkGroup);
    text += verdict(chapter);
    if (picture) text += "![frames a second against particles](chapter4.svg)\n\n";
    text += "## Frames a second\n\n| particles |";
    for (const SearchVariant& way : kSearchVariants) text += fmt::format(" {} |", way.name);
    text += "\n| --- | --- | --- | --- | --- | --- |\n";
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const SearchVariant& way : kSearchVariants) text += fmt::format(" {} |", perSecond(find(chapter, particles, way)));
        text += '\n';
    }
    text += "\n## Time of a step, ms\n\nThe step alone; drawing is the last column.\n\n| particles |";
    for (const SearchVariant& way : kSearchVariants) text += fmt::format(" {} |", way.name);
    text += " drawing |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const SearchVariant& way : kSearchVariants)
            if (const Chapter4Row* row = find(chapter, particles, way)) text += fmt::format(" {:.3g} |", row->stepMs);
        if (const Chapter4Row* row = find(chapter, particles, kSearchVariants[1])) text += fmt::format(" {:.3g} |\n", row->drawMs);
    }
    return text + sharesOf(chapter) + '\n' + groupsOf(chapter);
}

}  // namespace

Status writeChapter4(const Chapter4& chapter, const std::string& folder, const std::string& machine, const std::string& command) {
    const std::filesystem::path to(folder);
    if (Status wrote = writeFileAtomic((to / "chapter4.csv").string(), csvOf(chapter, machine)); !wrote) return wrote;
    const Status drawn = drawPlot(plotOf(chapter), (to / "chapter4.svg").string());
    const std::string page = pageOf(chapter, machine, command, static_cast<bool>(drawn));
    if (Status wrote = writeFileAtomic((to / "chapter4.md").string(), page); !wrote) return wrote;
    return drawn;
}

}  // namespace rivulet
