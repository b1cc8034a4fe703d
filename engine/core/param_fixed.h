// Params that are `fixed` keep their value from the creation of a world; the others may change while it runs. Only `visit` marks them.
#pragma once

#include "engine/core/json.h"

namespace rivulet {

// Gives each fixed value, and each fixed list as a whole, of `next` the value it has in `old`. Both visit the same type; a list that is not
// fixed must hold no fixed values.
void keepFixed(const VisitFn& next, const VisitFn& old);

template <class P>
void keepFixed(P& next, const P& old) {
    P copy = old;
    keepFixed(VisitFn([&next](ParamVisitor& v) { next.visit(v); }), VisitFn([&copy](ParamVisitor& v) { copy.visit(v); }));
}

}  // namespace rivulet
