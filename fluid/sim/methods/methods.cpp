#include "engine/core/assert.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/method_dfsph.h"
#include "fluid/sim/methods/method_pbf.h"
#include "fluid/sim/methods/method_wcsph.h"

namespace rivulet {

Table<MethodRow> methods() {
    static const MethodRow rows[] = {pbfMethod(), dfsphMethod(), wcsphMethod(), wcsphThesisMethod()};
    return {rows};
}

const MethodRow& methodOf(const FluidParams& params) {
    const MethodRow* row = methods().find(params.method);
    ASSERT(row != nullptr, "check the Params before");
    return *row;
}

}  // namespace rivulet
