// Checks of meshes and their error messages.
#include "fluid/voxel/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>

namespace rivulet {
namespace {

// "Mesh 2 of 3" if there are several.
std::string which(size_t mesh, size_t count) { return count == 1 ? "The mesh" : fmt::format("Mesh {} of {}", mesh + 1, count); }

std::optional<Error> checkMesh(const MeshView& mesh, const std::string& name) {
    if (mesh.indices.size() % 3 != 0)
        return badInput(fmt::format("{} has {} indices, not a multiple of three; triangulate it.", name, mesh.indices.size()));
    const auto inside = [&](uint32_t index) { return index < mesh.positions.size(); };
    const auto stray = std::find_if_not(mesh.indices.begin(), mesh.indices.end(), inside);
    if (stray != mesh.indices.end())
        return badInput(fmt::format("{} refers to vertex {} but has only {} vertices (triangle {}); export it again.", name, *stray,
                                    mesh.positions.size(), (stray - mesh.indices.begin()) / 3));
    const auto wrong = std::count_if(mesh.positions.begin(), mesh.positions.end(), [](const vec3& p) { return !isFinite(p); });
    if (wrong > 0)
        return badInput(fmt::format("{} has {} of {} vertices that are NaN or infinite; remove them.", name, wrong, mesh.positions.size()));
    return std::nullopt;
}

}  // namespace

MeshExtent extentOf(std::span<const MeshView> meshes) {
    MeshExtent e;
    for (const MeshView& mesh : meshes) {
        for (uint32_t index : mesh.indices) e.bounds.add(mesh.positions[index]);
    }
    const dvec3 size = dvec3(e.bounds.max) - dvec3(e.bounds.min);
    e.longest = std::max(size.x, std::max(size.y, size.z));
    return e;
}

std::optional<Error> checkMeshes(std::span<const MeshView> meshes) {
    size_t triangles = 0;
    for (size_t m = 0; m < meshes.size(); ++m) {
        if (auto error = checkMesh(meshes[m], which(m, meshes.size()))) return *error;
        triangles += meshes[m].triangleCount();
    }
    if (triangles == 0) return badInput("There is no triangle to voxelise; the mesh is empty or holds only points and lines.");
    if (triangles > std::numeric_limits<uint32_t>::max())
        return badInput(fmt::format("{} triangles are too many to voxelise; simplify the mesh.", triangles));
    return std::nullopt;
}

std::optional<Error> checkVoxel(const MeshExtent& extent, float voxel) {
    if (!(extent.longest > 0.0)) return badInput("The mesh has no extent: all triangles are at one point; check its scale.");
    const dvec3 furthest = glm::max(glm::abs(dvec3(extent.bounds.min)), glm::abs(dvec3(extent.bounds.max)));
    const double away = std::max(furthest.x, std::max(furthest.y, furthest.z));
    // A float near `away` is exact to 2^-24 of it; a voxel must span several of those steps.
    if (!(voxel > 16.0 * away / 16777216.0) || !std::isnormal(voxel))
        return badInput(
            fmt::format("32-bit floats cannot distinguish voxels of {:.3g} m at {:.3g} m from the origin; "
                        "move the mesh closer to the origin, scale it or lower the resolution.",
                        voxel, away));
    return std::nullopt;
}

}  // namespace rivulet
