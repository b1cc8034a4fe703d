// The invariants of a Model: every index, count and number of it.
#pragma once

#include <string>

#include "engine/scene/model.h"

namespace rivulet {

// The largest coordinate that is accepted, in the unit of the file. Squares of larger ones come near the largest float (3e38).
inline constexpr float kFarthest = 1e15F;

// The first invariant that the model violates, as a phrase: "has a bone without a node". Empty: it violates none.
// Indices are in range, arrays that belong together have the same length, times ascend, rotations are unit quaternions; numbers are finite,
// and coordinates, entries of matrices and colours are at most kFarthest.
std::string faultOf(const Model& model);

}  // namespace rivulet
