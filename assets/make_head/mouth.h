// Teeth and tongue, which go with the jaw.
#pragma once

#include "assets/make_head/eyes.h"

namespace rivulet::head {

// Both rows; `jaw` becomes each vertex's share of the jaw's motion.
Part makeTeeth(std::vector<double>& jaw);
Part makeTongue(std::vector<double>& jaw);

}  // namespace rivulet::head
