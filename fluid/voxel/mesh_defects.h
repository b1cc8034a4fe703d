// Counts the defects of a mesh, and makes its faces consistent.
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
    size_t boundaryEdges = 0;     // with one face
    size_t nonManifoldEdges = 0;  // with three or more faces
    size_t flippedFaces = 0;      // reversed to agree with their component
    size_t components = 0;        // connected through edges with two faces
    size_t unorientable = 0;      // components that cannot be oriented (a Moebius strip)
    bool watertight = false;      // no boundary edge, and along every edge equally many faces run each way
    size_t badEdges() const { return boundaryEdges + nonManifoldEdges; }
    std::string sentence() const;  // the defects, their numbers and the corrections; "" if there is none
};

// Several meshes as one: equal places merged, duplicate and degenerate faces removed. The faces of each orientable component agree with the
// majority of its area as given, so the wall of a cavity keeps its orientation. An unorientable component stays as given.
struct CleanMesh {
    std::vector<vec3> positions;      // each place once, in order of first use
    std::vector<uint32_t> indices;    // 3 a triangle
    std::vector<uint32_t> source;     // of each triangle: its number in the meshes as given, one after the other
    std::vector<uint32_t> component;  // of each triangle
    // Pairs of places: directed edges along which more faces run one way than the other, repeated by the excess. Empty if and only if
    // the faces close; at every place equally many edges end and begin.
    std::vector<uint32_t> unmatched;
    MeshDefects defects;
};
// Indices must be in range and positions finite; fewer than 2^31 corners in all.
CleanMesh cleanMesh(std::span<const MeshView> meshes);

}  // namespace rivulet
