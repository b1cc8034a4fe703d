// Writes the results of chapter 2: a table, a plot, and a page that explains them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "engine/core/file.h"
#include "fluid/validate/chapter2.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

constexpr double kThesisStepMs = 36.08, kThesisDrawMs = 9.01;  // of 65,536 particles, on a Quadro FX 5800
constexpr int kThesisAt = 65536, kThesisMany = 100000;
constexpr double kThesisManyFrames = 10;  // a second, above that

const Chapter2Row* find(const Chapter2& chapter, int particles, const std::string& name) {
    const auto row = std::find_if(chapter.rows.begin(), chapter.rows.end(),
                                  [&](const Chapter2Row& r) { return r.particles == particles && nameOf(r.way) == name; });
    return row == chapter.rows.end() ? nullptr : &*row;
}

template <class Of>
auto distinct(const Chapter2& chapter, Of of) {
    std::vector<decltype(of(chapter.rows.front()))> all;
    for (const Chapter2Row& r : chapter.rows)
        if (std::find(all.begin(), all.end(), of(r)) == all.end()) all.push_back(of(r));
    return all;
}
std::vector<int> counts(const Chapter2& chapter) {
    return distinct(chapter, [](const Chapter2Row& r) { return r.particles; });
}
std::vector<std::string> ways(const Chapter2& chapter) {
    return distinct(chapter, [](const Chapter2Row& r) { return nameOf(r.way); });
}

// The steps of the thesis (fig. 2.1). A GPU finds neighbours within its sweeps, so only the sort remains of step 2.
const char* stepOf(const std::string& pass) {
    if (pass == "fluid/grid/cell_count") return "1, cells";
    for (const char* sort : {"scan_", "cell_", "reorder", "cpu_sort", "cpu_neighbor"})
        if (pass.find(sort) != std::string::npos) return "2, neighbours";
    if (pass.find("density") != std::string::npos) return "3, density";
    if (pass.find("forces") != std::string::npos) return "4, forces";
    return "5, integration and the rest";
}
constexpr const char* kSteps[] = {"1, cells", "2, neighbours", "3, density", "4, forces", "5, integration and the rest"};

std::string csvOf(const Chapter2& chapter, const std::string& machine) {
    std::string csv = fmt::format("# {}; {}x{} pixels by {}\nparticles,way,frameMs,least,most,stepMs,drawMs,overlapMs\n", machine,
                                  chapter.width, chapter.height, chapter.drawnBy);
    for (const Chapter2Row& r : chapter.rows)
        csv += fmt::format("{},\"{}\",{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g}\n", r.particles, nameOf(r.way), r.way.frameMs.median,
                           r.way.frameMs.min, r.way.frameMs.max, r.way.stepMs, r.way.drawMs, r.way.overlapMs);
    return csv;
}

Plot plotOf(const Chapter2& chapter) {
    Plot plot{"A falling column of water (thesis, fig. 2.9)", "particles", "ms per frame", {}};
    for (const std::string& way : ways(chapter)) {
        Curve curve{way, true, {}};
        for (const int particles : counts(chapter))
            if (const Chapter2Row* row = find(chapter, particles, way)) curve.points.emplace_back(particles, row->way.frameMs.median);
        plot.curves.push_back(std::move(curve));
    }
    plot.curves.push_back({"the thesis, Quadro FX 5800", false, {{kThesisAt, kThesisStepMs + kThesisDrawMs}}});
    return plot;
}

// Compared with the two figures of the thesis.
std::string verdict(const Chapter2& chapter) {
    const auto fastest = [&](int particles) {
        const Chapter2Row* best = nullptr;
        for (const Chapter2Row& r : chapter.rows)
            if (r.particles == particles && (best == nullptr || r.way.frameMs.median < best->way.frameMs.median)) best = &r;
        return best;
    };
    std::string text = "| the thesis, on a Quadro FX 5800 | here |\n| --- | --- |\n";
    const Chapter2Row* alone = nullptr;  // one device: plan `behind` hides the step within the drawing
    for (const Chapter2Row& r : chapter.rows)
        if (r.particles == kThesisAt && r.way.plan == Plan::alone && (alone == nullptr || r.way.frameMs.median < alone->way.frameMs.median))
            alone = &r;
    if (alone != nullptr)
        text += fmt::format(
            "| {} particles: {} ms of simulation and {} ms of drawing | {}: {:.3g} ms of simulation and {:.3g} ms of drawing; the fastest "
            "frame {:.3g} ms ({}) |\n",
            kThesisAt, kThesisStepMs, kThesisDrawMs, alone->way.backend, alone->way.stepMs, alone->way.drawMs,
            fastest(kThesisAt)->way.frameMs.median, nameOf(fastest(kThesisAt)->way));
    const Chapter2Row* many = nullptr;
    for (const int particles : counts(chapter))
        if (particles > kThesisMany && many == nullptr) many = fastest(particles);
    if (many != nullptr)
        text += fmt::format("| above {} particles: above {} frames a second | {} particles: {:.3g} frames a second ({}) |\n", kThesisMany,
                            kThesisManyFrames, many->particles, 1000 / many->way.frameMs.median, nameOf(many->way));
    return text + '\n';
}

std::string sharesOf(const Chapter2& chapter) {
    std::string text =
        "\n## The share of each step (thesis, fig. 2.4)\n\nShare of the kernels' time in %, one device alone, by the device's clock; the "
        "last column is drawing in ms. Neighbours are found by sorting particles into cells. A GPU walks the cells within steps 3 and 4. "
        "The cpu computes cells during the sort, in step 2, and keeps neighbour lists.\n\n| particles | "
        "device |";
    for (const char* step : kSteps) text += fmt::format(" {} |", step);
    text += " kernels, ms | drawing, ms |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const Chapter2Row& r : chapter.rows) {
        if (r.way.plan != Plan::alone) continue;
        std::map<std::string, double> of;
        double all = 0;
        for (const auto& [pass, ms] : r.way.passes) {
            of[stepOf(pass)] += ms;
            all += ms;
        }
        text += fmt::format("| {} | {} |", r.particles, r.way.backend);
        for (const char* step : kSteps) text += fmt::format(" {:.0f} |", all > 0 ? 100 * of[step] / all : 0.0);
        text += fmt::format(" {:.3g} | {:.3g} |\n", all, r.way.drawMs);
    }
    return text;
}

// The aim: within 5 % of the best plan.
std::string pickedOf(const Chapter2& chapter) {
    constexpr double kAim = 0.05;
    std::string text =
        "`--cooperate auto` measures all plans for a few seconds and chooses:\n\n| particles | plan | its frame time above the best "
        "plan's, median of the runs |\n| --- | --- | --- |\n";
    size_t within = 0;
    for (const Chapter2::Picked& p : chapter.picked) {
        text += fmt::format("| {} | {} | {:.1f} % |\n", p.particles, p.name, 100 * p.behind);
        within += p.behind <= kAim ? 1 : 0;
    }
    text += fmt::format("\nThe aim is 5 %: {} of {} meet it.", within, chapter.picked.size());
    if (within < chapter.picked.size())
        text += " Where it is missed, two plans differ by less than the spread of their runs: see minimum and maximum below.";
    return text + "\n\n";
}

// The gain of each plan over its device alone.
std::string gainOf(const Chapter2& chapter) {
    std::string text = "\nA plan compared with its device alone, run by run, in % of a frame (negative is faster):\n\n| particles |";
    std::vector<std::string> names;
    for (const std::string& way : ways(chapter))
        if (way.find(',') != way.npos) names.push_back(way);
    for (const std::string& way : names) text += fmt::format(" {} |", way);
    text += "\n| --- |";
    for (size_t k = 0; k < names.size(); ++k) text += " --- |";
    text += '\n';
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const std::string& way : names) {
            const Chapter2Row *own = find(chapter, particles, way), *alone = find(chapter, particles, way.substr(0, way.find(',')));
            text += own == nullptr || alone == nullptr ? " |" : fmt::format(" {:+.0f} |", 100 * beyond(own->way, alone->way));
        }
        text += '\n';
    }
    return text +
           "\nllvmpipe, PoCL and the cpu run on the same cores. There, overlapping work shares these cores and saves no time; only a GPU "
           "can show a gain.\n";
}

std::string pageOf(const Chapter2& chapter, const std::string& machine, const std::string& command, bool picture) {
    std::string text = fmt::format(
        "# Chapter 2 of the thesis: measurements repeated\n\nWritten by `{}` on: {}, pictures by {}, from [chapter2.csv](chapter2.csv); "
        "devices: {}. Scene: a column of water in free fall. A frame is one step of method wcsph_thesis and one picture of {}x{} pixels. "
        "Plan `thesis`: the CPU computes the cells of the next step while the GPU draws (thesis 2.3). Plan `behind`: the cpu simulates "
        "while OpenGL draws the frame before. Variants with the same number of particles run in turn. Figures are the median (minimum to "
        "maximum) of the runs. [references.md](references.md) says what the thesis is.\n\n",
        command, machine, chapter.drawnBy, fmt::join(chapter.devices, "; "), chapter.width, chapter.height);
    text += verdict(chapter);
    text += pickedOf(chapter);
    if (picture) text += "![ms a frame against particles](chapter2.svg)\n\n";
    text += "## One device against CPU and GPU together (thesis, fig. 2.9)\n\nMilliseconds per frame.\n\n| particles |";
    const std::vector<std::string> names = ways(chapter);
    for (const std::string& way : names) text += fmt::format(" {} |", way);
    text += "\n| --- |";
    for (size_t k = 0; k < names.size(); ++k) text += " --- |";
    text += '\n';
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const std::string& way : names) {
            const Chapter2Row* row = find(chapter, particles, way);
            text += row == nullptr
                        ? " |"
                        : fmt::format(" {:.3g} ({:.3g} to {:.3g}) |", row->way.frameMs.median, row->way.frameMs.min, row->way.frameMs.max);
        }
        text += '\n';
    }
    text += "\nMilliseconds per frame in which the main thread draws while another thread simulates:\n\n| particles |";
    for (const std::string& way : names)
        if (way.find(',') != way.npos) text += fmt::format(" {} |", way);
    text += "\n| --- |";
    for (const std::string& way : names)
        if (way.find(',') != way.npos) text += " --- |";
    text += '\n';
    for (const int particles : counts(chapter)) {
        text += fmt::format("| {} |", particles);
        for (const std::string& way : names)
            if (const Chapter2Row* row = find(chapter, particles, way); row != nullptr && row->way.plan != Plan::alone)
                text += fmt::format(" {:.3g} |", row->way.overlapMs);
        text += '\n';
    }
    return text + gainOf(chapter) + sharesOf(chapter);
}

}  // namespace

Status writeChapter2(const Chapter2& chapter, const std::string& folder, const std::string& machine, const std::string& command) {
    const std::filesystem::path to(folder);
    if (Status wrote = writeFileAtomic((to / "chapter2.csv").string(), csvOf(chapter, machine)); !wrote) return wrote;
    const Status drawn = drawPlot(plotOf(chapter), (to / "chapter2.svg").string());
    const std::string page = pageOf(chapter, machine, command, static_cast<bool>(drawn));
    if (Status wrote = writeFileAtomic((to / "chapter2.md").string(), page); !wrote) return wrote;
    return drawn;
}

}  // namespace rivulet
