#include "fluid/scene/ball_fit.h"

#include <algorithm>
#include <glm/matrix.hpp>

namespace rivulet {

namespace {

// |x|^2 = 2 c . x + (r^2 - |c|^2), least squares about the mean. False where the points lie in a plane.
bool fitSphere(const std::vector<vec3>& points, vec3& centre, float& radius) {
    if (points.size() < 4) return false;
    glm::dvec3 mean(0.0), right(0.0);
    for (const vec3& p : points) mean += glm::dvec3(p) / static_cast<double>(points.size());
    glm::dmat3 spread(0.0);
    double square = 0;
    for (const vec3& p : points) square += glm::dot(glm::dvec3(p) - mean, glm::dvec3(p) - mean) / static_cast<double>(points.size());
    for (const vec3& p : points) {
        const glm::dvec3 x = glm::dvec3(p) - mean;
        spread += glm::outerProduct(x, x);
        right += 0.5 * x * (glm::dot(x, x) - square);
    }
    const double size = square * static_cast<double>(points.size());
    if (!(std::abs(glm::determinant(spread)) > 1.0e-12 * size * size * size)) return false;
    const glm::dvec3 c = glm::inverse(spread) * right;
    const auto fitted = static_cast<float>(std::sqrt(square + glm::dot(c, c)));
    if (!std::isfinite(fitted) || fitted <= 0) return false;
    centre = vec3(c + mean);
    radius = fitted;
    return true;
}

}  // namespace

bool fitBall(const std::vector<vec3>& points, vec3& centre, float& radius) {
    if (!fitSphere(points, centre, radius)) return false;
    for (int again = 0; again < 6; ++again) {
        std::vector<vec3> near = points;
        std::erase_if(near, [&](const vec3& p) { return std::abs(glm::distance(p, centre) - radius) > 0.03F * radius; });
        if (!fitSphere(near, centre, radius)) break;
    }
    return true;
}

}  // namespace rivulet
