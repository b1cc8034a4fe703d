// Writes parts with their morph targets and materials as one binary glTF 2.0 file, in metres.
#pragma once

#include <string>

#include "assets/make_head/eyes.h"

namespace rivulet::head {

// The bytes of the file. `parts[0]` is the skin; morphs of any part are named by kMorphNames and stored sparsely, those that
// move nothing not at all.
std::string asGlb(const std::vector<Part>& parts);

// Rounds to the stored precision, whole micrometres (here in cm); all other files must agree with it.
dvec3 rounded(dvec3 p);

}  // namespace rivulet::head
