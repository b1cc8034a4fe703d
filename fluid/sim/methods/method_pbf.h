// Position Based Fluids (Macklin and Mueller 2013): a few corrections of predicted positions a step. Fast, unconditionally bounded, a
// little soft.
#pragma once

#include "fluid/sim/methods/method.h"

namespace rivulet {

Result<std::unique_ptr<Method>> makePbf(Device& device, const MethodSetup& setup);

}  // namespace rivulet
