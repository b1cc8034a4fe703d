// A cost model of a frame on a GPU: what the kernels and the drawing passes do, counted (assets/gpus/kernels.csv, passes.csv; see
// tests/gpu_cost), over what a device can do. docs/gpus.md explains it, and says how far its predictions are from measurements.
//
// A dispatch takes the time of a launch, and the longest of five: operations, accesses of the first cache, memory, the waits of all threads
// that the GPU holds at once (kernels.csv has the share of waves that registers allow), and the longest thread. A roofline (Williams et al.
// 2009) with two floors for waits that nothing hides.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "fluid/validate/gpu_rates.h"

namespace rivulet {

// Kinds of operations, in the order of the columns of kernels.csv.
enum class GpuOp { arithmetic, special, integer, branch, uniform, load, store, atomic, shared, barrier };
constexpr size_t kGpuOps = 10;

// A device of the model.
struct GpuSpec {
    std::string name;
    int step = 32;                          // threads in lockstep: 1, 8, 32 or 64
    std::array<double, kGpuOps> seconds{};  // of an operation of one thread, if the whole device is busy
    double loadsInStep = 1;                 // share of the time of a load or store for which threads of the group that skip it wait too
    double bandwidth = 0;                   // bytes/s, memory
    double cache = 0;                       // bytes/s, the first cache, in sectors of 32 bytes; 0: not a limit
    double launch = 0;                      // s, a dispatch
    double operationLatency = 0;            // s, from an operation to one that needs its result; 0: the longest thread is no limit
    double loadLatency = 0;                 // s, the first cache
    double resident = 0;                    // threads that it holds at full occupancy
    double units = 1, drawUnits = 1;        // SM, CU or Xe core; those of them that can run drawing shaders
    double pixels = 0;                      // fragments/s that it can write; 0: not a limit
    double texels = 0;                      // texture reads/s of the units that draw; 0: not a limit
    double drawShare() const { return drawUnits / units; }
    // Of a device that is software, which does all of this one after the other, s: a fragment that is written, a filtered read of a
    // texture, a texel that is fetched. 0: not counted.
    double fragmentSeconds = 0, filteredSeconds = 0, fetchSeconds = 0;
};

// Devices with published figures: assets/gpus/gpus.csv.
std::vector<GpuSpec> publishedGpus();
// A device by its measured rates. `step`: as above; a GPU: its published figures with the measured bandwidth and rate are better.
GpuSpec measuredGpu(const std::string& name, const DeviceRates& rates, int step);
// The published GPU that a renderer's or device's name contains, or the one with the nearest bandwidth (`bandwidth`, bytes/s; 0: unknown).
// A model with a suffix is another GPU: an RTX 3060 Ti is no RTX 3060.
struct NearestGpu {
    GpuSpec gpu;
    bool byName = false;
};
NearestGpu nearestGpu(std::string_view name, double bandwidth);

struct PassCost {
    std::string name;
    double ms = 0;           // in a frame
    double dispatches = 0;   // in a frame
    const char* bound = "";  // "operations", "cache", "memory", "longest thread", "launches"
    double operations = 0;   // in a frame
    double bytes = 0;        // in a frame, of memory
};
struct FrameCost {
    std::vector<PassCost> passes;  // the longest first
    double ms() const;
};

// Work of a frame that is not of the kernels: substeps in a frame, iterations of the pressure solver in a substep.
struct FrameWork {
    double substeps = 1, iterations = 0;
};
// As measured on the cpu, frames.csv; `particles`: the nearest row, scaled with the resolution.
FrameWork measuredWork(std::string_view method, double particles);

// The simulation of a dam break with `particles` particles. `counts`: the table of what kernels do; kernels_before: of the version that was
// measured on an H100.
FrameCost predictSteps(const GpuSpec& gpu, std::string_view method, double particles, const FrameWork& work,
                       std::string_view counts = "kernels");
// A picture of it, 1920x1080, quality fine: passes.csv, for its nearest number of particles, scaled.
FrameCost predictPicture(const GpuSpec& gpu, double particles);

// A kernel as a small world of tests/races runs it, kernels_small.csv: means over its dispatches. These worlds have some hundred particles.
struct CountedKernel {
    bool plain = false;                    // its code was not optimised: more operations than a GPU's
    std::string name, variant;             // "flow/push", "FILM=1"; "-": without defines
    double threads = 0, groups = 0;        // of a dispatch
    std::array<double, kGpuOps> count{};   // operations of a thread
    double step32 = 0;                     // operations of a thread, 32 in lockstep
    double bytes = 0;                      // of memory, of a thread
    double longest = 0, longestLoads = 0;  // operations and loads of the longest thread
    double sectors = 0, waves = 1;         // as in kernels.csv; waves: 1 also if it is not known
    double operations() const;
};
std::vector<CountedKernel> countedKernels();
// The time of one such dispatch, ms: with its launch.
double predictDispatch(const GpuSpec& gpu, const CountedKernel& kernel);

}  // namespace rivulet
