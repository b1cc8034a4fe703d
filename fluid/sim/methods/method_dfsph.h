// DFSPH (Bender and Koschier 2015): pressures solved for, so that neither the density nor the flow compresses, to a tolerance.
#pragma once

#include "fluid/sim/methods/method.h"

namespace rivulet {

Result<std::unique_ptr<Method>> makeDfsph(Device& device, const MethodSetup& setup);

}  // namespace rivulet
