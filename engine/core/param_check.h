// Whether a struct of Params that a program filled in is one that a file could have said.
#pragma once

#include <string_view>

#include "engine/core/json.h"

namespace rivulet {

// Error (badInput): the first value that is not finite or out of its ParamInfo's range, or no name of a choice: `fluid.spacing is -1 m,
// must be between 1e-05 and 1 m`. `group`: where the struct stands, "fluid", or "".
Status checkParams(std::string_view group, const VisitFn& visit);

// Visits a copy: `params` stays as it is.
template <class P>
Status checkParams(std::string_view group, const P& params) {
    P copy = params;
    return checkParams(group, VisitFn([&copy](ParamVisitor& v) { copy.visit(v); }));
}

}  // namespace rivulet
