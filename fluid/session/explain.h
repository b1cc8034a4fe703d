// --explain: which settings were chosen, which kernels and passes were left out, and what the others cost.
#pragma once

#include <string>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"

namespace rivulet {

// As lines of text. `stats` of the run so far: its passes are the costs, per frame; without frames there are none.
std::string explain(const Session& session, const RunStats& stats);

}  // namespace rivulet
