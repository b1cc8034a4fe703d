// Checks the input, lays out the grid, and runs the mode.
#include "fluid/voxel/voxelize.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <new>

#include "engine/core/readable_bytes.h"
#include "fluid/voxel/mesh_check.h"
#include "fluid/voxel/voxelize_depth.h"
#include "fluid/voxel/voxelize_solid.h"
#include "fluid/voxel/voxelize_surface.h"

namespace rivulet {
namespace {

constexpr std::array<VoxelModeRow, 3> kModes{{
    {"depth", "the thesis's depth images: surface voxels where lines of sight end, connected regions as materials; for any mesh",
     VoxelMode::depth},
    {"solid", "inside by winding number, also of open meshes, and every voxel that a triangle touches", VoxelMode::solid},
    {"surface", "only voxels that a triangle touches", VoxelMode::surface},
}};

constexpr const char* kCancelled = "Voxelising was cancelled.";

struct GridLayout {
    float voxel = 0;
    dvec3 voxels{0.0};  // along each axis; may be very large
};

GridLayout gridLayoutFor(const MeshExtent& extent, double resolution) {
    GridLayout l;
    l.voxel = static_cast<float>(extent.longest / resolution);
    // Rounded up: otherwise the far side would be outside.
    while (static_cast<double>(l.voxel) * resolution < extent.longest) l.voxel = std::nextafter(l.voxel, std::numeric_limits<float>::max());
    const dvec3 size = dvec3(extent.bounds.max) - dvec3(extent.bounds.min);
    const auto voxel = static_cast<double>(l.voxel);
    for (int k = 0; k < 3; ++k) {
        l.voxels[k] = std::max(1.0, std::ceil(size[k] / voxel));
        if (l.voxels[k] * voxel < size[k]) l.voxels[k] += 1.0;
        if (size[k] == extent.longest) l.voxels[k] = resolution;
    }
    return l;
}

double bitsBytes(const dvec3& voxels) { return voxels.x * voxels.y * voxels.z / 8.0; }

// An estimate for labels: meshes cut rows into few runs.
double modelBytes(VoxelMode mode, const dvec3& voxels) {
    const double labels = voxels.y * voxels.z * 64.0;
    const double grids = mode == VoxelMode::solid ? 3.0 : 2.0;
    return grids * bitsBytes(voxels) + labels + (mode == VoxelMode::depth ? depthBytes(voxels) : 0.0);
}

// `bytesOf`: bytes of a grid with this number of voxels along each axis.
template <class BytesOf>
Result<VoxelGrid> layoutWithin(std::span<const MeshView> meshes, int resolution, size_t memoryLimit, const BytesOf& bytesOf) {
    if (auto error = checkMeshes(meshes)) return *error;
    const MeshExtent extent = extentOf(meshes);
    const auto limit = static_cast<double>(memoryLimit);
    const auto needed = [&](int n) { return bytesOf(gridLayoutFor(extent, n).voxels); };
    const auto fitting = [&] {
        int fits = std::min(resolution, kMaxVoxelResolution);
        while (fits >= kMinVoxelResolution && needed(fits) > limit) --fits;
        return fits >= kMinVoxelResolution ? fmt::format("a resolution of {} fits the {} allowed", fits, readableBytes(limit))
                                           : fmt::format("no resolution fits the {} allowed", readableBytes(limit));
    };
    if (extent.longest > 0.0 && resolution > kMaxVoxelResolution)
        return badInput(fmt::format("The resolution must be {}..{} voxels along the longest side, not {}, which would need {}; {}.",
                                    kMinVoxelResolution, kMaxVoxelResolution, resolution, readableBytes(needed(resolution)), fitting()));
    if (resolution < kMinVoxelResolution || resolution > kMaxVoxelResolution)
        return badInput(fmt::format("The resolution must be {}..{} voxels along the longest side, not {}.", kMinVoxelResolution,
                                    kMaxVoxelResolution, resolution));
    const GridLayout layout = extent.longest > 0.0 ? gridLayoutFor(extent, resolution) : GridLayout{};
    if (auto error = checkVoxel(extent, layout.voxel)) return *error;
    if (needed(resolution) > limit)
        return badInput(fmt::format("A resolution of {} needs {}; {}.", resolution, readableBytes(needed(resolution)), fitting()));

    VoxelGrid grid;
    grid.size = ivec3(layout.voxels);
    grid.voxel = layout.voxel;
    const dvec3 low(extent.bounds.min), high(extent.bounds.max);
    const dvec3 side = layout.voxels * static_cast<double>(layout.voxel);
    // The low corner is itself a float, so the float nearest to half the spare room below it is that corner, or below it by at most all
    // that room.
    grid.origin = vec3(0.5 * (low + high) - 0.5 * side);
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    return grid;
}

Error outOfMemory(int resolution) {
    return failed(fmt::format("Not enough memory to voxelise at a resolution of {}; lower it.", resolution));
}

double millisecondsSince(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Status voxelizeInto(VoxelModel& model, Device& device, std::span<const MeshView> meshes, const VoxelizeOptions& options) {
    const auto goOn = [&](double done) { return !options.progress || options.progress(done); };
    if (!goOn(0.0)) return failed(kCancelled);
    const auto start = std::chrono::steady_clock::now();
    if (options.mode == VoxelMode::depth) {
        DepthOptions depth{options.thesisOrder, {}};
        if (options.progress) depth.progress = [&](double done) { return options.progress(0.9 * done); };
        Result<DepthVoxels> made = voxelizeDepth(device, meshes, model.surface, depth);
        if (!made) return made.error();
        model.surface = std::move(made->surface);
        model.labels = std::move(made->labels);
        model.bits = solidBits(model.labels, model.surface);
        model.milliseconds = millisecondsSince(start);
        if (!goOn(0.9)) return failed(kCancelled);
        model.defects = cleanMesh(meshes).defects;
        return ok();
    }
    if (Status status = voxelizeSurface(device, GridTriangles(meshes, model.surface), model.surface); !status) return status;
    if (options.mode == VoxelMode::surface) {
        model.milliseconds = millisecondsSince(start);
        if (!goOn(0.4)) return failed(kCancelled);
        model.bits = model.surface;
        model.labels = labelRegions(model.surface, nullptr);
        if (!goOn(0.6)) return failed(kCancelled);
        model.defects = cleanMesh(meshes).defects;
        return ok();
    }
    if (!goOn(0.2)) return failed(kCancelled);
    const CleanMesh clean = cleanMesh(meshes);
    model.defects = clean.defects;
    if (!goOn(0.4)) return failed(kCancelled);
    VoxelGrid inside{model.surface.size, model.surface.origin, model.surface.voxel, {}};
    inside.bits.assign(model.surface.bits.size(), 0);
    std::function<bool(double)> progress;
    if (options.progress) progress = [&](double done) { return options.progress(0.4 + 0.4 * done); };
    if (Status status = voxelizeSolid(device, clean, inside, progress); !status) return status;
    // The two grids of bits from which all else follows; the callers compute labels.
    model.milliseconds = millisecondsSince(start);
    if (!goOn(0.8)) return failed(kCancelled);
    model.labels = labelRegions(model.surface, &inside);
    model.bits = solidBits(model.labels, model.surface);
    return ok();
}

}  // namespace

Table<VoxelModeRow> voxelModes() { return {kModes}; }

Result<VoxelGrid> layoutGrid(std::span<const MeshView> meshes, int resolution, size_t memoryLimit) {
    try {
        return layoutWithin(meshes, resolution, memoryLimit, bitsBytes);
    } catch (const std::bad_alloc&) {
        return outOfMemory(resolution);
    }
}

Result<VoxelModel> voxelizeMesh(Device& device, std::span<const MeshView> meshes, const VoxelizeOptions& options) {
    try {
        Result<VoxelGrid> grid = layoutWithin(meshes, options.resolution, options.memoryLimit,
                                              [&](const dvec3& voxels) { return modelBytes(options.mode, voxels); });
        if (!grid) return grid.error();
        VoxelModel model;
        model.mode = options.mode;
        model.surface = std::move(*grid);
        if (Status status = voxelizeInto(model, device, meshes, options); !status) return status.error();
        if (options.progress && !options.progress(1.0)) return failed(kCancelled);
        return model;
    } catch (const std::bad_alloc&) {
        return outOfMemory(options.resolution);
    }
}

std::string lostFeatures(std::span<const MeshView> meshes, const VoxelGrid& grid) {
    constexpr size_t kMost = 1'000'000;
    constexpr double kFine = 1.0 / 32.0, kVoxelsAcross = 2.0;
    const GridTriangles triangles(meshes, grid);
    const size_t step = 1 + 3 * triangles.size() / kMost;
    std::vector<double> lengths;  // in voxels
    for (size_t k = 0; k < triangles.size(); k += step) {
        const GridTriangle t = triangles[k];
        for (const double length : {glm::length(t.ab), glm::length(t.ac), glm::length(t.ac - t.ab)})
            if (length > 0.0) lengths.push_back(length);
    }
    if (lengths.empty()) return "";
    const auto fifth = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 20);
    std::nth_element(lengths.begin(), fifth, lengths.end());
    if (*fifth >= kFine) return "";
    const auto voxel = static_cast<double>(grid.voxel);
    const MeshExtent extent = extentOf(meshes);
    const double resolution = kVoxelsAcross * extent.longest / (*fifth * voxel);
    return fmt::format(
        "The mesh is {:.3g} wide and has features of {:.3g}: a voxel of {:.4g} cannot show them; they need a resolution of {:.3g} "
        "({}).",
        extent.longest, *fifth * voxel, voxel, resolution, readableBytes(bitsBytes(gridLayoutFor(extent, resolution).voxels)));
}

}  // namespace rivulet
