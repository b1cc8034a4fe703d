// The cost model of GPUs: its tables name real kernels, and its predictions follow from what a device can do.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "fluid/session/reference_data.h"
#include "fluid/validate/gpu_cost.h"
#include "fluid/validate/gpu_series.h"

namespace rivulet::gpu_cost_test {
namespace {

double frameMs(const GpuSpec& gpu, const char* method, double particles) {
    return predictSteps(gpu, method, particles, measuredWork(method, particles)).ms();
}

TEST(GpuCost, TablesNameKernelsThatExist) {
    const ReferenceRows table = rowsOf(gpuTables(), "kernels");
    std::set<std::string_view> methods;
    for (const auto& row : table.rows) {
        ASSERT_EQ(row.size(), table.columns.size());
        methods.insert(row[table.column("method")]);
        EXPECT_TRUE(std::filesystem::exists(RIVULET_SOURCE_DIR "/shaders/" + std::string(row[table.column("kernel")]) + ".kernel"))
            << row[table.column("kernel")];
        // A dispatch touches no more sectors than its accesses have bytes, rounded up to whole sectors.
        EXPECT_LE(numberIn(row[table.column("read_bytes")]),
                  32 * (numberIn(row[table.column("loads")]) + numberIn(row[table.column("atomics")])) + 64);
    }
    EXPECT_EQ(methods, (std::set<std::string_view>{"wcsph", "pbf", "dfsph"}));
}

// Counts are rounded to four digits.
constexpr double kRounded = 1.002;

// What holds for any code. Threads in step have no fewer operations than alone, and wider groups no fewer than narrower ones. They have no
// more than one after the other, and those of code without a branch, which all go through together, have those of one thread. The mean is
// none of more than the longest thread.
void expectPossible(const ReferenceRows& table, const std::vector<std::string_view>& row, const std::string& what) {
    const auto number = [&](const char* column) { return numberIn(row[table.column(column)]); };
    double operations = 0;
    for (const char* kind :
         {"arithmetic", "special", "integers", "branches", "uniforms", "loads", "stores", "atomics", "shared", "barriers"})
        operations += number(kind);
    EXPECT_GE(number("longest") * kRounded, operations) << what;
    EXPECT_GE(number("longest"), number("longest_loads")) << what;
    double narrower = operations;
    for (const auto& [column, width] : {std::pair("step8", 8.0), std::pair("step32", 32.0), std::pair("step64", 64.0)}) {
        EXPECT_GE(number(column) * kRounded, narrower) << what << ", " << column;
        EXPECT_LE(number(column), width * operations * kRounded) << what << ", " << column;
        if (number("branches") == 0) EXPECT_LE(number(column), operations * kRounded) << what << ", " << column;
        narrower = number(column);
    }
}

TEST(GpuCost, StepsAreThoseThatThreadsCanTake) {
    size_t rows = 0;
    for (const char* name : {"kernels", "kernels_small"}) {
        const ReferenceRows table = rowsOf(gpuTables(), name);
        for (const auto& row : table.rows) {
            expectPossible(table, row,
                           fmt::format("{}: {} {}, {}", name, row[table.column("kernel")], row[table.column("variants")], row[0]));
            ++rows;
        }
    }
    EXPECT_GT(rows, 300U);
}

// The share of waves that registers allow is known where tests/gpus has the variant.
TEST(GpuCost, WavesAreAShareOrNotKnown) {
    std::map<std::string, size_t> known, empty;
    for (const char* name : {"kernels", "kernels_before", "kernels_small"}) {
        const ReferenceRows table = rowsOf(gpuTables(), name);
        for (const auto& row : table.rows) {
            const std::string_view cell = row[table.column("waves")];
            ++(cell.empty() ? empty : known)[name];
            if (cell.empty()) continue;
            EXPECT_GT(numberIn(cell), 0) << name << ": " << row[table.column("kernel")];
            EXPECT_LE(numberIn(cell), 1) << name << ": " << row[table.column("kernel")];
        }
    }
    EXPECT_EQ(empty["kernels"], 0U);
    EXPECT_GT(empty["kernels_small"], 0U);
    EXPECT_GT(known["kernels_small"], 3 * empty["kernels_small"]);
    for (const CountedKernel& k : countedKernels()) EXPECT_GT(k.waves, 0) << k.name;  // the model takes 1 then
}

// Waves that registers allow on NAVI21, of the 16 that a SIMD of it holds: the least of the variants that were counted.
TEST(GpuCost, WavesAreThoseOfTheTableOfCompilers) {
    std::map<std::string, double> shares;  // of "flow/push FILM=1"
    std::ifstream file(RIVULET_SOURCE_DIR "/tests/gpus/table.csv");
    for (std::string line; std::getline(file, line);) {
        std::vector<std::string> cells;
        std::istringstream words(line);
        for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
        if (cells.size() < 10 || cells[2] != "compute" || cells[4] != "NAVI21") continue;
        std::set<std::string> defines;
        std::istringstream of(cells[1]);
        for (std::string define; std::getline(of, define, ';');)
            if (!define.starts_with("LOCAL_SIZE=")) defines.insert(define);
        const std::string variant = defines.empty() ? "-" : fmt::format("{}", fmt::join(defines, ";"));
        EXPECT_EQ(cells[9], "32");
        shares[cells[0] + " " + variant] = std::min(std::strtod(cells[8].c_str(), nullptr) / 16, 1.0);
    }
    size_t known = 0;
    for (const char* name : {"kernels", "kernels_small"}) {
        const ReferenceRows table = rowsOf(gpuTables(), name);
        for (const auto& row : table.rows) {
            double least = 2;
            std::istringstream variants{std::string(row[table.column("variants")])};
            for (std::string variant; variants >> variant;)
                if (const auto found = shares.find(std::string(row[table.column("kernel")]) + " " + variant); found != shares.end())
                    least = std::min(least, found->second);
            if (least > 1) continue;
            EXPECT_NEAR(numberIn(row[table.column("waves")]), least, 1.0e-3)
                << row[table.column("kernel")] << ": python3 tests/gpu_cost/count.py waves";
            ++known;
        }
    }
    EXPECT_GT(known, 200U);
}

// Extrapolated from worlds of some thousand particles: of a million, each has one thread in kernels of particles, and no dispatch is empty.
TEST(GpuCost, AMillionParticlesHaveAMillionThreads) {
    GpuSpec gpu = publishedGpus().front();
    for (const char* method : {"wcsph", "pbf", "dfsph"}) {
        const FrameWork once{.substeps = 1, .iterations = 1};
        const FrameCost few = predictSteps(gpu, method, 1.0e6, once), many = predictSteps(gpu, method, 4.0e6, once);
        ASSERT_EQ(few.passes.size(), many.passes.size());
        for (const PassCost& pass : few.passes) {
            EXPECT_GT(pass.operations, 0) << pass.name;
            // It has no loop, and one branch, for threads beyond the last particle: 18 operations of each other thread.
            if (pass.name == "fluid/grid/reorder") EXPECT_NEAR(pass.operations / pass.dispatches, 18.0e6, 0.1e6);
            for (const PassCost& more : many.passes)  // a group that shares all particles has four times as much to do
                if (more.name == pass.name && (pass.name == "fluid/world/stats" || pass.name == "fluid/methods/residual"))
                    EXPECT_NEAR(more.operations / pass.operations, 4, 0.05) << pass.name;
        }
    }
}

TEST(GpuCost, HalfOfTheBandwidthDoublesWhatIsLimitedByMemory) {
    GpuSpec gpu = publishedGpus().front();
    for (double& s : gpu.seconds) s = 0;
    gpu.cache = gpu.launch = gpu.operationLatency = gpu.loadLatency = 0;
    const double whole = frameMs(gpu, "pbf", 1.0e6);
    EXPECT_GT(whole, 0);
    gpu.bandwidth /= 2;
    EXPECT_NEAR(frameMs(gpu, "pbf", 1.0e6) / whole, 2, 1.0e-9);
}

TEST(GpuCost, ADispatchTakesAtLeastItsLaunchAndItsLongestThread) {
    GpuSpec gpu = publishedGpus().front();
    for (double& s : gpu.seconds) s = 0;
    gpu.cache = gpu.resident = gpu.loadLatency = gpu.operationLatency = 0;
    gpu.bandwidth = 1.0e30;
    gpu.launch = 1.0e-5;
    const FrameCost launches = predictSteps(gpu, "wcsph", 1000, {.substeps = 10, .iterations = 0});
    for (const PassCost& pass : launches.passes) EXPECT_NEAR(pass.ms, 0.01 * pass.dispatches, 1.0e-9) << pass.name;
    gpu.operationLatency = 1.0e-9;  // a few particles do not fill a GPU: a sweep over neighbours takes as long for ten times as many
    const auto sweepMs = [&](double particles) {
        for (const PassCost& pass : predictSteps(gpu, "wcsph", particles, {.substeps = 10, .iterations = 0}).passes)
            if (pass.name == "fluid/methods/wcsph_density") return pass.ms;
        return 0.0;
    };
    EXPECT_GT(sweepMs(1.0e4), 0.1);
    EXPECT_NEAR(sweepMs(1.0e4) / sweepMs(1.0e5), 1, 0.1);  // the mix of its operations changes a little
}

TEST(GpuCost, FasterGpusAreFasterAndMoreParticlesCostMore) {
    const std::vector<GpuSpec> all = publishedGpus();
    ASSERT_GE(all.size(), 10U);
    EXPECT_EQ(all.front().name, "GTX 1060");
    EXPECT_EQ(all.back().name, "H200");
    for (const char* method : {"wcsph", "pbf", "dfsph"}) {
        for (const GpuSpec& gpu : all) EXPECT_LT(frameMs(gpu, method, 1.0e5), frameMs(gpu, method, 1.0e6)) << gpu.name << method;
        EXPECT_GT(frameMs(all.front(), method, 1.0e6), 3 * frameMs(all.back(), method, 1.0e6)) << method;
    }
    EXPECT_GT(predictPicture(all.front(), 1.0e6).ms(), predictPicture(all.front(), 1.0e5).ms());
}

// Where each thread loads for itself, as in llvmpipe, threads in lockstep wait for no load of others.
TEST(GpuCost, LoadsInTurnTakeNoLongerInStep) {
    GpuSpec gpu;
    gpu.bandwidth = 1.0e30;
    gpu.seconds[static_cast<size_t>(GpuOp::load)] = 1.0e-9;
    gpu.step = 1;
    const double alone = frameMs(gpu, "pbf", 1.0e5);
    gpu.step = 8;
    const double inStep = frameMs(gpu, "pbf", 1.0e5);
    EXPECT_GT(inStep, 1.3 * alone);
    gpu.loadsInStep = 0;
    EXPECT_NEAR(frameMs(gpu, "pbf", 1.0e5), alone, 1.0e-9 * alone);
    gpu.loadsInStep = 0.25;
    EXPECT_NEAR(frameMs(gpu, "pbf", 1.0e5), 0.75 * alone + 0.25 * inStep, 1.0e-9 * alone);
    // Operations that are no accesses are in step.
    gpu.seconds = {};
    gpu.seconds[static_cast<size_t>(GpuOp::arithmetic)] = 1.0e-9;
    const double computing = frameMs(gpu, "pbf", 1.0e5);
    gpu.loadsInStep = 1;
    EXPECT_EQ(frameMs(gpu, "pbf", 1.0e5), computing);
}

// What draws is a part of the GPU: it has that part of the operations, texels and first caches.
TEST(GpuCost, AGpuDrawsWithTheUnitsThatCan) {
    for (const GpuSpec& gpu : publishedGpus()) {
        const bool few = gpu.name == "H100 80GB" || gpu.name == "H200";
        EXPECT_EQ(gpu.drawUnits, few ? 4 : gpu.units) << gpu.name;
        if (gpu.name == "H200") EXPECT_DOUBLE_EQ(gpu.texels, 16 * 1980.0e6);
    }
    GpuSpec gpu = publishedGpus().front();
    gpu.launch = 0;
    gpu.pixels = gpu.texels = gpu.cache = 0;
    gpu.bandwidth = 1.0e30;
    const double computing = predictPicture(gpu, 1.0e5).ms(), steps = frameMs(gpu, "pbf", 1.0e5);
    gpu.drawUnits = 0.25 * gpu.units;
    EXPECT_NEAR(predictPicture(gpu, 1.0e5).ms() / computing, 4, 1.0e-6);
    EXPECT_EQ(frameMs(gpu, "pbf", 1.0e5), steps);
    for (double& s : gpu.seconds) s = 0;
    gpu.cache = 1.0e9;
    const double reading = predictPicture(gpu, 1.0e5).ms();
    EXPECT_GT(reading, 100);
    gpu.drawUnits = 0.125 * gpu.units;
    EXPECT_NEAR(predictPicture(gpu, 1.0e5).ms() / reading, 2, 1.0e-6);
}

// A device that is software writes fragments and reads textures one after the other: what each takes adds up.
TEST(GpuCost, APictureInSoftwareTakesItsFragmentsAndItsReads) {
    GpuSpec none;
    none.bandwidth = 1.0e30;
    EXPECT_LT(predictPicture(none, 8192).ms(), 1.0e-12);  // of memory
    const auto with = [&](double fragment, double filtered, double fetched) {
        GpuSpec g = none;
        g.fragmentSeconds = fragment;
        g.filteredSeconds = filtered;
        g.fetchSeconds = fetched;
        return predictPicture(g, 8192).ms();
    };
    const double fragments = with(1.0e-9, 0, 0), filtered = with(0, 1.0e-9, 0), fetched = with(0, 0, 1.0e-9);
    EXPECT_GT(fragments, 1920 * 1080 * 1.0e-6);  // more than the picture has pixels
    EXPECT_GT(filtered, 0);
    EXPECT_GT(fetched, 0);
    EXPECT_NEAR(with(2.0e-9, 1.0e-9, 3.0e-9), 2 * fragments + filtered + 3 * fetched, 1.0e-9 * fragments);
}

TEST(GpuCost, AGpuIsFoundByItsNameOrItsBandwidth) {
    const auto named = [](const char* renderer) {
        const NearestGpu nearest = nearestGpu(renderer, 448.0e9);  // of an RTX 3060 Ti
        return nearest.byName ? nearest.gpu.name : "none";
    };
    EXPECT_EQ(named("NVIDIA GeForce RTX 3060/PCIe/SSE2"), "RTX 3060");
    EXPECT_EQ(named("NVIDIA GeForce GTX 1060 6GB/PCIe/SSE2"), "GTX 1060");
    EXPECT_EQ(named("AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6, DRM 3.49, 6.1.0)"), "RX 6800");
    EXPECT_EQ(named("AMD Radeon RX 580 Series (polaris10, LLVM 15.0.6, DRM 3.49, 6.1.0)"), "RX 580");
    EXPECT_EQ(named("AMD Radeon RX 7900 XTX (radeonsi, navi31, LLVM 15.0.7, DRM 3.54, 6.5.0)"), "RX 7900 XTX");
    EXPECT_EQ(named("Mesa Intel(R) Arc(tm) A770 Graphics (DG2)"), "Arc A770");
    EXPECT_EQ(named("NVIDIA H100 80GB HBM3"), "H100 80GB");
    // A suffix makes another GPU of it.
    for (const char* other :
         {"NVIDIA GeForce RTX 3060 Ti/PCIe/SSE2", "NVIDIA GeForce RTX 4070 Ti SUPER/PCIe/SSE2", "NVIDIA GeForce RTX 4070 SUPER",
          "NVIDIA GeForce RTX 3060 Laptop GPU/PCIe/SSE2", "NVIDIA GeForce GTX 1060 with Max-Q Design/PCIe/SSE2",
          "NVIDIA GeForce GTX 1060 3GB/PCIe/SSE2", "NVIDIA GeForce RTX 4090 D", "AMD Radeon RX 7900 XT (radeonsi, navi31, LLVM 15.0.7)",
          "AMD Radeon RX 6800 XT (radeonsi, navi21, LLVM 15.0.6, DRM 3.49, 6.1.0)", "AMD Radeon RX 6800M (navi22, LLVM 15.0.6)",
          "AMD Radeon RX 6800/6800 XT / 6900 XT (navi21, LLVM 13.0.1)", "Mesa Intel(R) Arc(tm) A770M Graphics (DG2)", "NVIDIA H200 NVL"})
        EXPECT_EQ(named(other), "none") << other;
    EXPECT_EQ(nearestGpu("NVIDIA GeForce RTX 3060 Ti/PCIe/SSE2", 365.0e9).gpu.name, "RTX 3060") << "by its bandwidth";
    const NearestGpu unknown = nearestGpu("some other GPU", 190.0e9);
    EXPECT_FALSE(unknown.byName);
    EXPECT_EQ(unknown.gpu.name, "GTX 1060");
}

TEST(GpuCost, EveryKernelIsCounted) {
    std::set<std::string> counted;
    for (const char* name : {"kernels", "kernels_small"}) {
        const ReferenceRows table = rowsOf(gpuTables(), name);
        for (const auto& row : table.rows) counted.emplace(row[table.column("kernel")]);
    }
    std::set<std::string> notCounted;
    const ReferenceRows reasons = rowsOf(gpuTables(), "not_counted");
    for (const auto& row : reasons.rows) {
        notCounted.emplace(row[reasons.column("kernel")]);
        EXPECT_FALSE(row[reasons.column("reason")].empty()) << row[0];
    }
    const std::filesystem::path shaders = RIVULET_SOURCE_DIR "/shaders";
    std::set<std::string> all;
    for (const auto& file : std::filesystem::recursive_directory_iterator(shaders))
        if (file.path().extension() == ".kernel")
            all.insert(std::filesystem::relative(file.path(), shaders).replace_extension().generic_string());
    EXPECT_GT(all.size(), 140U);
    for (const std::string& kernel : all)
        EXPECT_NE(counted.contains(kernel), notCounted.contains(kernel))
            << kernel << " is in no table (python3 tests/gpu_cost/count.py small), or need no longer be in not_counted.csv";
    for (const std::set<std::string>& listed : {counted, notCounted})
        for (const std::string& kernel : listed) EXPECT_TRUE(all.contains(kernel)) << kernel << " is no kernel any more";
}

TEST(GpuCost, ADispatchOfOneGroupTakesItsLongestThread) {
    const std::vector<GpuSpec> all = publishedGpus();
    size_t single = 0;
    for (const CountedKernel& k : countedKernels()) {
        EXPECT_GT(k.threads, 0) << k.name;
        EXPECT_GE(k.threads, k.groups) << k.name;
        for (const GpuSpec& gpu : all) {
            const double ms = predictDispatch(gpu, k);
            EXPECT_GE(ms, 1000 * (gpu.launch + k.longest * gpu.operationLatency)) << k.name;
            EXPECT_LT(ms, 100) << k.name;
        }
        if (k.name == "fluid/solids/advance_touching") {
            EXPECT_EQ(k.groups, 1);
            ++single;
        }
    }
    EXPECT_GT(single, 0U);
}

// The cells of the tables of a page below a heading, up to the next heading.
std::vector<std::vector<std::string>> cellsUnder(const std::string& heading) {
    std::ifstream page(RIVULET_SOURCE_DIR "/docs/gpus.md");
    std::vector<std::vector<std::string>> rows;
    bool under = false;
    for (std::string line; std::getline(page, line);) {
        if (line.starts_with("## ")) under = line == "## " + heading;
        if (!under || !line.starts_with("| ")) continue;
        std::vector<std::string> cells;
        for (size_t at = 1, end = 0; (end = line.find('|', at)) != std::string::npos; at = end + 1) {
            const std::string cell = line.substr(at, end - at);
            const size_t first = cell.find_first_not_of(' ');
            cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
        }
        rows.push_back(std::move(cells));
    }
    return rows;
}
double numberOf(const std::string& cell) { return std::strtod(cell.c_str(), nullptr); }
// Of rows that end with measured, predicted and error: the error is the one over the other, as both are rounded. Returns it, %.
double errorOf(const std::vector<std::string>& row) {
    const double measured = numberOf(row[row.size() - 3]), predicted = numberOf(row[row.size() - 2]), error = numberOf(row.back());
    EXPECT_NEAR(error, 100 * (predicted / measured - 1), 0.51 + predicted / measured) << row[0] << " " << row[1] << " " << row[2];
    return error;
}

// The device of a backend, by the rates on the page.
GpuSpec deviceHere(const std::string& backend) {
    for (const auto& row : cellsUnder("Error on the devices here"))
        if (row.size() == 12 && row[0].ends_with("(" + backend + ")")) {
            const auto giga = [&](size_t column) { return 1.0e9 * numberOf(row[column]); };
            DeviceRates rates{giga(1), giga(2), giga(3), giga(4), giga(5)};
            rates.rounds = giga(6);
            rates.dispatchMs = numberOf(row[7]) / 1000;
            rates.fragments = giga(8);
            rates.filtered = giga(9);
            rates.fetches = giga(10);
            rates.loadsInStep = numberOf(row[11]);
            EXPECT_GE(rates.loadsInStep, 0);
            EXPECT_LE(rates.loadsInStep, 1);
            return measuredGpu(row[0], rates, threadsInStep(backend));
        }
    ADD_FAILURE() << "no rates of " << backend;
    return {};
}

// The prediction is what the model says now, of the rates and measured steps on the page: bench gpu_model --quick writes it anew. The steps
// of wcsph calibrate: those of the other methods, by another solver with other kernels, show the error.
TEST(GpuCostPage, ErrorsAreThoseOfTheModelAndBelowThirtyPercentWhereItIsCalibrated) {
    std::map<std::string, FrameCost> costs;  // of a device and method: of a substep, or picture
    std::map<std::string, double> reached;   // of a device
    for (const auto& row : cellsUnder("Error on the devices here"))
        if (row.size() == 10 && row[1] == "wcsph") reached[row[0]] = numberOf(row[6]) / numberOf(row[5]);
    size_t results = 0, passes = 0;
    for (const auto& row : cellsUnder("Error on the devices here")) {
        const bool result = row.size() == 10, pass = row.size() == 6;
        if ((!result || numberOf(row[2]) == 0) && (!pass || row.back().find('%') == std::string::npos)) continue;
        const std::string of = row[0] + " " + row[1];
        const size_t last = result ? 7 : 5;
        errorOf({row.begin(), row.begin() + static_cast<ptrdiff_t>(last) + 1});
        const double predicted = numberOf(row[last - 1]);
        double model = 0;
        if (result) {  // the results come before their passes
            const double substeps = row[1] == "picture" ? 1 : numberOf(row[3]);
            ASSERT_GE(substeps, 1) << of;
            const GpuSpec gpu = deviceHere(row[0]);
            FrameCost& cost = costs[of];
            cost = row[1] == "picture" ? predictPicture(gpu, numberOf(row[2]))
                                       : predictSteps(gpu, row[1], numberOf(row[2]), {substeps, numberOf(row[4])});
            for (PassCost& each : cost.passes) each.ms /= substeps;
            model = cost.ms();
            const double measured = numberOf(row[5]);
            const bool calibrated = row[1] == "pbf" || row[1] == "dfsph";
            EXPECT_EQ(row[8].empty(), !calibrated) << of;
            if (calibrated) {
                ASSERT_TRUE(reached.contains(row[0])) << of;
                EXPECT_NEAR(numberOf(row[8]), predicted / reached[row[0]], 0.02 * measured) << of;
                EXPECT_NEAR(numberOf(row[9]), 100 * (numberOf(row[8]) / measured - 1), 1.5) << of;
                EXPECT_LT(std::abs(numberOf(row[8]) / measured - 1), 0.3) << of;
            }
            if (row[1] == "picture") EXPECT_LT(std::abs(predicted / measured - 1), 0.3) << of;
            ++results;
        } else {
            for (const PassCost& each : costs[of].passes)
                if (each.name == row[2]) model = each.ms;
            ++passes;
        }
        EXPECT_NEAR(predicted, model, 0.01 * model) << of << " " << row[2];
    }
    EXPECT_EQ(results, 7U);
    EXPECT_GT(passes, 20U);
}

TEST(GpuCostPage, ItsSentencesCarryTheErrorAgainstAGpu) {
    double least = 1.0e9, most = -1.0e9;
    std::string predicted, measured;  // of whole pictures
    for (const auto& row : cellsUnder("Against a GPU")) {
        if (row.back().find('%') == std::string::npos) continue;
        const double error = errorOf(row);
        if (row.size() == 7) {
            least = std::min(least, error);
            most = std::max(most, error);
        } else if (row[2] == "picture") {
            measured += (measured.empty() ? "" : " and ") + row[3];
            predicted += (predicted.empty() ? "" : " and ") + row[4];
        }
    }
    EXPECT_LT(least, most);
    EXPECT_FALSE(measured.empty());
    double leastHere = 1.0e9, mostHere = -1.0e9;  // simulated frames, not calibrated
    for (const auto& row : cellsUnder("Error on the devices here"))
        if (row.size() == 10 && numberOf(row[3]) > 0) {
            leastHere = std::min(leastHere, numberOf(row[7]));
            mostHere = std::max(mostHere, numberOf(row[7]));
        }
    EXPECT_LT(leastHere, mostHere);
    std::ifstream page(RIVULET_SOURCE_DIR "/docs/gpus.md");
    size_t sentences = 0;
    for (std::string line; std::getline(page, line);)
        if (line.starts_with("RTX 3060: a frame of a million") || line.starts_with("RX 6800: a frame of a million")) {
            EXPECT_NE(line.find(fmt::format("off by {:+.0f} % to {:+.0f} %", least, most)), std::string::npos) << line;
            EXPECT_NE(line.find(fmt::format("is off by {:+.0f} % to {:+.0f} %: see", leastHere, mostHere)), std::string::npos) << line;
            EXPECT_NE(line.find(fmt::format("pictures predicted to take {} ms took {} ms", predicted, measured)), std::string::npos)
                << line;
            ++sentences;
        }
    EXPECT_EQ(sentences, 2U);
}

// Predictions are written anew when a table changes: rivulet bench gpu_model --quick --out docs.
TEST(GpuCostPage, ItsPredictionsAreThoseOfTheTables) {
    std::ifstream file(RIVULET_SOURCE_DIR "/docs/gpus.csv");
    const std::vector<GpuSpec> gpus = publishedGpus();
    size_t rows = 0;
    for (std::string line; std::getline(file, line);) {
        std::vector<std::string> cells;
        std::istringstream words(line);
        for (std::string cell; std::getline(words, cell, ',');) cells.push_back(cell);
        ASSERT_EQ(cells.size(), 7U) << line;
        const auto gpu = std::find_if(gpus.begin(), gpus.end(), [&](const GpuSpec& g) { return g.name == cells[0]; });
        if (gpu == gpus.end()) continue;
        const double particles = numberOf(cells[2]), steps = frameMs(*gpu, cells[1].c_str(), particles);
        EXPECT_NEAR(numberOf(cells[5]), steps, 1.0e-3 * steps) << line;
        EXPECT_NEAR(numberOf(cells[6]), predictPicture(*gpu, particles).ms(), 1.0e-3 * predictPicture(*gpu, particles).ms()) << line;
        ++rows;
    }
    EXPECT_EQ(rows, gpus.size() * 6);
}

}  // namespace
}  // namespace rivulet::gpu_cost_test
