#include "fluid/sim/solids/wet_surface.h"

#include <algorithm>
#include <cmath>

#include "fluid/voxel/distance_band.h"
#include "shaders/fluid/solids/wet_cells.h"

namespace rivulet {

namespace {

constexpr double kMostCells = 1 << 20;  // of a solid: 4 MB

// The points of the mesh that are nearest to the grid points within a voxel of it.
std::vector<ShellPoint> shellOf(const VoxelField& field) {
    std::vector<ShellPoint> shell;
    const VoxelGrid& grid = field.surface;
    const ivec3 n = grid.size + 1;
    size_t at = 0;
    for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y)
            for (int x = 0; x < n.x; ++x, ++at) {
                const float d = field.distance[at];
                if (!(std::abs(d) < std::min(grid.voxel, field.band))) continue;
                const vec3 away = unpackNormal(field.normal[at]);
                const vec3 place = grid.origin + grid.voxel * vec3(x, y, z) - away * std::abs(d);
                shell.push_back({place, field.closed ? std::copysign(1.0F, d) * away : vec3(0.0F)});
            }
    return shell;
}

void add(WetSurface& to, const SolidRef& ref, const std::vector<ShellPoint>& shell, float cell) {
    if (shell.empty()) return;
    Bounds bounds;
    for (const ShellPoint& p : shell) bounds.add(p.place);
    WetSolid s{.solid = ref};
    const auto cellsAt = [&](float edge) { return glm::floor(bounds.size() / edge) + 1.0F; };
    const auto count = [&](float edge) {
        const dvec3 n(cellsAt(edge));
        return n.x * n.y * n.z;
    };
    while (count(cell) > kMostCells) cell *= 1.02F;
    s.cell = cell;
    s.size = ivec3(cellsAt(cell));
    s.corner = bounds.centre() - 0.5F * cell * vec3(s.size);
    s.firstCell = static_cast<uint32_t>(to.cells.size());
    s.firstPoint = static_cast<uint32_t>(to.points.size());
    to.cells.resize(to.cells.size() + static_cast<size_t>(count(cell)), -1);
    std::vector<float> shares;
    for (const ShellPoint& p : shell) {
        const ivec3 c = glm::clamp(ivec3(glm::floor((p.place - s.corner) / cell)), ivec3(0), s.size - 1);
        int32_t& point = to.cells[s.firstCell + static_cast<size_t>((c.z * s.size.y + c.y) * s.size.x + c.x)];
        if (point < 0) {
            point = static_cast<int32_t>(to.points.size());
            to.points.push_back({vec4(0.0F), vec4(0.0F)});
            shares.push_back(0);
        }
        WetSurface::Point& sum = to.points[static_cast<size_t>(point)];
        sum.place += vec4(p.place, 0.0F);
        sum.normal += vec4(p.normal, 0.0F);
        ++shares[static_cast<size_t>(point) - s.firstPoint];
    }
    for (size_t k = 0; k < shares.size(); ++k) {
        WetSurface::Point& p = to.points[s.firstPoint + k];
        p.place /= shares[k];
        p.normal /= shares[k];
        // The sides of a plate thinner than a cell cancel each other.
        const float length = glm::length(vec3(p.normal));
        p.normal = length > 0.4F ? p.normal / length : vec4(0.0F);
    }
    s.points = static_cast<uint32_t>(shares.size());
    to.solids.push_back(s);
}

}  // namespace

Pose WetSolid::poseAmong(std::span<const Pose> rigid, std::span<const BodyState> bodies) const {
    if (solid.on == ProbeOn::rigid) return rigid[solid.index];
    return solid.on == ProbeOn::body ? bodies[solid.index].pose : Pose{};
}

mat4 WetSolid::cellsFromWorld(const mat4& toWorld) const {
    const mat4 toCells(vec4(1 / cell, 0, 0, 0), vec4(0, 1 / cell, 0, 0), vec4(0, 0, 1 / cell, 0), vec4(-corner / cell, 1));
    return toCells * glm::inverse(toWorld);
}

mat4 WetSolid::cellsFromWorld(const Pose& pose) const {
    mat4 toWorld = glm::mat4_cast(pose.rotation);
    toWorld[3] = vec4(pose.position, 1.0F);
    return cellsFromWorld(toWorld);
}

WetSurface WetSurface::of(const Solids& solids, float spacing) {
    WetSurface made;
    // Half a spacing, because wetness depends on the distance to particles. Points of neighbouring voxels must lie in neighbouring cells.
    const float cell = 0.5F * spacing;
    const auto addField = [&](const VoxelField* field, const SolidRef& ref) {
        if (field != nullptr && !field->empty()) add(made, ref, shellOf(*field), std::max(cell, 1.01F * field->surface.voxel));
    };
    addField(solids.field, {ProbeOn::still, 0});
    for (size_t k = 0; k < solids.rigid.size(); ++k) addField(solids.rigid[k].field, {ProbeOn::rigid, static_cast<uint32_t>(k)});
    for (size_t k = 0; k < solids.bodies.size(); ++k)
        if (solids.bodies[k].shape.shell)
            add(made, {ProbeOn::body, static_cast<uint32_t>(k)}, solids.bodies[k].shape.shell(0.4F * cell), cell);
    return made;
}

const WetSolid* WetSurface::find(const SolidRef& ref) const {
    const auto found = std::ranges::find_if(
        solids, [&](const WetSolid& s) { return s.solid.on == ref.on && (ref.on == ProbeOn::still || s.solid.index == ref.index); });
    return found == solids.end() ? nullptr : &*found;
}

float WetSurface::at(std::span<const float> wetness, size_t solid, const vec3& place) const {
    const WetSolid& s = solids[solid];
    return wetAt(cells.data(), wetness.data(), (place - s.corner) / s.cell, s.size.x, s.size.y, s.size.z, s.firstCell);
}

}  // namespace rivulet
