// What is wrong with a mesh, counted; and the same mesh with its faces made consistent.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/core/mesh_view.h"

namespace rivulet {

// Vertices at the same place count as one. An edge is between two different places.
struct MeshDefects {
    size_t triangles = 0;         // as given
    size_t degenerateFaces = 0;   // two corners at one place
    size_t duplicateFaces = 0;    // the same three places in the same cyclic order as an earlier face; a face and its reverse both stay
    size_t boundaryEdges = 0;     // of one face
    size_t nonManifoldEdges = 0;  // of three and more faces
    size_t flippedFaces = 0;      // turned round to agree with their component
    size_t components = 0;        // connected through edges of two faces
    size_t unorientable = 0;      // components that no turning makes consistent (a Moebius strip)
    bool watertight = false;      // no boundary edge, and along every edge as many faces one way as the other
    size_t badEdges() const { return boundaryEdges + nonManifoldEdges; }
    std::string sentence() const;  // what is wrong and how often, and what was done about it; "" if nothing is
};

// Several meshes as one: places shared, duplicate and degenerate faces gone, each orientable component's faces turned to agree with the
// majority of its area as given (so that a cavity's wall keeps its sense). An unorientable component stays as given.
struct CleanMesh {
    std::vector<vec3> positions;      // each place once, in order of first use
    std::vector<uint32_t> indices;    // 3 a triangle
    std::vector<uint32_t> source;     // of each triangle: its number in the meshes as given, one after the other
    std::vector<uint32_t> component;  // of each triangle
    // Pairs of places: the edges, with their sense, along which more faces run one way than the other, as often as they do so. Empty iff
    // the faces close; at every place as many end as begin.
    std::vector<uint32_t> unmatched;
    MeshDefects defects;
};
// Indices must be in range and positions finite; fewer than 2^31 corners in all.
CleanMesh cleanMesh(std::span<const MeshView> meshes);

}  // namespace rivulet
