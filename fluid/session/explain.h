// What a run is made of, told plainly: what was chosen, what was left out of kernels and passes, and what the rest costs.
#pragma once

#include <string>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"

namespace rivulet {

// As lines of text. `stats` of the run so far: its passes are the costs, per frame; without frames there are none.
std::string explain(const Session& session, const RunStats& stats);

}  // namespace rivulet
