#include "engine/scene/pick.h"

#include <cmath>
#include <limits>

namespace rivulet {

float meets(const vec3& origin, const vec3& direction, const vec3& a, const vec3& b, const vec3& c, float most) {
    const vec3 ab = b - a, ac = c - a, p = glm::cross(direction, ac);
    const float det = glm::dot(ab, p);
    if (det == 0) return -1;
    const vec3 from = origin - a, q = glm::cross(from, ab);
    const float u = glm::dot(from, p) / det, v = glm::dot(direction, q) / det, t = glm::dot(ac, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < most ? t : -1;
}

std::optional<Picked> pick(const Scene& scene, const vec3& origin, const vec3& direction) {
    const std::vector<mat4> world = scene.worldMatrices();
    const std::vector<bool> visible = scene.visible();
    std::optional<Picked> nearest;
    float most = std::numeric_limits<float>::max();
    for (size_t n = 0; n < scene.nodes().size(); ++n) {
        const Node& node = scene.nodes()[n];
        if (!node.mesh || !visible[n]) continue;
        const mat4 back = glm::inverse(world[n]);
        const vec3 from(back * vec4(origin, 1.0F)), way(back * vec4(direction, 0.0F));
        const Mesh& mesh = *node.mesh;
        for (size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
            const vec3 &a = mesh.positions[mesh.indices[k]], &b = mesh.positions[mesh.indices[k + 1]],
                       &c = mesh.positions[mesh.indices[k + 2]];
            const float t = meets(from, way, a, b, c, most);
            if (t < 0) continue;
            most = t;
            vec3 normal = glm::transpose(mat3(back)) * glm::cross(b - a, c - a);
            if (glm::dot(normal, direction) > 0) normal = -normal;
            nearest = Picked{n, t, origin + direction * t, glm::normalize(normal)};
        }
    }
    return nearest;
}

}  // namespace rivulet
