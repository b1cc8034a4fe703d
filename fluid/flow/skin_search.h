// Where a straight path meets a skin in its present shape. Triangles are grouped in boxes by their places at rest; boxes follow the skin.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

class SkinSearch {
  public:
    explicit SkinSearch(const FlowMesh& mesh);  // the mesh must outlive it
    void follow(std::span<const vec4> places);  // xyz m, of each of the mesh's places

    struct Hit {
        SkinPoint at;
        vec3 position{0.0F}, normal{0.0F};  // m; unit
        float share = 0;                    // of the path, 0 to 1
    };
    // The first triangle that the path from `from` to `to` (m) meets, from either side. Nothing: none.
    std::optional<Hit> first(const vec3& from, const vec3& to) const;
    const std::vector<vec3>& places() const { return places_; }

  private:
    const FlowMesh* mesh_;
    std::vector<vec3> places_;
    std::vector<uint32_t> order_;  // of triangles
    std::vector<Bounds> boxes_;    // of kTrianglesPerBox of them each
};

}  // namespace rivulet
