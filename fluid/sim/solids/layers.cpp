#include "fluid/sim/solids/layers.h"

namespace rivulet {

void LayersParams::visit(ParamVisitor& v) {
    v.value(
        {"layers", "", "collision layers that it is on, a bit each: 1 = the first, 2 = the second, 3 = both; 0 = none, it meets nothing", 0,
         kAll, kLinear, kFixed},
        layers);
    v.value(
        {"meets", "", "collision layers that it meets, a bit each; two things meet if each is on a layer that the other meets; 65535 = all",
         0, kAll, kLinear, kFixed},
        meets);
}

}  // namespace rivulet
