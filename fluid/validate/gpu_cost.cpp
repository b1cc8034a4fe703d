#include "fluid/validate/gpu_cost.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "engine/core/assert.h"
#include "fluid/session/reference_data.h"

namespace rivulet {

namespace {

// Issue slots of an operation of each kind on a GPU: a division or root is several instructions, a branch two, a read of the parameter
// block is an operand. A load is issued in one; what it moves counts as cache and memory.
constexpr std::array<double, kGpuOps> kSlots = {1, 8, 1, 2, 0, 1, 1, 1, 1, 1};
constexpr std::array<const char*, kGpuOps> kColumns = {"arithmetic", "special", "integers", "branches", "uniforms",
                                                       "loads",      "stores",  "atomics",  "shared",   "barriers"};
constexpr double kLaunch = 5.0e-6;  // s: Zhang et al. 2020, "A study of single and multi-device synchronization methods in Nvidia GPUs"

// What a kernel does in one dispatch, a thread, means.
struct KernelWork {
    std::string name;
    std::string_view per = "step";  // step | iteration | frame
    double calls = 0;               // in one of these
    double frameCalls = 0;          // in a frame, more
    double threads = 0;             // a dispatch
    std::array<double, kGpuOps> count{};
    double step8 = 1, step32 = 1, step64 = 1;  // operations in step over the mean
    double longest = 0, longestLoads = 0;      // operations and loads of the longest thread
    double sectors = 0, bytes = 0;             // 32 bytes each, of a warp's accesses; of memory
    double waves = 1;                          // share of a GPU's waves that registers allow
    double inStep(int step) const { return step <= 1 ? 1 : step <= 8 ? step8 : step <= 32 ? step32 : step64; }
};

// The line a + b x through points, by least squares; of two or more.
struct Line {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    void add(double px, double py) { ++n, x += px, y += py, xx += px * px, xy += px * py; }
    double at(double px) const {
        const double d = n * xx - x * x;
        if (n < 2 || std::abs(d) < 1.0e-12 * n * xx) return n > 0 ? y / n : 0;
        const double b = (n * xy - x * y) / d;
        return (y - b * x) / n + b * px;
    }
};

// Operations of a thread, of all kinds.
double sumOf(const ReferenceRows& table, const std::vector<std::string_view>& row) {
    double sum = 0;
    for (const char* column : kColumns) sum += numberIn(row[table.column(column)]);
    return sum;
}

// A kernel as it was counted, with the smallest number of particles first.
struct CountedSizes {
    const ReferenceRows& table;
    std::vector<const std::vector<std::string_view>*> rows;
    double number(size_t row, const char* column) const { return numberIn((*rows[row])[table.column(column)]); }
    const std::vector<std::string_view>& last() const { return *rows.back(); }
};

// What a dispatch does with `particles`. Of a kernel with a thread for each particle: by the particle, for the last group of threads is not
// full. What such a thread does depends on the share of particles at walls and surfaces, which is proportional to the inverse edge of the
// water, and counts are extended along it. Other dispatches are of a fixed number of threads, which share all particles or do something
// once, or of cells: what they do is a line over the number of particles.
KernelWork workOf(const std::string& name, const CountedSizes& sizes, double particles) {
    constexpr double kLargestGroup = 256;
    bool each = true, fixed = sizes.rows.size() > 1;  // of one size alone it is not known: then each dispatch grows with the particles
    for (size_t k = 0; k < sizes.rows.size(); ++k) {
        const double threads = sizes.number(k, "threads"), beyond = threads - sizes.number(k, "particles");
        each = each && beyond >= 0 && beyond < kLargestGroup;
        fixed = fixed && threads == sizes.number(0, "threads");
    }
    each = each && !fixed;
    const auto at = [&](const char* column, bool over) {  // over: the number of particles, not the inverse edge
        Line line;
        for (size_t k = 0; k < sizes.rows.size(); ++k) {
            const double count = sizes.number(k, "particles"), share = each ? sizes.number(k, "threads") / count : 1;
            line.add(over ? count : 1 / std::cbrt(count), sizes.number(k, column) * share);
        }
        return std::max(line.at(over ? particles : 1 / std::cbrt(std::max(particles, 1.0))), 0.0);
    };
    const auto cell = [&](const char* column) { return sizes.last()[sizes.table.column(column)]; };
    KernelWork w;
    w.name = name;
    w.per = cell("per");
    w.calls = numberIn(cell("calls"));
    w.frameCalls = numberIn(cell("frame_calls"));
    const double first = sizes.number(0, "threads");
    w.threads = each                    ? particles
                : fixed                 ? first
                : sizes.rows.size() > 1 ? at("threads", true)
                                        : first * particles / sizes.number(0, "particles");
    double operations = 0;
    for (size_t k = 0; k < kGpuOps; ++k) operations += w.count[k] = at(kColumns[k], fixed);
    // In step over alone: of the largest world counted, in which more threads are at walls than in larger ones.
    const double alone = sumOf(sizes.table, sizes.last());
    const auto ratio = [&](const char* column) { return alone > 0 ? std::max(numberIn(cell(column)) / alone, 1.0) : 1.0; };
    w.step8 = ratio("step8");
    w.step32 = ratio("step32");
    w.step64 = ratio("step64");
    const double grows = fixed && alone > 0 ? operations / alone : 1;
    for (size_t k = 0; k < sizes.rows.size(); ++k) {
        w.longest = std::max(w.longest, grows * sizes.number(k, "longest"));
        w.longestLoads = std::max(w.longestLoads, grows * sizes.number(k, "longest_loads"));
    }
    w.sectors = at("sectors", fixed);
    w.bytes = at("read_bytes", fixed) + at("written_bytes", fixed);
    w.waves = std::clamp(numberIn(cell("waves")), 0.0, 1.0);
    if (w.waves == 0) w.waves = 1;  // not known
    return w;
}

// The kernels of a step with `particles`.
std::vector<KernelWork> kernelsOf(std::string_view counts, std::string_view method, double particles) {
    const ReferenceRows table = rowsOf(gpuTables(), counts);
    std::map<std::string, CountedSizes, std::less<>> kernels;
    for (const std::vector<std::string_view>& row : table.rows)
        if (row[table.column("method")] == method)
            kernels.try_emplace(std::string(row[table.column("kernel")]), CountedSizes{table, {}}).first->second.rows.push_back(&row);
    std::vector<KernelWork> all;
    all.reserve(kernels.size());
    for (auto& [name, sizes] : kernels) {
        const size_t column = table.column("particles");
        std::ranges::sort(sizes.rows, {}, [column](const auto* row) { return numberIn((*row)[column]); });
        all.push_back(workOf(name, sizes, particles));
    }
    return all;
}

// One dispatch on one device.
struct DispatchCost {
    double seconds = 0, operations = 0, bytes = 0;
    const char* bound = "";
};
DispatchCost dispatchOf(const GpuSpec& gpu, const KernelWork& w) {
    const double inStep = w.inStep(gpu.step);
    double perThread = 0, operations = 0, slots = 0;
    for (size_t k = 0; k < kGpuOps; ++k) {
        const bool moves = GpuOp(k) >= GpuOp::load && GpuOp(k) <= GpuOp::shared;
        const double inTurn = moves ? 1 - gpu.loadsInStep : 0;  // the share that each thread takes for itself
        perThread += w.count[k] * gpu.seconds[k] * (inTurn + (1 - inTurn) * inStep);
        operations += w.count[k];
        slots += w.count[k] * kSlots[k];
    }
    const double loads = w.count[static_cast<size_t>(GpuOp::load)] + w.count[static_cast<size_t>(GpuOp::atomic)];
    const double wait = (slots * gpu.operationLatency + loads * gpu.loadLatency) * inStep;
    const double longest = operations > 0 ? w.longest * slots / operations : 0;  // slots: of the mix of all threads
    const struct {
        double seconds;
        const char* bound;
    } limits[] = {
        {w.threads * perThread, "operations"},
        {gpu.cache > 0 ? w.threads * w.sectors * 32 / gpu.cache : 0, "cache"},
        {w.threads * w.bytes / gpu.bandwidth, "memory"},
        {gpu.resident > 0 ? w.threads * wait / (gpu.resident * w.waves) : 0, "waits"},
        {longest * gpu.operationLatency + w.longestLoads * gpu.loadLatency, "longest thread"},
    };
    DispatchCost cost{.seconds = 0, .operations = w.threads * operations, .bytes = w.threads * w.bytes, .bound = "launches"};
    for (const auto& limit : limits)
        if (limit.seconds > cost.seconds) cost.seconds = limit.seconds, cost.bound = limit.bound;
    if (cost.seconds < gpu.launch) cost.bound = "launches";
    cost.seconds += gpu.launch;
    return cost;
}

FrameCost sorted(std::vector<PassCost> passes) {
    std::sort(passes.begin(), passes.end(), [](const PassCost& a, const PassCost& b) { return a.ms > b.ms; });
    return {std::move(passes)};
}

std::string lowerOf(std::string_view text) {
    std::string lower(text);
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return lower;
}

// Words after a model's number that make another model of it, with other units or clocks.
const std::set<std::string, std::less<>> kOtherModels = {"ti",     "super", "xt",    "xtx",  "xtxh",   "gre", "laptop",
                                                         "mobile", "max-q", "max-p", "d",    "m",      "s",   "le",
                                                         "v2",     "oem",   "nvl",   "pcie", "2048sp", "3gb", "notebook"};

// Whether a renderer's or device's name, as "AMD Radeon RX 6800 (radeonsi, navi21, ...)", has the words of `model` and no others that make
// another model of it, as "RX 6800 XT" and "RX 6800M" are. Trade marks, as of "Arc(tm)", do not count.
bool namesModel(std::string_view renderer, std::string_view model) {
    std::string name = lowerOf(renderer);
    for (const std::string_view mark : {"(r)", "(tm)"})
        for (size_t at = name.find(mark); at != std::string::npos; at = name.find(mark)) name.erase(at, mark.size());
    const std::string wanted = lowerOf(model);
    const size_t at = name.find(wanted);
    if (at == std::string::npos) return false;
    const auto inWord = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
    if (at > 0 && inWord(name[at - 1])) return false;
    std::string rest = name.substr(at + wanted.size());
    if (!rest.empty() && inWord(rest.front())) return false;  // RX 6800M
    for (const char* bus : {"/pcie", "/agp", "("}) rest.resize(std::min(rest.find(bus), rest.size()));
    std::replace_if(
        rest.begin(), rest.end(), [&](char c) { return !inWord(c) && c != '-'; }, ' ');
    std::istringstream words(rest);
    for (std::string word; words >> word;)
        if (kOtherModels.contains(word)) return false;
    return true;
}

}  // namespace

double FrameCost::ms() const {
    double sum = 0;
    for (const PassCost& p : passes) sum += p.ms;
    return sum;
}

std::vector<GpuSpec> publishedGpus() {
    const ReferenceRows table = rowsOf(gpuTables(), "gpus");
    std::vector<GpuSpec> all;
    all.reserve(table.rows.size());
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto number = [&](const char* column) { return numberIn(row[table.column(column)]); };
        GpuSpec g;
        g.name = row[table.column("name")];
        const double clock = number("clock_mhz") * 1.0e6, units = number("units"), lanes = units * number("lanes") * clock;
        g.step = static_cast<int>(number("step"));
        for (size_t k = 0; k < kGpuOps; ++k) g.seconds[k] = kSlots[k] / lanes;
        g.bandwidth = number("gb_s") * 1.0e9;
        g.cache = number("cache_bytes_clock") * units * clock;
        g.launch = kLaunch;
        g.operationLatency = number("operation_cycles") / clock;
        g.loadLatency = number("load_cycles") / clock;
        g.resident = number("threads") * units;
        g.pixels = number("rops") * clock;
        g.units = units;
        g.drawUnits = number("draw_units");
        g.texels = number("tmus") * clock * g.drawShare();
        all.push_back(std::move(g));
    }
    return all;
}

GpuSpec measuredGpu(const std::string& name, const DeviceRates& rates, int step) {
    GpuSpec g;
    g.name = name;
    g.step = step;
    const double arithmetic = 1 / rates.arithmetic, integer = 1 / rates.integer, load = 1 / rates.loads;
    // A round of a loop is one addition of integers, one comparison and one branch.
    const double branch = std::max(1 / rates.rounds - 2 * integer, integer);
    g.seconds = {arithmetic, 1 / rates.special, integer, branch, integer, load, load, load, load, load};
    g.bandwidth = rates.bandwidth;
    g.launch = rates.dispatchMs / 1000;
    g.loadsInStep = rates.loadsInStep;
    if (rates.fragments > 0) {
        g.fragmentSeconds = 1 / rates.fragments;
        g.filteredSeconds = 1 / rates.filtered;
        g.fetchSeconds = 1 / rates.fetches;
    }
    return g;
}

NearestGpu nearestGpu(std::string_view name, double bandwidth) {
    const std::vector<GpuSpec> all = publishedGpus();
    const GpuSpec* found = nullptr;
    for (const GpuSpec& g : all)  // the longest name that is part of it
        if (namesModel(name, g.name) && (found == nullptr || g.name.size() > found->name.size())) found = &g;
    if (found != nullptr) return {*found, true};
    for (const GpuSpec& g : all)
        if (found == nullptr || std::abs(std::log(g.bandwidth / bandwidth)) < std::abs(std::log(found->bandwidth / bandwidth))) found = &g;
    ASSERT(found != nullptr, "gpus.csv has rows");
    return {*found, false};
}

FrameWork measuredWork(std::string_view method, double particles) {
    const ReferenceRows table = rowsOf(gpuTables(), "frames");
    FrameWork work;
    double nearest = 1.0e30, at = particles;
    for (const std::vector<std::string_view>& row : table.rows) {
        if (row[table.column("method")] != method) continue;
        const double count = numberIn(row[table.column("particles")]), far = std::abs(std::log(count / particles));
        if (far >= nearest) continue;
        nearest = far;
        at = count;
        work = {numberIn(row[table.column("substeps")]), numberIn(row[table.column("iterations")])};
    }
    // Steps are as long as particles are wide.
    work.substeps = std::max(work.substeps * std::cbrt(particles / at), 1.0);
    return work;
}

FrameCost predictSteps(const GpuSpec& gpu, std::string_view method, double particles, const FrameWork& work, std::string_view counts) {
    std::vector<PassCost> passes;
    for (const KernelWork& w : kernelsOf(counts, method, particles)) {
        const double dispatches =
            w.calls * (w.per == "frame" ? 1 : work.substeps) * (w.per == "iteration" ? work.iterations : 1) + w.frameCalls;
        const DispatchCost one = dispatchOf(gpu, w);
        passes.push_back(
            {w.name, 1000 * one.seconds * dispatches, dispatches, one.bound, one.operations * dispatches, one.bytes * dispatches});
    }
    return sorted(std::move(passes));
}

FrameCost predictPicture(const GpuSpec& gpu, double particles) {
    const ReferenceRows table = rowsOf(gpuTables(), "passes");
    double at = 0;
    for (const std::vector<std::string_view>& row : table.rows) {
        const double count = numberIn(row[table.column("particles")]);
        if (at == 0 || std::abs(std::log(count / particles)) < std::abs(std::log(at / particles))) at = count;
    }
    std::vector<PassCost> passes;
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto number = [&](const char* column) { return numberIn(row[table.column(column)]); };
        if (number("particles") != at) continue;
        const double vertices = number("vertices") * particles / at, fragments = number("fragments");
        double operations = 0, computing = 0;  // computing: s
        for (const auto& [of, kind] : {std::pair("operations", GpuOp::arithmetic), std::pair("special", GpuOp::special)}) {
            const double each = fragments * number(of) + vertices * number(("vertex_" + std::string(of)).c_str());
            operations += each;
            computing += each * gpu.seconds[static_cast<size_t>(kind)] / gpu.drawShare();
        }
        const double fetches = fragments * number("fetches") + vertices * number("vertex_fetches");
        const double reads = fragments * number("reads") + vertices * number("vertex_reads");  // fetches among them
        const double inTurn = fragments * gpu.fragmentSeconds + (reads - fetches) * gpu.filteredSeconds + fetches * gpu.fetchSeconds;
        const double bytes = number("read_bytes") + number("written_bytes");
        const double cached = gpu.cache > 0 ? number("read_bytes") / (gpu.cache * gpu.drawShare()) : 0;
        const struct {
            double seconds;
            const char* bound;
        } limits[] = {
            {computing + inTurn, "operations"},
            {std::max(gpu.texels > 0 ? reads / gpu.texels : 0, cached), "cache"},
            {bytes / gpu.bandwidth, "memory"},
            {gpu.pixels > 0 ? fragments / gpu.pixels : 0, "pixels"},
        };
        PassCost pass{std::string(row[table.column("pass")]), 0, number("passes"), "launches", operations, bytes};
        double seconds = 0;
        for (const auto& limit : limits)
            if (limit.seconds > seconds) seconds = limit.seconds, pass.bound = limit.bound;
        if (seconds < gpu.launch * pass.dispatches) pass.bound = "launches";
        pass.ms = 1000 * (seconds + gpu.launch * pass.dispatches);
        passes.push_back(std::move(pass));
    }
    return sorted(std::move(passes));
}

double CountedKernel::operations() const { return std::accumulate(count.begin(), count.end(), 0.0); }

std::vector<CountedKernel> countedKernels() {
    const ReferenceRows table = rowsOf(gpuTables(), "kernels_small");
    std::vector<CountedKernel> all;
    all.reserve(table.rows.size());
    for (const std::vector<std::string_view>& row : table.rows) {
        const auto number = [&](const char* column) { return numberIn(row[table.column(column)]); };
        CountedKernel k;
        k.name = row[table.column("kernel")];
        k.variant = row[table.column("variants")];
        k.plain = number("plain") > 0;
        k.threads = number("threads");
        k.groups = number("groups");
        for (size_t of = 0; of < kGpuOps; ++of) k.count[of] = number(kColumns[of]);
        k.step32 = number("step32");
        k.bytes = number("read_bytes") + number("written_bytes");
        k.longest = number("longest");
        k.longestLoads = number("longest_loads");
        k.sectors = number("sectors");
        k.waves = number("waves") > 0 ? number("waves") : 1;
        all.push_back(std::move(k));
    }
    return all;
}

double predictDispatch(const GpuSpec& gpu, const CountedKernel& kernel) {
    KernelWork w;
    w.name = kernel.name;
    w.threads = kernel.threads;
    w.count = kernel.count;
    w.step8 = w.step32 = w.step64 = kernel.operations() > 0 ? std::max(kernel.step32 / kernel.operations(), 1.0) : 1.0;
    w.longest = kernel.longest;
    w.longestLoads = kernel.longestLoads;
    w.sectors = kernel.sectors;
    w.bytes = kernel.bytes;
    w.waves = kernel.waves;
    return 1000 * dispatchOf(gpu, w).seconds;
}

}  // namespace rivulet
