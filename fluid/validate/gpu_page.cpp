#include "fluid/validate/gpu_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "engine/core/file.h"
#include "fluid/session/reference_data.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

namespace {

constexpr std::array<const char*, 3> kMethods = {"wcsph", "pbf", "dfsph"};
constexpr std::array<double, 2> kParticles = {1.0e5, 1.0e6};
constexpr std::array<const char*, 2> kShown = {"RTX 3060", "RX 6800"};

double errorOf(double predicted, double measured) { return measured > 0 ? predicted / measured - 1 : 0; }

const GpuSpec* find(const std::vector<GpuSpec>& all, std::string_view name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const GpuSpec& g) { return g.name == name; });
    return found == all.end() ? nullptr : &*found;
}

std::string percent(double share) {
    const double rounded = std::round(100 * share);
    return rounded == 0 ? "0 %" : fmt::format("{:+.0f} %", rounded);
}

// Three digits that count, without an exponent.
std::string threeDigits(double value) {
    if (!(std::abs(value) >= 1000)) return fmt::format("{:.3g}", value);
    const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - 2);
    return fmt::format("{:.0f}", std::round(value / unit) * unit);
}

std::string withCommas(double whole) {
    std::string digits = fmt::format("{:.0f}", whole);
    for (size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
    return digits;
}

std::string headOf(const std::vector<std::string>& columns) {
    std::string names = "|", line = "|";
    for (const std::string& column : columns) names += " " + column + " |", line += " --- |";
    return names + "\n" + line + "\n";
}

// A frame that was measured on a GPU, beside the prediction: with the kernels of that version.
struct MeasuredFrame {
    std::string gpu, backend, method;
    double particles = 0, measured = 0, predicted = 0;
    double error() const { return errorOf(predicted, measured); }
};
std::vector<MeasuredFrame> comparisons(const std::vector<GpuSpec>& gpus) {
    const ReferenceRows table = rowsOf(gpuTables(), "measured");
    std::vector<MeasuredFrame> all;
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto cell = [&](const char* column) { return row[table.column(column)]; };
        const GpuSpec* gpu = find(gpus, cell("gpu"));
        if (gpu == nullptr) continue;
        MeasuredFrame c{gpu->name, std::string(cell("backend")), std::string(cell("method")), numberIn(cell("particles")),
                        numberIn(cell("frame_ms"))};
        c.predicted = predictSteps(*gpu, c.method, c.particles, measuredWork(c.method, c.particles), "kernels_before").ms();
        all.push_back(std::move(c));
    }
    return all;
}

// A picture, or one of its passes, that was measured on a GPU: with the passes of this version.
struct MeasuredPicture {
    std::string gpu, pass;
    double particles = 0, measured = 0, predicted = 0;
    bool whole() const { return pass == "picture"; }
};
std::vector<MeasuredPicture> pictures(const std::vector<GpuSpec>& gpus) {
    const ReferenceRows table = rowsOf(gpuTables(), "measured_pictures");
    std::vector<MeasuredPicture> all;
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto cell = [&](const char* column) { return row[table.column(column)]; };
        const GpuSpec* gpu = find(gpus, cell("gpu"));
        if (gpu == nullptr) continue;
        MeasuredPicture c{gpu->name, std::string(cell("pass")), numberIn(cell("particles")), numberIn(cell("ms"))};
        const FrameCost cost = predictPicture(*gpu, c.particles);
        for (const PassCost& pass : cost.passes)
            if (pass.name == c.pass) c.predicted = pass.ms;
        if (c.whole()) c.predicted = cost.ms();
        all.push_back(std::move(c));
    }
    return all;
}

std::string listOf(const std::vector<std::string>& words) {
    std::string list;
    for (size_t k = 0; k < words.size(); ++k) list += (k == 0 ? "" : k + 1 == words.size() ? " and " : ", ") + words[k];
    return list;
}

// What the devices that were measured say of predictions for others. `here`: errors of simulated frames on the devices of the page.
std::string offBy(const std::vector<GpuSpec>& gpus, const std::vector<double>& here) {
    const std::vector<MeasuredFrame> frames = comparisons(gpus);
    std::string off = " No such GPU was measured.";
    if (!frames.empty()) {
        const auto by = [](const MeasuredFrame& a, const MeasuredFrame& b) { return a.error() < b.error(); };
        const auto [least, most] = std::minmax_element(frames.begin(), frames.end(), by);
        off += fmt::format(" Simulated frames were measured on an {} alone: predictions there are off by {} to {}.", least->gpu,
                           percent(least->error()), percent(most->error()));
    }
    std::vector<std::string> predicted, measured;
    const GpuSpec* drawer = nullptr;
    for (const MeasuredPicture& c : pictures(gpus)) {
        if (!c.whole()) continue;
        predicted.push_back(threeDigits(c.predicted));
        measured.push_back(threeDigits(c.measured));
        drawer = find(gpus, c.gpu);
    }
    if (drawer != nullptr)
        off += fmt::format(
            " Pictures were measured on an {} alone, which draws with only {:.0f} of its {:.0f} multiprocessors: pictures predicted to "
            "take {} ms took {} ms.",
            drawer->name, drawer->drawUnits, drawer->units, listOf(predicted), listOf(measured));
    off += " See [Against a GPU](#against-a-gpu).";
    if (here.empty()) return off;
    const auto [least, most] = std::ranges::minmax(here);
    off += fmt::format(" For simulated frames on devices that are software, the same model without calibration is off by {} to {}: see ",
                       percent(least), percent(most));
    return off + "[Error on the devices here](#error-on-the-devices-here).";
}

std::string predictions(const std::vector<GpuSpec>& gpus, const std::vector<double>& here) {
    std::string page =
        "## Predicted frames\n\nms for a frame of 1/60 s of dam_break with default settings and the method named, and for a picture of it, "
        "1920x1080, quality fine. The numbers in the first row are those of the particles. Of the 132 multiprocessors of an H100, and "
        "of an H200, only 4 can run drawing shaders.\n\n";
    std::vector<std::string> columns = {"GPU"};
    for (const double particles : kParticles) {
        for (const char* method : kMethods) columns.push_back(fmt::format("{}, {}", method, withCommas(particles)));
        columns.push_back(fmt::format("picture, {}", withCommas(particles)));
    }
    page += headOf(columns);
    for (const GpuSpec& gpu : gpus) {
        page += fmt::format("| {} |", gpu.name);
        for (const double particles : kParticles) {
            for (const char* method : kMethods)
                page += fmt::format(" {} |", threeDigits(predictSteps(gpu, method, particles, measuredWork(method, particles)).ms()));
            page += fmt::format(" {} |", threeDigits(predictPicture(gpu, particles).ms()));
        }
        page += "\n";
    }
    const std::string off = offBy(gpus, here);
    for (const char* name : kShown)
        if (const GpuSpec* gpu = find(gpus, name)) {
            const double steps = predictSteps(*gpu, "pbf", 1.0e6, measuredWork("pbf", 1.0e6)).ms(),
                         picture = predictPicture(*gpu, 1.0e6).ms();
            page += fmt::format("\n{}: a frame of a million particles with pbf is predicted to take {} ms: {} to simulate, {} to draw.{}\n",
                                name, threeDigits(steps + picture), threeDigits(steps), threeDigits(picture), off);
        }
    return page + "\n";
}

void addPasses(std::string& page, const FrameCost& cost, double particles, size_t most) {
    for (size_t k = 0; k < std::min(cost.passes.size(), most); ++k) {
        const PassCost& p = cost.passes[k];
        page += fmt::format("| {} | {} | {:.0f} % | {} | {:.0f} | {:.0f} | {:.0f} |\n", p.name, threeDigits(p.ms), 100 * p.ms / cost.ms(),
                            p.bound, p.dispatches, p.operations / particles / std::max(p.dispatches, 1.0),
                            p.bytes / particles / std::max(p.dispatches, 1.0));
    }
}

std::string dominating(const std::vector<GpuSpec>& gpus) {
    const GpuSpec* gpu = find(gpus, kShown[0]);
    if (gpu == nullptr) return "";
    std::string page = fmt::format(
        "## Passes that dominate\n\nPredicted for an {} and 1,000,000 particles. Dispatches: in a frame. Operations, and bytes of memory: "
        "of "
        "one dispatch, over the number of particles. [The model](#the-model) says what limits a pass.\n",
        gpu->name);
    const std::string kHead = headOf({"pass", "ms a frame", "share", "limited by", "dispatches", "operations", "bytes"});
    for (const char* method : kMethods) {
        page += fmt::format("\n`{}`:\n\n{}", method, kHead);
        addPasses(page, predictSteps(*gpu, method, 1.0e6, measuredWork(method, 1.0e6)), 1.0e6, 6);
    }
    page += fmt::format("\nThe picture:\n\n{}", kHead);
    addPasses(page, predictPicture(*gpu, 1.0e6), 1.0e6, 8);
    return page + "\n";
}

// What was measured on the devices here: cells of three tables, as the page has them. Predictions follow from these and from the counts.
using Cells = std::vector<std::string>;
struct DeviceTables {
    std::string machine;
    std::vector<Cells> rates, results, passes;
};
constexpr const char* kErrorsHere = "## Error on the devices here";
constexpr const char* kMeasuredOn = "Measured on: ";
const std::vector<std::string> kRates = {"device",           "bandwidth, GB/s",       "arithmetic, 1e9/s",       "integers, 1e9/s",
                                         "roots, 1e9/s",     "loads, 1e9/s",          "rounds of a loop, 1e9/s", "dispatch, us",
                                         "fragments, 1e9/s", "filtered reads, 1e9/s", "texels, 1e9/s",           "loads in lockstep"};
// Each of their rows goes on with the prediction and its error; kResults with those calibrated, too.
const std::vector<std::string> kResults = {"device", "method", "particles", "substeps", "iterations", "measured"};
const std::vector<std::string> kPasses = {"device", "method", "pass", "measured"};

std::string lineOf(const Cells& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += (cell.empty() ? "" : " ") + cell + " |";
    return line + "\n";
}
Cells cellsOf(std::string_view line) {
    Cells cells;
    for (size_t at = 1, end = 0; (end = line.find('|', at)) != std::string_view::npos; at = end + 1) {
        std::string_view cell = line.substr(at, end - at);
        while (cell.starts_with(' ')) cell.remove_prefix(1);
        while (cell.ends_with(' ')) cell.remove_suffix(1);
        cells.emplace_back(cell);
    }
    return cells;
}
std::string predictedAndError(double predicted, double measured) {
    return fmt::format(" {:.3g} | {} |\n", predicted, percent(errorOf(predicted, measured)));
}

DeviceTables tablesOf(const GpuModelRun& run) {
    DeviceTables t{.machine = machineName(), .rates = {}, .results = {}, .passes = {}};
    const auto shown = [](double value) { return value > 0 ? fmt::format("{:.3g}", value) : std::string(); };
    for (const ExaminedGpu& g : run.gpus) {
        const DeviceRates& r = g.rates;
        t.rates.push_back({fmt::format("{} ({})", g.name, backendName(g.device->backend()))});
        for (const double each : {r.bandwidth / 1e9, r.arithmetic / 1e9, r.integer / 1e9, r.special / 1e9, r.loads / 1e9, r.rounds / 1e9,
                                  1000 * r.dispatchMs, r.fragments / 1e9, r.filtered / 1e9, r.fetches / 1e9, r.loadsInStep})
            t.rates.back().push_back(shown(each));
    }
    for (const SeriesRow& r : run.rows) {
        const std::string particles = fmt::format("{}", r.particles);
        t.results.push_back(
            {r.device, r.method, particles, fmt::format("{:.4g}", r.substeps), fmt::format("{:.4g}", r.iterations), shown(r.stepMs)});
        if (r.drawMs > 0) t.results.push_back({r.device, "picture", particles, "", "", shown(r.drawMs)});
        const bool largest = std::none_of(run.rows.begin(), run.rows.end(), [&](const SeriesRow& o) {
            return o.device == r.device && o.method == r.method && o.particles > r.particles;
        });
        if (!largest) continue;
        const auto add = [&](const std::string& method, const std::map<std::string, double>& measured) {
            double whole = 0;
            for (const auto& [name, ms] : measured) whole += ms;
            for (const auto& [name, ms] : measured)
                if (ms >= 0.02 * whole) t.passes.push_back({r.device, method, name, shown(ms)});
        };
        add(r.method, r.passes);
        if (r.drawMs > 0) add("picture", r.drawPasses);
    }
    return t;
}

// The same of an older page: each table has two lines before its rows.
Result<DeviceTables> tablesIn(const std::string& path) {
    const Result<std::string> page = readFile(path);
    if (!page) return page.error();
    const size_t from = page->find(kErrorsHere);
    std::istringstream lines(from == std::string::npos ? "" : page->substr(from, page->find("\n## ", from) - from));
    DeviceTables t;
    const std::pair<std::vector<Cells>*, const std::vector<std::string>*> tables[] = {
        {&t.rates, &kRates}, {&t.results, &kResults}, {&t.passes, &kPasses}};
    size_t table = 0, inTable = 0;
    bool whole = true;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with(kMeasuredOn)) t.machine = line.substr(std::string_view(kMeasuredOn).size());
        if (!line.starts_with("|")) {
            if (inTable > 0) ++table;
            inTable = 0;
            continue;
        }
        if (table == std::size(tables)) break;
        const auto& [rows, columns] = tables[table];
        Cells cells = cellsOf(line);
        whole = whole && cells.size() >= columns->size();
        cells.resize(columns->size());
        if (++inTable == 1) whole = whole && cells == *columns;
        if (inTable > 2) rows->push_back(std::move(cells));
    }
    if (!whole || t.machine.empty() || t.rates.empty() || t.results.empty() || t.passes.empty())
        return badInput(fmt::format("{} has no tables of measured devices to keep; measure them: bench gpu_model without --quick", path));
    return t;
}

// A device of the table of rates, which names it with its backend: "llvmpipe (...) (gl)".
GpuSpec deviceIn(const DeviceTables& t, const std::string& backend) {
    for (const Cells& row : t.rates) {
        if (!row[0].ends_with("(" + backend + ")")) continue;
        const auto giga = [&](size_t column) { return 1.0e9 * numberIn(row[column]); };
        const DeviceRates rates{.bandwidth = giga(1),
                                .arithmetic = giga(2),
                                .integer = giga(3),
                                .special = giga(4),
                                .loads = giga(5),
                                .loadsInStep = numberIn(row[11]),
                                .rounds = giga(6),
                                .dispatchMs = numberIn(row[7]) / 1000,
                                .fragments = giga(8),
                                .filtered = giga(9),
                                .fetches = giga(10)};
        return measuredGpu(row[0], rates, threadsInStep(backend));
    }
    return {};
}

constexpr const char* kCalibrates = "wcsph";  // its steps say which share of the rates a device reaches; the other methods show the error

// The model of what was measured here, not calibrated.
struct ModelHere {
    std::map<std::string, FrameCost> costs;  // of a device and method, "gl pbf": of its substep, or picture
    std::map<std::string, double> reached;   // of a device: predicted over measured time of kCalibrates
    std::vector<double> errors;              // of simulated frames
    // Nothing for a row of a pass whose frame an edited page lacks.
    FrameCost of(const Cells& row) const {
        const auto found = costs.find(row[0] + " " + row[1]);
        return found == costs.end() ? FrameCost() : found->second;
    }
};
ModelHere modelOf(const DeviceTables& t) {
    ModelHere model;
    for (const Cells& row : t.results) {
        const GpuSpec gpu = deviceIn(t, row[0]);
        const double particles = numberIn(row[2]), substeps = numberIn(row[3]), measured = numberIn(row[5]);
        const bool picture = row[1] == "picture";
        FrameCost cost = picture ? predictPicture(gpu, particles) : predictSteps(gpu, row[1], particles, {substeps, numberIn(row[4])});
        if (!picture) {
            for (PassCost& pass : cost.passes) pass.ms /= substeps;
            model.errors.push_back(errorOf(cost.ms(), measured));
        }
        if (row[1] == kCalibrates) model.reached[row[0]] = cost.ms() / measured;
        model.costs[row[0] + " " + row[1]] = std::move(cost);
    }
    return model;
}

std::string errorsHere(const DeviceTables& t, const ModelHere& model) {
    const auto with = [](std::vector<std::string> columns, const char* predicted) {
        columns.insert(columns.end(), {predicted, "error"});
        return headOf(columns);
    };
    std::string page = fmt::format(
        "{}\n\nThe devices of the machine that measured for this page are software: llvmpipe (OpenGL, `gl`) and PoCL (OpenCL, `cl`). Tiny "
        "kernels (`shaders/bench`) measured their rates. Times are processor time over the number of threads: ms of a substep, or of a "
        "picture. Substeps: those of a step; iterations: those of the pressure solver in a substep; both as measured. The error is the "
        "predicted time over the measured one, less 1.\n\nThe first prediction follows from the rates and the counts; nothing is fitted. "
        "Real kernels reach a part of the rates of tiny ones. `{}` shows which part on each device: its predicted time over its measured "
        "time. The calibrated prediction is the first one divided by that part. It is made for the other methods; pictures are not "
        "calibrated. Predictions for GPUs are not calibrated either.\n\nllvmpipe runs 8 threads in lockstep: all wait while one goes "
        "through code that the others skip. But its loads take their time one thread after the other. Loads in lockstep: the share of a "
        "load's time for which threads that do not load wait too.\n\n{}{}\n\n{}",
        kErrorsHere, kCalibrates, kMeasuredOn, t.machine, headOf(kRates));
    for (const Cells& row : t.rates) page += lineOf(row);
    std::vector<std::string> columns = kResults;
    columns.insert(columns.end(), {"predicted", "error"});
    page += "\n" + with(std::move(columns), "calibrated");
    for (const Cells& row : t.results) {
        const double measured = numberIn(row[5]), predicted = model.of(row).ms();
        std::string line = lineOf(row);
        line.pop_back();
        line += predictedAndError(predicted, measured);
        line.pop_back();
        const auto share = model.reached.find(row[0]);
        const bool calibrated = row[1] != kCalibrates && row[1] != "picture" && share != model.reached.end();
        page += line + (calibrated ? predictedAndError(predicted / share->second, measured) : std::string(" | |\n"));
    }
    page +=
        "\nBy pass: ms of a substep, or of a picture. The measured time of a pass is its share of the time on the wall, times the "
        "substep's or the picture's processor time. Passes of less than 2 % are left out.\n\n" +
        with(kPasses, "predicted");
    for (const Cells& row : t.passes) {
        std::string line = lineOf(row), rest = " | |\n";
        line.pop_back();
        const FrameCost cost = model.of(row);
        for (const PassCost& pass : cost.passes)
            if (pass.name == row[2]) rest = predictedAndError(pass.ms, numberIn(row[3]));
        page += line + rest;
    }
    return page + "\n";
}

std::string errorsThere(const std::vector<GpuSpec>& gpus) {
    std::string page =
        "## Against a GPU\n\nMeasurements of [performance.md](performance.md#on-a-gpu). The model was not fitted to them.\n\nFrames that "
        "an H100 simulated, of dam_break. The predictions are for the kernels of that version (`assets/gpus/kernels_before.csv`, counted "
        "with "
        "1,024 particles).\n\n" +
        headOf({"GPU", "backend", "method", "particles", "measured, ms a frame", "predicted", "error"});
    for (const MeasuredFrame& c : comparisons(gpus))
        page += fmt::format("| {} | {} | {} | {:.0f} | {:.3g} | {:.3g} | {} |\n", c.gpu, c.backend, c.method, c.particles, c.measured,
                            c.predicted, percent(c.error()));
    page +=
        "\nPictures that an H200 drew, and their most expensive passes: dam_break with pbf, 1920x1080, quality fine, GPU time. They were "
        "measured with the version of 2026-11-27; the predictions are for the passes of today. An H200 runs drawing shaders with only 4 of "
        "its 132 multiprocessors (column `draw_units` of `assets/gpus/gpus.csv`), so these figures say little about a GPU that is made to "
        "draw.\n\n" +
        headOf({"GPU", "particles", "pass", "measured, ms", "predicted", "error"});
    for (const MeasuredPicture& c : pictures(gpus))
        page += fmt::format("| {} | {:.0f} | {} | {:.3g} |", c.gpu, c.particles, c.pass, c.measured) +
                predictedAndError(c.predicted, c.measured);
    double copies = 0;
    if (const GpuSpec* gpu = find(gpus, "H200"))
        for (const PassCost& pass : predictPicture(*gpu, 16000).passes)
            if (pass.name == "copy scene") copies = pass.ms;
    page += fmt::format(
        "\nPasses with few operations are furthest off. In a picture of quality fast there, the two copies of the picture, which compute "
        "nothing, took 3.5 ms; the model predicts {:.1g}. So such a GPU has a limit that the model lacks, and no published figure was "
        "found for it. Drawn frames of an H100 (6 and 25 ms for 94,608 and 986,078 particles) are not compared: their pictures had "
        "1280x720 pixels and went into a video.\n",
        copies);
    return page + "\n";
}

std::string beforeAndAfter() {
    const ReferenceRows before = rowsOf(gpuTables(), "kernels_before"), after = rowsOf(gpuTables(), "kernels");
    const auto sum = [](const ReferenceRows& t, const std::vector<std::string_view>& row) {
        double operations = 0;
        for (size_t k = t.column("arithmetic"); k <= t.column("barriers"); ++k) operations += numberIn(row[k]);
        return operations;
    };
    std::string page =
        "## Pair loops, before and after\n\nThe sweeps over neighbours took most of the time in every method. They became cheaper in two "
        "ways (`FOR_PAIRS` in `shaders/fluid/grid/neighbors.h`):\n\n"
        "- A GPU first finds the neighbours within the support radius, which are a sixth of the particles in the cells around, and "
        "computes "
        "the terms of these alone.\n"
        "- The first sweep of a step stores one bit for each particle in these cells, 72 bytes a particle. Later sweeps of the step read "
        "the "
        "bits and do not search again.\n\n"
        "The table compares both versions, counted in a world of 1,024 particles:\n\n"
        "- Operations: of one thread, the mean over all threads and all dispatches of a step.\n"
        "- In lockstep: a GPU runs 32 threads in lockstep, and each waits while others go through code that it skips. Operations of "
        "a thread with these waits.\n"
        "- Longest thread: operations of the longest thread of a dispatch.\n\n"
        "[performance.md](performance.md#on-a-gpu) has the times on the devices here.\n\n" +
        headOf({"kernel", "operations, before", "operations, after", "in lockstep, before", "in lockstep, after", "longest thread, before",
                "longest thread, after"});
    for (const std::vector<std::string_view>& b : before.rows)
        for (const std::vector<std::string_view>& a : after.rows) {
            const auto same = [&](const char* column) { return b[before.column(column)] == a[after.column(column)]; };
            if (!same("method") || !same("kernel") || !same("particles") || numberIn(a[after.column("particles")]) != 1024) continue;
            if (sum(after, a) > 0.9 * sum(before, b)) continue;
            page += fmt::format("| {} | {:.0f} | {:.0f} |", b[before.column("kernel")], sum(before, b), sum(after, a));
            for (const char* column : {"step32", "longest"})
                page += fmt::format(" {:.0f} | {:.0f} |", numberIn(b[before.column(column)]), numberIn(a[after.column(column)]));
            page += "\n";
        }
    return page + "\n";
}

std::string everyKernel(const std::vector<GpuSpec>& gpus) {
    const std::vector<CountedKernel> all = countedKernels();
    const ReferenceRows large = rowsOf(gpuTables(), "kernels");
    std::set<std::string_view> predicted, others;
    for (const std::vector<std::string_view>& row : large.rows) predicted.insert(row[large.column("kernel")]);
    for (const CountedKernel& k : all)
        if (!predicted.contains(k.name)) others.insert(k.name);
    const ReferenceRows notCounted = rowsOf(gpuTables(), "not_counted");
    const auto nameOf = [](const CountedKernel& k) {
        return (k.variant == "-" ? k.name : k.name + "; " + k.variant) + (k.plain ? " (plain)" : "");
    };
    std::string page = fmt::format(
        "\n## Every kernel\n\ndam_break runs {} kernels; the predictions above are of these. {} more were counted in the small worlds of "
        "[tests/races](../tests/races/README.md).\n\n"
        "**These worlds are no benchmark.** They are tests of some hundred particles and a few steps: fixed costs dominate, and most "
        "dispatches fill no GPU. The figures say what a work item of a kernel does. They do not say what a frame of a large scene "
        "takes.\n\n"
        "Work items, and operations of the longest thread: of one dispatch, means of all dispatches of the variant. Operations: of one "
        "work item; in lockstep: with waits, as in the table of pair loops. Bytes: of memory, of one work item, read and written; each "
        "sector "
        "of 32 bytes counts once a dispatch. (plain): counted without the compiler's optimisation, since Oclgrind does not know an "
        "intrinsic of optimised code there; these have more operations than a GPU runs. `assets/gpus/kernels_small.csv` has all columns, "
        "and the kernels of dam_break in these worlds too.\n\n",
        predicted.size(), others.size());
    page += headOf({"kernel; variant", "work items", "operations", "in lockstep", "bytes", "longest thread"});
    for (const CountedKernel& k : all)
        if (others.contains(k.name))
            page += fmt::format("| {} | {:.0f} | {} | {} | {} | {:.0f} |\n", nameOf(k), k.threads, threeDigits(k.operations()),
                                threeDigits(k.step32), threeDigits(k.bytes), k.longest);
    page +=
        "\nSome dispatches are a single work group: one multiprocessor works, and all others of the GPU have nothing to do. Their longest "
        "thread decides, whatever the size of the GPU. `fluid/solids/advance_touching` is always one group; most others have more where a "
        "scene has more rays, points or cells. Predicted times of one dispatch as counted, us, of those over 10 us:\n\n";
    std::vector<std::string> columns = {"kernel; variant", "work items", "longest thread"};
    columns.insert(columns.end(), kShown.begin(), kShown.end());
    page += headOf(columns);
    for (const CountedKernel& k : all) {
        std::string row = fmt::format("| {} | {:.0f} | {:.0f} |", nameOf(k), k.threads, k.longest);
        double most = 0;
        for (const char* name : kShown) {
            const GpuSpec* gpu = find(gpus, name);
            const double us = gpu != nullptr ? 1000 * predictDispatch(*gpu, k) : 0;
            most = std::max(most, us);
            row += fmt::format(" {} |", threeDigits(us));
        }
        if (k.groups == 1 && most > 10) page += row + "\n";
    }
    page += "\nWaits at barriers come on top: a thread waits there for the slowest of its group, which may be another one each time.\n";
    page += "\nNot counted, and why:\n\n" + headOf({"kernel", "reason"});
    for (const std::vector<std::string_view>& row : notCounted.rows)
        page += fmt::format("| {} | {} |\n", row[notCounted.column("kernel")], row[notCounted.column("reason")]);
    return page;
}

constexpr const char* kModel = R"(## The model

Counted, on small worlds, by [tests/gpu_cost](../tests/gpu_cost/README.md): for each kernel operations by kind, loads and stores, the sectors of 32 bytes
that a dispatch touches, the accesses of 32 threads together, the operations of groups of 8, 32 and 64 threads in lockstep, and those of the longest
thread. For each drawing pass: invocations of its shaders, their reads of textures, bytes, and operations.

Kernels are counted with 1,024, 2,662 and 4,563 particles. For larger numbers the counts are extrapolated: a thread inside the water does other work than
one at a wall or at the surface, and the share of those is proportional to 1 / (number of particles)^(1/3). Each count is fitted as a straight line over
that quantity. Some dispatches do not have one thread for each particle: their number of threads is fixed, or is that of cells. A fixed number of threads
has more to do for more particles, and the number of cells grows with them: both are fitted as a straight line over the number of particles.

A dispatch takes the time of a launch, and the longest of these:

| limit | time |
| --- | --- |
| operations | threads x operations in lockstep / (lanes x clock); a root or division counts as 8 operations, a branch as 2 |
| cache | sectors of all accesses / (bytes that the first cache moves in a clock x clock) |
| memory | bytes of all sectors that a dispatch touches, each counted once / bandwidth |
| waits | operations and loads of all threads, each times its latency / threads that the GPU holds at once |
| longest thread | operations and loads of the longest thread, each times its latency |

A drawing pass takes the time of a launch, and the longest of: operations; reads of textures / (texels that the units that draw read in a clock x clock);
bytes read / (bytes that their first caches move in a clock x clock); all bytes / bandwidth; fragments / (pixels written in a clock x clock).

Figures of GPUs are published ones (`assets/gpus/gpus.csv`, with sources). Of a device that is software, each kind of operation has its measured rate; a
drawing pass takes the sum of its operations, written fragments, and filtered and fetched reads.

## Limits of the model

- Simulated frames were compared with one GPU, an H100, and pictures with one, an H200 ([Against a GPU](#against-a-gpu)). All others are not tested,
  and none that is made to draw was: the error of pictures there is not known.
- The errors in [Error on the devices here](#error-on-the-devices-here) come from one machine. Its processor has AVX2, and all runs had 8,192 particles.
  Other numbers of particles, and other versions of Mesa and PoCL, were not compared.
- The errors depend on the processor. On 2026-11-29 a machine with AVX-512 was measured twice. Without calibration, the predicted times of simulated
  frames were too short by 24 % to 42 % on llvmpipe and by 12 % to 18 % on PoCL. With calibration they were too short by 5 % to 23 %. The predicted times
  of the two pictures, which are not calibrated, were too short by 24 % and 32 %.
- The clock is the boost clock, and nothing else runs on the GPU. A GPU that lowers its clock is slower in proportion.
- Counts are of OpenCL C compiled by clang for Oclgrind; a driver's compiler may contract, unroll or spill otherwise.
- No second cache: what misses the first is either in it or read once a dispatch.
- Threads in lockstep wait for each other at the end of each branch and loop; GPUs may let them run apart. The ratio of operations in lockstep to
  operations alone is that of the largest world counted, 4,563 particles. More of these are at walls than of a million: predictions for large worlds are
  too long by that.
- Substeps and iterations are the cpu's, of the first frames of a dam break. An iteration that is queued and then skipped still costs a GPU its launches; they
  are not counted.
- Operations of a fragment shader are those of its compiled text, each once, times the counted reads of textures over the reads in the text. Loops
  that read no texture count once. Of a pass that draws with several programs, the operations are those of the last program.
- Occupancy (column `waves` of `kernels.csv`: the share of the threads that a GPU holds at once) is that of one GPU, NAVI21 (RX 6800), as Mesa's compiler
  allots registers there; that GPU holds 16 waves of 32 threads on each SIMD. It stands for NVIDIA's and Intel's GPUs too, which have other register files
  and compilers. A variant that `tests/gpus` does not compile has an empty cell, and its occupancy is taken as full. The same holds for the kernels that
  the H100 ran.
- Latencies of AMD's and Intel's GPUs are estimates from measurements that others published; the vendors publish none.
)";

}  // namespace

Status writeGpuPage(const GpuModelRun& run, const std::string& folder, const std::string& command) {
    Result<DeviceTables> devices = run.gpus.empty() ? tablesIn(folder + "/gpus.md") : tablesOf(run);
    if (!devices) return devices.error();
    const std::vector<GpuSpec> gpus = publishedGpus();
    const ModelHere here = modelOf(*devices);
    std::string csv = "gpu,method,particles,substeps,iterations,simulate_ms,draw_ms\n";
    for (const GpuSpec& gpu : gpus)
        for (const double particles : kParticles)
            for (const char* method : kMethods) {
                const FrameWork work = measuredWork(method, particles);
                csv += fmt::format("{},{},{:.0f},{:.4g},{:.4g},{:.4g},{:.4g}\n", gpu.name, method, particles, work.substeps,
                                   work.iterations, predictSteps(gpu, method, particles, work).ms(), predictPicture(gpu, particles).ms());
            }
    if (Status written = writeFileAtomic(folder + "/gpus.csv", csv); !written) return written;
    const std::string page =
        fmt::format(
            "# GPUs: a cost model\n\nPredicted times of frames on GPUs: what the kernels and passes of a frame do, over what a GPU can "
            "do. Of the GPUs in the first table two were measured: an H100 that simulated, and an H200 that drew. Written by `{}`; "
            "[gpus.csv](gpus.csv) has the predictions. "
            "`rivulet bench gpu` measures your GPU beside them.\n\n",
            command) +
        predictions(gpus, here.errors) + dominating(gpus) + beforeAndAfter() + errorsHere(*devices, here) + errorsThere(gpus) + kModel +
        everyKernel(gpus);
    return writeFileAtomic(folder + "/gpus.md", page);
}

}  // namespace rivulet
