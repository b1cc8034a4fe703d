// The static field: checks its input, lays out the grid, bakes bits and band.
#include "fluid/voxel/voxel_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <optional>

#include "engine/core/assert.h"
#include "engine/core/parallel.h"
#include "engine/core/readable_bytes.h"
#include "fluid/voxel/distance_band.h"
#include "fluid/voxel/field_bake.h"
#include "fluid/voxel/mesh_check.h"
#include "fluid/voxel/mesh_defects.h"
#include "fluid/voxel/voxelize_solid.h"
#include "fluid/voxel/voxelize_surface.h"

namespace rivulet {
namespace {

constexpr int kMinResolution = 2, kMaxResolution = 2048;

std::optional<Error> checkSurfaces(size_t meshes, std::span<const uint8_t> surfaces) {
    if (!surfaces.empty() && surfaces.size() != meshes)
        return badInput(
            fmt::format("A voxel field was given {} surfaces for {} meshes; give one per mesh, or none.", surfaces.size(), meshes));
    const auto wrong = std::find_if(surfaces.begin(), surfaces.end(), [](uint8_t s) { return s > kMaxSurface; });
    if (wrong != surfaces.end())
        return badInput(fmt::format("Surface {} of mesh {} is above {}: a voxel field has {} surfaces; let meshes share one.", *wrong,
                                    wrong - surfaces.begin() + 1, kMaxSurface, kMaxSurface + 1));
    return std::nullopt;
}

// The place of the grid.
struct Place {
    MeshExtent extent;
    size_t pointBytes = sizeof(float) + sizeof(uint32_t);  // per grid point
};

struct FieldLayout {
    float voxel = 0, band = 0;
    dvec3 voxels{0.0};  // along each axis; may be very large
    double bytes = 0;
};

FieldLayout fieldLayoutFor(const Place& place, const VoxelFieldOptions& options, int resolution) {
    const MeshExtent& extent = place.extent;
    FieldLayout l;
    l.voxel = static_cast<float>(extent.longest / resolution);
    l.band = std::max(options.band, kBandVoxels * l.voxel);
    const double padding = std::max(options.padding, l.band);
    const dvec3 size = dvec3(extent.bounds.max) - dvec3(extent.bounds.min);
    // One more than needed: half a voxel remains on each side for rounding, and faces of boxes lie at centres of voxels, not between
    // voxels.
    l.voxels = glm::ceil((size + 2.0 * padding) / static_cast<double>(l.voxel)) + 1.0;
    const dvec3 points = l.voxels + 1.0;
    l.bytes = points.x * points.y * points.z * static_cast<double>(place.pointBytes) + l.voxels.x * l.voxels.y * l.voxels.z / 8.0;
    return l;
}

Error tooMuchMemory(const Place& place, const VoxelFieldOptions& options, double needed, double limit) {
    int fits = options.resolution;
    while (fits >= kMinResolution && fieldLayoutFor(place, options, fits).bytes > limit) --fits;
    const std::string remedy = fits >= kMinResolution ? fmt::format("a resolution of {} fits", fits)
                                                      : fmt::format("the band of {} m and padding of {} m are too wide for meshes of {} m",
                                                                    options.band, options.padding, place.extent.longest);
    return badInput(fmt::format("A voxel field of resolution {} needs {}, more than the {} allowed; {}.", options.resolution,
                                readableBytes(needed), readableBytes(limit), remedy));
}

// If all meshes are watertight, makes distances inside negative.
void signInside(std::span<const MeshView> meshes, VoxelField& field) {
    std::vector<CleanMesh> cleaned;
    for (const MeshView& mesh : meshes) {
        if (mesh.triangleCount() == 0) continue;
        cleaned.push_back(cleanMesh(std::span(&mesh, 1)));
        if (!cleaned.back().defects.watertight) return;
    }
    // Voxels centred at the grid points: shifted by half a voxel, one more along each axis.
    VoxelGrid inside;
    inside.size = field.surface.size + 1;
    inside.voxel = field.surface.voxel;
    inside.origin = field.surface.origin - 0.5F * field.surface.voxel;
    for (const CleanMesh& mesh : cleaned) {
        voxelizeSolid(mesh, inside);
        parallelParts(field.distance.size(), 65536, [&](size_t begin, size_t end) {
            for (size_t k = begin; k != end; ++k) {
                if (((inside.bits[k >> 3U] >> (k & 7U)) & 1U) != 0) field.distance[k] = -std::abs(field.distance[k]);
            }
        });
    }
    field.closed = true;
}

}  // namespace

float VoxelField::clearance(const vec3& p) const {
    const ivec3& size = surface.size;
    const vec3 g = glm::clamp((p - surface.origin) / surface.voxel, vec3(0.0F), vec3(size));
    const ivec3 cell = glm::min(ivec3(g), size - ivec3(1));
    // Of the distances: a lower bound; the trilinear interpolant, exact beside one wall, too small between walls that face each other, at
    // most a little too large around an outer edge; the nearest of the walls that the grid points see, each extended as a plane, exact
    // between walls and too small around an edge.
    float bound = -std::numeric_limits<float>::infinity(), mean = 0, planes = band;
    for (int k = 0; k < 8; ++k) {
        const ivec3 step(k & 1, (k >> 1) & 1, k >> 2), c = cell + step;
        const auto row = static_cast<size_t>(c.z) * static_cast<size_t>(size.y + 1) + static_cast<size_t>(c.y);
        const size_t at = row * static_cast<size_t>(size.x + 1) + static_cast<size_t>(c.x);
        const float there = std::abs(distance[at]);
        const vec3 way = (g - vec3(c)) * surface.voxel, near = vec3(1.0F) - glm::abs(g - vec3(c));
        bound = std::max(bound, there - glm::length(way));
        mean += near.x * near.y * near.z * there;
        if (there < band) planes = std::min(planes, there + glm::dot(unpackNormal(normal[at]), way));
    }
    const ivec3 voxel = surface.cellOf(p);
    return surface.contains(voxel) && surface.test(voxel) ? bound : std::max({bound, mean, planes});
}

bool VoxelField::inside(const vec3& p) const {
    const vec3 g = glm::floor((p - surface.origin) / surface.voxel + 0.5F);
    if (!closed || glm::any(glm::lessThan(g, vec3(0.0F))) || glm::any(glm::greaterThan(g, vec3(surface.size)))) return false;
    const ivec3 c(g);
    const auto row = static_cast<size_t>(c.z) * static_cast<size_t>(surface.size.y + 1) + static_cast<size_t>(c.y);
    return distance[row * static_cast<size_t>(surface.size.x + 1) + static_cast<size_t>(c.x)] < 0;
}

namespace {

struct Plan {
    MeshExtent extent;
    FieldLayout layout;
};

// The checks of a bake.
Result<Plan> planOf(std::span<const MeshView> meshes, const Bounds* reach, const VoxelFieldOptions& options, size_t extra) {
    if (options.resolution < kMinResolution || options.resolution > kMaxResolution)
        return badInput(
            fmt::format("The resolution of a voxel field must be {}..{}, not {}.", kMinResolution, kMaxResolution, options.resolution));
    if (!(options.band >= 0.0F && options.padding >= 0.0F) || !std::isfinite(options.band) || !std::isfinite(options.padding))
        return badInput(fmt::format("The band ({}) and the padding ({}) of a voxel field must be finite and at least 0 m.", options.band,
                                    options.padding));
    if (auto error = checkMeshes(meshes)) return *error;

    if (auto error = checkSurfaces(meshes.size(), options.surfaces)) return *error;

    Place place;
    MeshExtent& extent = place.extent;
    if (reach == nullptr) {
        extent = extentOf(meshes);
    } else {
        const dvec3 size = dvec3(reach->max) - dvec3(reach->min);
        extent = {*reach, std::max(size.x, std::max(size.y, size.z))};
    }
    place.pointBytes += extra;
    const FieldLayout layout = fieldLayoutFor(place, options, options.resolution);
    if (auto error = checkVoxel(extent, layout.voxel)) return *error;
    // Kernels count voxels and points in 32 bits.
    const double limit = std::min(static_cast<double>(options.memoryLimit), 4294967295.0 * sizeof(float));
    if (!(layout.bytes <= limit)) return tooMuchMemory(place, options, layout.bytes, limit);
    return Plan{extent, layout};
}

}  // namespace

Status checkVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options) {
    const Result<Plan> plan = planOf(meshes, nullptr, options, 0);
    return plan ? ok() : Status(plan.error());
}

Result<VoxelField> emptyVoxelField(std::span<const MeshView> meshes, const Bounds* reach, const VoxelFieldOptions& options, size_t extra) {
    const Result<Plan> plan = planOf(meshes, reach, options, extra);
    if (!plan) return plan.error();
    const auto& [extent, layout] = *plan;
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
        signInside(meshes, *field);
        return field;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("Not enough memory to bake a voxel field of resolution {}; lower the resolution.", options.resolution));
    }
}

FieldParams fieldParams(const VoxelField& field, const FieldContact& contact) {
    const VoxelGrid& grid = field.surface;
    ASSERT(!field.empty(), "bake a field before its parameters are read");
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
    p.restSpeed = contact.restSpeed;
    p.surfacesAt = static_cast<uint32_t>(field.normal.size());
    p.nudge = 1e-4F + 1e-6F * static_cast<float>(grid.size.x + grid.size.y + grid.size.z);
    return p;
}

}  // namespace rivulet
