// Shapes on which flow is measured, and layouts of one shape that differ as UVs and importers make meshes differ.
#pragma once

#include <string>
#include <vector>

#include "engine/core/math.h"
#include "engine/core/mesh_view.h"

namespace rivulet {

struct Shape {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
    std::vector<vec2> uvs = {};
    MeshView view() const { return {positions, indices, {}, uvs}; }
};

// n x m quads in the plane of `across` and `along` (m), from `corner`; its normal is across x along, its UVs 0 to 1 along both.
Shape sheetShape(const vec3& corner, const vec3& across, const vec3& along, uint32_t n, uint32_t m);
// `rows` x 2 `rows` quads, poles closed by triangles, with a seam of double vertices. Upright; UVs are longitude and latitude.
Shape ballShape(float radius, uint32_t rows);
// About the y axis, from y = 0 up to `height`, open above and below, with a seam; the radius goes from `low` to `high`.
Shape coneShape(float low, float high, float height, uint32_t around, uint32_t rows);

// The same surface with another layout.
enum class Layout {
    own,        // unchanged
    stretched,  // UVs four times as long along one axis, increasingly towards one side
    turned,     // UVs turned by 40 degrees; corners and triangles in another order
    pieces      // no shared vertices; squares of UVs are turned and moved
};
Shape laidOut(const Shape& shape, Layout layout);
const char* layoutName(Layout layout);

}  // namespace rivulet
