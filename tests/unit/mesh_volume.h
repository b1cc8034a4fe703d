// The volume of a closed mesh.
#pragma once

#include "engine/core/mesh_view.h"

namespace rivulet {

inline double volumeOf(const MeshView& mesh) {
    double sum = 0;
    for (size_t k = 0; k < mesh.indices.size(); k += 3) {
        const dvec3 a(mesh.positions[mesh.indices[k]]), b(mesh.positions[mesh.indices[k + 1]]), c(mesh.positions[mesh.indices[k + 2]]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

}  // namespace rivulet
