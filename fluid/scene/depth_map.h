// What is seen of triangles from one direction: the height of the nearest one over each texel of a window.
#pragma once

#include <limits>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

// A right-handed frame: x to the subject's left, y up, z towards the viewer.
struct ViewFrame {
    vec3 origin{0.0F}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  // the axes: unit, perpendicular
    vec3 into(const vec3& p) const { return {glm::dot(p - origin, x), glm::dot(p - origin, y), glm::dot(p - origin, z)}; }
    vec3 back(const vec3& p) const { return origin + p.x * x + p.y * y + p.z * z; }
};

class DepthMap {
  public:
    static constexpr float kNothing = -std::numeric_limits<float>::infinity();

    // Texels of edge `step` from `low` on; `triangles`: three corners each.
    DepthMap(const ViewFrame& frame, const std::vector<vec3>& triangles, const vec2& low, int width, int height, float step);

    int width() const { return width_; }
    int height() const { return height_; }
    float step() const { return step_; }
    vec2 middleOf(int x, int y) const { return low_ + (vec2(x, y) + 0.5F) * step_; }
    bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }
    // kNothing where no triangle is, or outside the window.
    float at(int x, int y) const {
        return inside(x, y) ? z_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)] : kNothing;
    }
    float over(const vec2& p) const {
        const vec2 t = glm::floor((p - low_) / step_);
        return t.x >= 0 && t.y >= 0 && t.x < static_cast<float>(width_) && t.y < static_cast<float>(height_)
                   ? at(static_cast<int>(t.x), static_cast<int>(t.y))
                   : kNothing;
    }

  private:
    vec2 low_;
    int width_, height_;
    float step_;
    std::vector<float> z_;
};

}  // namespace rivulet
