#include "fluid/validate/oscillation.h"

#include <cmath>

namespace rivulet {

namespace {

struct Fit {
    dvec3 factors{0.0};  // of exp cos, exp sin and 1
    double squares = 0;  // sum of the squares of the residuals
};

// For a given frequency and decay the other parameters are linear: normal equations.
Fit linearFit(std::span<const glm::dvec2> curve, double frequency, double decay) {
    const double begin = curve.front().x;
    const auto basis = [&](double t) {
        const double e = std::exp(-decay * (t - begin));
        return dvec3(e * std::cos(frequency * (t - begin)), e * std::sin(frequency * (t - begin)), 1.0);
    };
    glm::dmat3 normal(0.0);
    dvec3 right(0.0);
    for (const glm::dvec2& at : curve) {
        const dvec3 b = basis(at.x);
        normal += glm::outerProduct(b, b);
        right += at.y * b;
    }
    Fit fit;
    fit.factors = glm::inverse(normal) * right;
    for (const glm::dvec2& at : curve) fit.squares += std::pow(at.y - glm::dot(fit.factors, basis(at.x)), 2);
    return fit;
}

}  // namespace

Oscillation fitOscillation(std::span<const glm::dvec2> curve, double expected) {
    double frequency = expected, decay = 0, best = linearFit(curve, frequency, decay).squares;
    const auto attempt = [&](double w, double b) {
        const double squares = linearFit(curve, w, b).squares;
        if (!(squares < best)) return false;
        best = squares;
        frequency = w;
        decay = b;
        return true;
    };
    // A grid, because the sum of squares has many minima along the frequency; then a pattern search.
    for (int i = 0; i <= 60; ++i)
        for (int k = 0; k <= 20; ++k) attempt((0.4 + 0.02 * i) * expected, 0.05 * k * expected);
    for (double step = 0.01 * expected; step > 1e-7 * expected;) {
        const double w = frequency, b = decay;
        const bool better = attempt(w + step, b) || attempt(w - step, b) || attempt(w, b + step) || attempt(w, b - step);
        if (!better) step *= 0.5;
    }
    const Fit fit = linearFit(curve, frequency, decay);
    const double amplitude = std::hypot(fit.factors.x, fit.factors.y) * std::exp(decay * curve.front().x);
    const double shown = std::hypot(fit.factors.x, fit.factors.y);
    return {.frequency = frequency,
            .decay = decay,
            .amplitude = amplitude,
            .offset = fit.factors.z,
            .misfit = std::sqrt(fit.squares / static_cast<double>(curve.size())) / std::max(shown, 1e-30)};
}

}  // namespace rivulet
