// Reads images: PNG, JPEG, TGA, BMP (stb_image).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "engine/core/result.h"
#include "engine/material/image.h"

namespace rivulet {

// Error (badInput): no such file, damaged, of an unknown format, or wider or higher than 16384 texels.
Result<Image> loadImage(const std::string& path);
// The same from the bytes of a file; errors use `name`.
Result<Image> decodeImage(std::span<const std::byte> bytes, const std::string& name);

// A Radiance .hdr file, or another image converted to linear radiance. NaN and infinity become 0, other values are clamped to 0..1000.
Result<HdrImage> loadHdr(const std::string& path);

}  // namespace rivulet
