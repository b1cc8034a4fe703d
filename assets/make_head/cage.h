// The control cage: the canonical face with its eyes and mouth opened, and what the face lacks: cranium, neck, ears, the inside of the
// mouth.
#pragma once

#include <string>

#include "assets/make_head/surface.h"
#include "engine/core/result.h"

namespace rivulet::head {

inline constexpr int kOuterCorner[2] = {263, 33};  // of the lid loops: left, right. Vertices keep these numbers through subdivision.
inline constexpr int kInnerCorner[2] = {362, 133};

Result<Surface> readFace(const std::string& path);
Result<Surface> buildCage(const std::string& facePath);

}  // namespace rivulet::head
