// The control cage of the head: the canonical face with open eyes and mouth, and the parts that the face model lacks: cranium, neck, ears,
// the inside of the mouth.
#pragma once

#include <string>

#include "assets/make_head/surface.h"
#include "engine/core/result.h"

namespace rivulet::head {

inline constexpr int kOuterCorner[2] = {263, 33};  // vertices of the lid loops: left, right. Subdivision keeps vertex numbers.
inline constexpr int kInnerCorner[2] = {362, 133};

Result<Surface> readFace(const std::string& path);
Result<Surface> buildCage(const std::string& facePath);

}  // namespace rivulet::head
