// Checks a struct of Params that a program filled in by the rules that a file is checked by.
#pragma once

#include <string_view>

#include "engine/core/json.h"

namespace rivulet {

// Error (badInput): the first value that is not finite, outside its ParamInfo's range, or not a name of its choice: `fluid.spacing is -1 m,
// must be between 1e-05 and 1 m`. `group`: the path of the struct, for example "fluid", or "".
Status checkParams(std::string_view group, const VisitFn& visit);

// Visits a copy: `params` stays as it is.
template <class P>
Status checkParams(std::string_view group, const P& params) {
    P copy = params;
    return checkParams(group, VisitFn([&copy](ParamVisitor& v) { copy.visit(v); }));
}

}  // namespace rivulet
