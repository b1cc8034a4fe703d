#include "fluid/scene/depth_map.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

DepthMap::DepthMap(const ViewFrame& frame, const std::vector<vec3>& triangles, const vec2& low, int width, int height, float step)
    : low_(low), width_(width), height_(height), step_(step), z_(static_cast<size_t>(width) * static_cast<size_t>(height), kNothing) {
    const vec2 edge(static_cast<float>(width), static_cast<float>(height));
    for (size_t t = 0; t + 2 < triangles.size(); t += 3) {
        dvec3 p[3];
        vec2 least(1.0e30F), most(-1.0e30F);
        for (size_t k = 0; k < 3; ++k) {
            const vec3 v = frame.into(triangles[t + k]);
            const vec2 at = (vec2(v) - low) / step - 0.5F;  // texels' middles are whole numbers
            p[k] = dvec3(at, v.z);
            least = glm::min(least, at);
            most = glm::max(most, at);
        }
        if (!(most.x >= 0 && most.y >= 0 && least.x <= edge.x - 1 && least.y <= edge.y - 1)) continue;
        const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
        if (std::abs(area) < 1.0e-9) continue;
        const int x0 = static_cast<int>(std::ceil(std::max(least.x, 0.0F))), x1 = static_cast<int>(std::min(most.x, edge.x - 1));
        const int y0 = static_cast<int>(std::ceil(std::max(least.y, 0.0F))), y1 = static_cast<int>(std::min(most.y, edge.y - 1));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                double share[3];
                for (size_t k = 0; k < 3; ++k) {
                    const dvec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
                    share[k] = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
                }
                if (std::min({share[0], share[1], share[2]}) < -1.0e-6) continue;
                float& there = z_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
                there = std::max(there, static_cast<float>(share[0] * p[0].z + share[1] * p[1].z + share[2] * p[2].z));
            }
    }
}

}  // namespace rivulet
