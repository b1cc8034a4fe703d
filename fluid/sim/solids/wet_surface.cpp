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

std::vector<WetSurface::Part> WetSurface::partsOf(const Solids& solids) {
    std::vector<Part> parts;
    parts.reserve(1 + solids.rigid.size() + solids.bodies.size());
    if (solids.field != nullptr && !solids.field->empty()) parts.push_back({.solid = {ProbeOn::still, 0}, .field = solids.field});
    for (size_t k = 0; k < solids.rigid.size(); ++k)
        if (const VoxelField* field = solids.rigid[k].field; field != nullptr && !field->empty())
            parts.push_back({.solid = {ProbeOn::rigid, static_cast<uint32_t>(k)}, .field = field});
    for (size_t k = 0; k < solids.bodies.size(); ++k) addBody(parts, solids.bodies[k], static_cast<uint32_t>(k));
    return parts;
}

void WetSurface::addBody(std::vector<Part>& parts, const Body& body, uint32_t id) {
    const auto index = static_cast<uint32_t>(std::ranges::count_if(parts, [](const Part& p) { return p.solid.on == ProbeOn::body; }));
    parts.push_back({.solid = {ProbeOn::body, index}, .shape = body.meetsWater ? &body.shape : nullptr, .body = id});
}

WetSurface WetSurface::of(std::span<const Part> parts, float spacing, const WetSurface* before) {
    WetSurface made;
    // Half a spacing, because wetness depends on the distance to particles. Points of neighbouring voxels must lie in neighbouring cells.
    const float cell = 0.5F * spacing;
    for (const Part& part : parts) {
        const size_t count = made.solids.size();
        WetSolid known{.solid = part.solid, .field = part.field, .body = part.body};
        if (const WetSolid* old = before != nullptr ? before->same(known) : nullptr) {
            WetSolid s = *old;
            s.solid = part.solid;
            s.firstCell = static_cast<uint32_t>(made.cells.size());
            s.firstPoint = static_cast<uint32_t>(made.points.size());
            const auto cells = static_cast<size_t>(s.size.x) * static_cast<size_t>(s.size.y) * static_cast<size_t>(s.size.z);
            made.cells.reserve(made.cells.size() + cells);
            for (const int32_t point : std::span(before->cells).subspan(old->firstCell, cells))
                made.cells.push_back(point < 0 ? -1 : point - static_cast<int32_t>(old->firstPoint) + static_cast<int32_t>(s.firstPoint));
            const std::span<const Point> points = std::span(before->points).subspan(old->firstPoint, old->points);
            made.points.insert(made.points.end(), points.begin(), points.end());
            made.solids.push_back(s);
            continue;
        }
        if (part.field != nullptr)
            add(made, part.solid, shellOf(*part.field), std::max(cell, 1.01F * part.field->surface.voxel));
        else if (part.shape != nullptr && part.shape->shell)
            add(made, part.solid, part.shape->shell(0.4F * cell), cell);
        if (made.solids.size() > count) {
            made.solids.back().field = part.field;
            made.solids.back().body = part.body;
        }
    }
    return made;
}

const WetSolid* WetSurface::same(const WetSolid& solid) const {
    const auto found = std::ranges::find_if(
        solids, [&](const WetSolid& s) { return s.solid.on == solid.solid.on && s.field == solid.field && s.body == solid.body; });
    return found == solids.end() ? nullptr : &*found;
}

std::vector<float> WetSurface::valuesFrom(const WetSurface& before, std::span<const float> wetness) const {
    std::vector<float> values(points.size());
    const WetSolid* still = before.find({ProbeOn::still, 0});
    for (const WetSolid& s : solids) {
        const auto to = values.begin() + s.firstPoint;
        if (const WetSolid* old = before.same(s); old != nullptr && old->points == s.points) {
            std::copy_n(wetness.begin() + old->firstPoint, s.points, to);
        } else if (s.solid.on == ProbeOn::still && still != nullptr) {
            const auto index = static_cast<size_t>(still - before.solids.data());
            for (uint32_t k = 0; k < s.points; ++k) to[k] = before.at(wetness, index, vec3(points[s.firstPoint + k].place));
        }
    }
    return values;
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
