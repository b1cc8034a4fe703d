// FLIP (Andersson et al. 2020): the difference of two pictures that a viewer perceives when they alternate; 8 bits per channel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace rivulet {

// Pixels per degree of view: 67 for a 4K monitor 0.7 m wide, seen from 0.7 m.
constexpr double kPixelsPerDegree = 67;

// One value per pixel, 0 (no difference) to 1. RGBA8, sRGB, the same size; alpha is ignored.
std::vector<float> flipMap(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height,
                           double pixelsPerDegree = kPixelsPerDegree);
double flipMean(std::span<const uint8_t> reference, std::span<const uint8_t> test, int width, int height,
                double pixelsPerDegree = kPixelsPerDegree);

}  // namespace rivulet
