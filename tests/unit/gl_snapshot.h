// GlSnapshot: all of OpenGL's state, found by asking for every number that might name a piece of it: no list of ours decides what counts.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace rivulet::testing {

using GlSnapshot = std::map<std::string, std::vector<double>>;

// Of the context that is current, which has no debug callback: most of the questions are errors.
GlSnapshot glSnapshot();
// One line for each piece that is not alike; "" where all are.
std::string difference(const GlSnapshot& before, const GlSnapshot& after);

}  // namespace rivulet::testing
