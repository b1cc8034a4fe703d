// Steps and pictures of dam_break on a device, measured, beside what the cost model says of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "fluid/session/scene_renderer.h"
#include "fluid/validate/gpu_cost.h"

namespace rivulet {

constexpr int kSeriesWidth = 1920, kSeriesHeight = 1080;  // pixels of a picture

// A device, and the model of it.
struct ExaminedGpu {
    Device* device = nullptr;
    std::string name;
    bool measured = false;  // its rates
    DeviceRates rates = {};
    GpuSpec model = {};
    std::string from = {};  // "RTX 3060, by its name"; a device that is software: "its own measured rates"; empty: there is no model
};
// Threads that a device that is software runs in lockstep: Mesa's llvmpipe ("gl") 8, vectors of 256 bits; PoCL ("cl") one after the other.
int threadsInStep(std::string_view backend);
// `name`: of the renderer or the OpenCL device. As namedGpu() if hostSeconds() passes `until` before its rates are measured. Error: as
// measureRates().
Result<ExaminedGpu> examineGpu(Device& device, const std::string& name, double until = 1.0e300);
// Without measured rates: a GPU has a model if its name is that of a published one.
ExaminedGpu namedGpu(Device& device, const std::string& name);

// All times are ms: on a GPU of the wall, with a wait at the end. A device that is software: processor time over the number of threads,
// which other programs on the machine hardly change.
struct SeriesRow {
    std::string device, method;  // "gl", "pbf"
    int particles = 0;
    double stepMs = 0, predictedStepMs = 0;                                   // of a substep; predictions are 0 without a model
    double frameMs = 0, predictedFrameMs = 0;                                 // of 1/60 s, with the substeps and iterations of frames.csv
    double substeps = 0;                                                      // of a step
    double iterations = 0;                                                    // of the pressure solver, in a substep
    int warmSteps = 0;                                                        // before those that are measured: 8, if there is time
    double drawMs = 0, predictedDrawMs = 0;                                   // of a picture; 0: not drawn
    std::optional<Error> notDrawn = {};                                       // why, if a picture was tried
    std::map<std::string, double> passes = {}, predictedPasses = {};          // of a substep: the least, scaled to stepMs if it is software
    std::map<std::string, double> drawPasses = {}, predictedDrawPasses = {};  // of a picture
};

int seriesParticles(int side);  // a column `side` particles wide and deep, twice as high
FluidParams seriesWater(const SceneFile& damBreak, const char* method, int side);

// Steps the column for `seconds` on the wall, and draws it with `renderer`, if it is not null; `gpu` must then be of gl, which draws. When
// hostSeconds() is past `until`, it ends after the step or picture at hand: it has then measured one step at least, and no picture unless
// it had begun. Error: out of memory (Error::memory), or the device failed. A picture that fails is no error: notDrawn.
Result<SeriesRow> measureSeries(const ExaminedGpu& gpu, const SceneFile& damBreak, const char* method, int side, double seconds,
                                SceneRenderer* renderer, double until = 1.0e300);

}  // namespace rivulet
