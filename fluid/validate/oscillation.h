// A damped oscillation, fitted to a curve by least squares.
#pragma once

#include <span>

#include "engine/core/math.h"

namespace rivulet {

// offset + amplitude exp(-decay t) cos(frequency t + phase)
struct Oscillation {
    double frequency = 0;  // rad/s
    double decay = 0;      // 1/s
    double amplitude = 0, offset = 0;
    double misfit = 0;  // root mean square of the residuals over the amplitude
};

// Fits points (t in s, value). `expected`, rad/s: frequencies from 0.4 to 1.6 times it are searched. At least five points.
Oscillation fitOscillation(std::span<const glm::dvec2> curve, double expected);

}  // namespace rivulet
