// The static field: checks what it is given, lays the grid out, bakes bits and band.
#include "fluid/voxel/voxel_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <optional>

#include "fluid/voxel/distance_band.h"
#include "fluid/voxel/voxelize_surface.h"

namespace rivulet {
namespace {

constexpr int kMinResolution = 2, kMaxResolution = 2048;

// "mesh 2 of 3" where there are several.
std::string which(size_t mesh, size_t count) { return count == 1 ? "The mesh" : fmt::format("Mesh {} of {}", mesh + 1, count); }

std::optional<Error> checkMesh(const MeshView& mesh, const std::string& name) {
    if (mesh.indices.size() % 3 != 0)
        return badInput(fmt::format("{} has {} indices, which is not three for each triangle; triangulate it.", name, mesh.indices.size()));
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

std::optional<Error> checkSurfaces(size_t meshes, std::span<const uint8_t> surfaces) {
    if (!surfaces.empty() && surfaces.size() != meshes)
        return badInput(
            fmt::format("A voxel field was given {} surfaces for {} meshes; give one a mesh, or none.", surfaces.size(), meshes));
    const auto wrong = std::find_if(surfaces.begin(), surfaces.end(), [](uint8_t s) { return s > kMaxSurface; });
    if (wrong != surfaces.end())
        return badInput(fmt::format("Surface {} of mesh {} is above {}: a voxel field tells {} surfaces apart; let meshes share one.",
                                    *wrong, wrong - surfaces.begin() + 1, kMaxSurface, kMaxSurface + 1));
    return std::nullopt;
}

// Where the triangles are (or are said to be), and how long the longest side is (m).
struct Extent {
    Bounds bounds;
    double longest = 0;
    size_t extra = 0;  // bytes a point
};

Extent extentOf(std::span<const MeshView> meshes, const Bounds* reach, size_t extra) {
    Extent e;
    e.extra = extra;
    if (reach != nullptr) e.bounds = *reach;
    for (size_t m = 0; m < meshes.size() && reach == nullptr; ++m) {
        for (uint32_t index : meshes[m].indices) e.bounds.add(meshes[m].positions[index]);
    }
    const dvec3 size = dvec3(e.bounds.max) - dvec3(e.bounds.min);
    e.longest = std::max(size.x, std::max(size.y, size.z));
    return e;
}

struct Layout {
    float voxel = 0, band = 0;
    dvec3 voxels{0.0};  // along each axis; may be absurdly many
    double bytes = 0;
};

Layout layoutFor(const Extent& extent, const VoxelFieldOptions& options, int resolution) {
    Layout l;
    l.voxel = static_cast<float>(extent.longest / resolution);
    l.band = std::max(options.band, kBandVoxels * l.voxel);
    const double padding = std::max(options.padding, l.band);
    const dvec3 size = dvec3(extent.bounds.max) - dvec3(extent.bounds.min);
    // One more than needed, so that half a voxel is left on each side for rounding, and faces of boxes lie amid voxels, not between.
    l.voxels = glm::ceil((size + 2.0 * padding) / static_cast<double>(l.voxel)) + 1.0;
    const dvec3 points = l.voxels + 1.0;
    l.bytes = points.x * points.y * points.z * static_cast<double>(sizeof(float) + sizeof(uint32_t) + extent.extra) +
              l.voxels.x * l.voxels.y * l.voxels.z / 8.0;
    return l;
}

std::string readableBytes(double bytes) {
    return bytes < 1e9 ? fmt::format("{:.1f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
}

Error tooMuchMemory(const Extent& extent, const VoxelFieldOptions& options, double needed, double limit) {
    int fits = options.resolution;
    while (fits >= kMinResolution && layoutFor(extent, options, fits).bytes > limit) --fits;
    const std::string remedy = fits >= kMinResolution
                                   ? fmt::format("a resolution of {} fits", fits)
                                   : fmt::format("the band of {} m and padding of {} m are too wide for meshes {} m long", options.band,
                                                 options.padding, extent.longest);
    return badInput(fmt::format("A voxel field of resolution {} needs {}, more than the {} allowed; {}.", options.resolution,
                                readableBytes(needed), readableBytes(limit), remedy));
}

}  // namespace

float VoxelField::clearance(const vec3& p) const {
    const ivec3& size = surface.size;
    const vec3 g = glm::clamp((p - surface.origin) / surface.voxel, vec3(0.0F), vec3(size));
    const ivec3 cell = glm::min(ivec3(g), size - ivec3(1));
    float best = -std::numeric_limits<float>::infinity();
    for (int k = 0; k < 8; ++k) {
        const ivec3 c = cell + ivec3(k & 1, (k >> 1) & 1, k >> 2);
        const auto row = static_cast<size_t>(c.z) * static_cast<size_t>(size.y + 1) + static_cast<size_t>(c.y);
        const float there = distance[row * static_cast<size_t>(size.x + 1) + static_cast<size_t>(c.x)];
        best = std::max(best, there - glm::length(vec3(c) - g) * surface.voxel);
    }
    return best;
}

Result<VoxelField> emptyVoxelField(std::span<const MeshView> meshes, const Bounds* reach, const VoxelFieldOptions& options, size_t extra) {
    if (options.resolution < kMinResolution || options.resolution > kMaxResolution)
        return badInput(fmt::format("A voxel field's resolution is {}..{}, not {}.", kMinResolution, kMaxResolution, options.resolution));
    if (!(options.band >= 0.0F && options.padding >= 0.0F) || !std::isfinite(options.band) || !std::isfinite(options.padding))
        return badInput(fmt::format("A voxel field's band ({}) and padding ({}) must be finite lengths of 0 m or more.", options.band,
                                    options.padding));
    size_t triangles = 0;
    for (size_t m = 0; m < meshes.size(); ++m) {
        if (auto error = checkMesh(meshes[m], which(m, meshes.size()))) return *error;
        triangles += meshes[m].triangleCount();
    }
    if (triangles == 0) return badInput("There is no triangle to voxelise; the mesh is empty or holds only points and lines.");
    if (triangles > std::numeric_limits<uint32_t>::max())
        return badInput(fmt::format("{} triangles are more than a voxel field can take.", triangles));

    if (auto error = checkSurfaces(meshes.size(), options.surfaces)) return *error;

    const Extent extent = extentOf(meshes, reach, extra);
    const dvec3 furthest = glm::max(glm::abs(dvec3(extent.bounds.min)), glm::abs(dvec3(extent.bounds.max)));
    const double away = std::max(furthest.x, std::max(furthest.y, furthest.z));
    const Layout layout = layoutFor(extent, options, options.resolution);
    if (!(extent.longest > 0.0)) return badInput("All triangles lie in one point: the mesh has no extent; check its scale.");
    // A float near `away` is exact to 2^-24 of it; a voxel must span several of those steps.
    if (!(layout.voxel > 16.0 * away / 16777216.0) || !std::isnormal(layout.voxel))
        return badInput(
            fmt::format("Voxels of {:.3g} m cannot be told apart {:.3g} m from the origin in 32-bit floats; "
                        "move the mesh nearer to the origin, scale it or lower the resolution.",
                        layout.voxel, away));
    // Kernels count voxels and points in 32 bits.
    const double limit = std::min(static_cast<double>(options.memoryLimit), 4294967295.0 * sizeof(float));
    if (!(layout.bytes <= limit)) return tooMuchMemory(extent, options, layout.bytes, limit);

    try {
        VoxelField field;
        VoxelGrid& grid = field.surface;
        grid.size = ivec3(layout.voxels);
        grid.voxel = layout.voxel;
        grid.origin =
            vec3(0.5 * (dvec3(extent.bounds.min) + dvec3(extent.bounds.max)) - 0.5 * layout.voxels * static_cast<double>(layout.voxel));
        grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
        field.band = layout.band;
        const auto points =
            (static_cast<size_t>(grid.size.x) + 1) * (static_cast<size_t>(grid.size.y) + 1) * (static_cast<size_t>(grid.size.z) + 1);
        field.distance.assign(points, field.band);
        field.normal.assign(points, 0);
        return field;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("Not enough memory for a voxel field of resolution {}, which needs {}; lower the resolution.",
                                  options.resolution, readableBytes(layout.bytes)));
    }
}

Result<VoxelField> bakeVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options) {
    Result<VoxelField> field = emptyVoxelField(meshes, nullptr, options, 0);
    if (!field) return field;
    try {
        const GridTriangles list(meshes, field->surface);
        voxelizeSurface(list, field->surface);
        DistanceBand(field->surface, field->band).bake(list, options.surfaces, {}, {}, {}, {field->distance, field->normal, {}});
        return field;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("Not enough memory to bake a voxel field of resolution {}; lower the resolution.", options.resolution));
    }
}

FieldParams fieldParams(const VoxelField& field, const FieldContact& contact) {
    const VoxelGrid& grid = field.surface;
    ASSERT(!field.empty(), "bake a field before asking for its parameters");
    FieldParams p{};
    p.origin = vec4(grid.origin, 1.0F / grid.voxel);
    p.sizeX = grid.size.x;
    p.sizeY = grid.size.y;
    p.sizeZ = grid.size.z;
    p.countIndex = contact.countIndex;
    p.voxel = grid.voxel;
    p.band = field.band;
    p.contact = std::max(0.5F * contact.spacing, kContactVoxels * grid.voxel);
    ASSERT(p.contact < field.band, "bake the field with a band wider than half a spacing");
    p.friction = contact.friction;
    p.restitution = contact.restitution;
    p.restSpeed = contact.restSpeed;
    p.nudge = 1e-4F + 1e-6F * static_cast<float>(grid.size.x + grid.size.y + grid.size.z);
    return p;
}

}  // namespace rivulet
