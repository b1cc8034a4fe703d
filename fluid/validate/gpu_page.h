// The page of the cost model: its predictions, and their error where it can be measured.
#pragma once

#include <string>
#include <vector>

#include "fluid/validate/gpu_series.h"

namespace rivulet {

// What was measured on this machine.
struct GpuModelRun {
    std::vector<ExaminedGpu> gpus;
    std::vector<SeriesRow> rows;
};

// Writes FOLDER/gpus.md and FOLDER/gpus.csv; `command` is named in the page. Without gpus in `run`, what an older FOLDER/gpus.md says of
// the devices of its machine stays, and predictions are written anew. Error (failed): a file cannot be written; (badInput) there is no
// older page.
Status writeGpuPage(const GpuModelRun& run, const std::string& folder, const std::string& command);

}  // namespace rivulet
