// SceneSketch: a line drawing of a scene for which there is no picture: its box, its blocks of water and its solids, from its camera.
#pragma once

#include <string>
#include <vector>

#include "engine/core/math.h"

struct ImDrawList;

namespace rivulet {

class SceneSketch {
  public:
    // `path`: of a scene file. One that cannot be read is an empty sketch. `shape`: height over width.
    SceneSketch(const std::string& path, float shape);
    void draw(ImDrawList& list, const vec2& corner, float width) const;  // px

  private:
    enum class Of { box, water, solid };
    void add(const mat4& onto, const vec3& low, const vec3& high, Of of);

    struct Face {
        vec2 corners[4];  // shares of the width, from the top left corner
        Of of = Of::box;
    };
    std::vector<Face> faces_;
    float shape_;
};

}  // namespace rivulet
