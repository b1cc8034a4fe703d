#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/method_dfsph.h"
#include "fluid/sim/methods/method_pbf.h"
#include "fluid/sim/methods/method_wcsph.h"

namespace rivulet {

Table<MethodRow> methods() {
    static constexpr MethodRow rows[] = {
        {"pbf", "position based fluids: a few corrections of positions a step; the fast one", makePbf},
        {"dfsph", "divergence-free SPH: pressures solved for to a tolerance, density kept in the same solve; the accurate one", makeDfsph},
        {"wcsph", "weakly compressible SPH: Tait's equation, walls by signed distance", makeWcsph},
        {"wcsph_thesis", "the thesis's SPH: poly6 and spiky kernels, linear equation of state, a box that turns velocities round",
         makeWcsphThesis},
    };
    return {rows};
}

}  // namespace rivulet
