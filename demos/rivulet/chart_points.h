// The points of the chart "speed against accuracy" as tasks of a sweep: each is measured by a process of its own and written to a file.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "fluid/validate/chart.h"

namespace rivulet {

// A sweep with one task for each point of this chart, for `rivulet sweep`.
std::string sweepOfChart(const ChartRequest& request);

// A point as JSON, numbers exactly.
std::string chartPointText(const ChartRequest& request, size_t k, const ChartPoint& point);

// The chart of the points in the folder of a sweep that sweepOfChart describes. Error (badInput): a point is missing, damaged, or of
// another chart.
Result<Chart> chartOfSweep(const ChartRequest& request, const std::string& folder);

}  // namespace rivulet
