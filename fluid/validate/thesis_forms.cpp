#include "fluid/validate/thesis_forms.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

dmat3 thesisFrame(const std::array<dvec3, 3>& x, const std::array<dvec2, 3>& uv) {
    const dvec2 ab = uv[1] - uv[0], ac = uv[2] - uv[0];
    const double over = 1 / (ab.x * ac.y - ab.y * ac.x);
    const dvec3 t = ((x[1] - x[0]) * ac.y - (x[2] - x[0]) * ab.y) * over, b = ((x[2] - x[0]) * ab.x - (x[1] - x[0]) * ac.x) * over;
    return {t, b, glm::cross(t, b)};
}

dmat3 printedFrame(const dmat3& m0, const dvec3& normal) {
    const dvec3 n = glm::normalize(normal) * glm::length(m0[2]);
    return {m0[0], glm::cross(m0[0], n), n};
}

dmat3 correctedFrame(const dmat3& m0, const dvec3& normal) { return {m0[0], m0[1], glm::normalize(normal)}; }

double turnedBy(const dmat3& m0, const dmat3& m, const dvec3& force) {
    const dvec3 n = glm::normalize(m0[2]), along = force - n * glm::dot(force, n), f = glm::inverse(m) * force;
    const dvec3 moves = m0[0] * f.x + m0[1] * f.y;
    const double lengths = glm::length(along) * glm::length(moves);
    return lengths > 0 ? std::acos(std::clamp(glm::dot(along, moves) / lengths, -1.0, 1.0)) : 0;
}

double printedHold(double outward, double adhesive, double curvature, double slope) { return outward + adhesive + curvature / slope; }

double correctedHold(double outward, double adhesive, double curvature, double slope, double most) {
    return -outward + adhesive + std::min(curvature / slope, most);
}

}  // namespace rivulet
