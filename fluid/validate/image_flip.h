// FLIP: how different two pictures look when one flips between them (Andersson et al. 2020), for pictures of 8 bits a channel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace rivulet {

// What a pixel covers: 67 a degree is a 0.7 m wide 4K monitor seen from 0.7 m.
constexpr double kPixelsPerDegree = 67;

// A value a pixel, 0: no difference, to 1. RGBA8, sRGB, of one size; alpha does not count.
std::vector<float> flipMap(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height,
                           double pixelsPerDegree = kPixelsPerDegree);
double flipMean(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height,
                double pixelsPerDegree = kPixelsPerDegree);

}  // namespace rivulet
