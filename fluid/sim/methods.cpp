#include "fluid/sim/method.h"
#include "fluid/sim/method_wcsph.h"

namespace rivulet {

Table<MethodRow> methods() {
    static constexpr MethodRow rows[] = {
        {"wcsph", "weakly compressible SPH: Tait's equation, Wendland C2, walls by signed distance", makeWcsph},
        {"wcsph_thesis", "the thesis's SPH: poly6 and spiky kernels, linear equation of state, a box that turns velocities round",
         makeWcsphThesis},
    };
    return {rows};
}

}  // namespace rivulet
