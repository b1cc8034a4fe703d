// The point of a triangle that is nearest to a given point (Ericson 2005, 5.1.5).
#pragma once

#include <algorithm>
#include <array>

#include "engine/core/math.h"

namespace rivulet {

// Barycentric weights of the nearest point, 0 to 1, sum 1: by Voronoi regions; of a triangle without area, by its edges.
inline std::array<double, 3> nearestWeights(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 ab = b - a, ac = c - a, bc = c - b, q = p - a;
    const double abab = glm::dot(ab, ab), acac = glm::dot(ac, ac), abac = glm::dot(ab, ac);
    const double onAb = glm::dot(ab, q), onAc = glm::dot(ac, q);
    const double area = abab * acac - abac * abac;
    const double v = acac * onAb - abac * onAc, w = abab * onAc - abac * onAb;
    if (area > 1e-14 * abab * acac && v >= 0.0 && w >= 0.0 && v + w <= area) return {1.0 - (v + w) / area, v / area, w / area};
    const auto along = [](const dvec3& edge, const dvec3& from) {
        const double square = glm::dot(edge, edge);
        return square > 0.0 ? std::min(1.0, std::max(0.0, glm::dot(edge, from) / square)) : 0.0;
    };
    const double onB = along(ab, q), onC = along(ac, q), onBc = along(bc, p - b);
    const dvec3 toB = q - ab * onB, toC = q - ac * onC, toBc = p - b - bc * onBc;
    const double fromAb = glm::dot(toB, toB), fromAc = glm::dot(toC, toC), fromBc = glm::dot(toBc, toBc);
    if (fromAb <= fromAc && fromAb <= fromBc) return {1.0 - onB, onB, 0.0};
    if (fromAc <= fromBc) return {1.0 - onC, 0.0, onC};
    return {0.0, 1.0 - onBc, onBc};
}

}  // namespace rivulet
