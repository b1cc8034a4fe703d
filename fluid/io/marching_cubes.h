// Marching cubes (Lorensen & Cline 1987) over an IsoSurface, without tables: in each cell the crossings of its edges are joined face by
// face to loops. A face's crossings are joined by its four corners alone, so that the cells on both sides agree: the mesh is closed, and
// each edge has two triangles. On ambiguous faces the corners inside are not connected.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/sim/surface/iso_surface.h"

namespace rivulet {

// A closed surface: triangles that own their memory.
struct SurfaceMesh {
    std::vector<vec3> positions;    // m, on the iso-surface within 1e-3 cells; in the middle of an ambiguous cell within half a cell
    std::vector<vec3> normals;      // one a position: of the iso-surface there, outward, unit
    std::vector<uint32_t> indices;  // 3 a triangle, counter-clockwise seen from outside
    MeshView view() const { return {positions, indices, normals, {}}; }
};

constexpr int kMaxCellsPerSpacing = 8;

// `cellsPerSpacing`: 1 to kMaxCellsPerSpacing cells along a spacing. Error (badInput): another number. Error (failed): more vertices than
// 32 bits can count.
Result<SurfaceMesh> marchingCubes(const IsoSurface& surface, int cellsPerSpacing = 2);

}  // namespace rivulet
