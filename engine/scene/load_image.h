// Reads pictures: PNG, JPEG, TGA, BMP (stb_image).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "engine/core/result.h"
#include "engine/material/image.h"

namespace rivulet {

// Error (badInput): no such file, damaged, of an unknown kind, or wider than 16384 texels.
Result<Image> loadImage(const std::string& path);
// The same from a file's bytes; `name` is what errors call it.
Result<Image> decodeImage(std::span<const std::byte> bytes, const std::string& name);

// A Radiance .hdr file, or any other picture as linear light. What is not finite, negative or above 1000 is brought back into range.
Result<HdrImage> loadHdr(const std::string& path);

}  // namespace rivulet
