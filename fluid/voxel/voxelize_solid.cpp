#include "fluid/voxel/voxelize_solid.h"

#include <limits>
#include <new>
#include <optional>

#include "engine/compute/device_cpu.h"
#include "fluid/voxel/crossings.h"
#include "fluid/voxel/winding.h"

namespace rivulet {
namespace {

// The mesh in the grid's coordinates, with caps over its holes.
struct Closed {
    std::vector<dvec3> places;
    std::optional<BoundaryCaps> caps;  // of an open mesh
    CrossedTriangles triangles;

    Closed(const CleanMesh& mesh, const VoxelGrid& grid) : places(mesh.positions.size()) {
        for (size_t k = 0; k < places.size(); ++k)
            places[k] = (dvec3(mesh.positions[k]) - dvec3(grid.origin)) / static_cast<double>(grid.voxel);
        triangles = {places, mesh.indices, {}};
        if (mesh.unmatched.empty()) return;
        caps.emplace(mesh, places);
        triangles.loose = caps->triangles();
        if (caps->crossed() != nullptr) triangles.indices = *caps->crossed();
    }
    Closed(const Closed&) = delete;
    Closed& operator=(const Closed&) = delete;
};

void clear(VoxelGrid& grid) { grid.bits.assign((grid.count() + 31) / 32 * 4, 0); }

}  // namespace

bool voxelizeSolid(const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress) {
    clear(inside);
    const Closed closed(mesh, inside);
    const ColumnCrossings crossings = crossColumns(closed.triangles, inside);
    return !closed.caps || closed.caps->correct(mesh, crossings, inside, progress);
}

Status voxelizeSolid(Device& device, const CleanMesh& mesh, VoxelGrid& inside, const std::function<bool(double)>& progress) {
    const auto told = [](bool done) { return done ? ok() : failed("Voxelising was cancelled."); };
    try {
        if (device.backend() == Backend::cpu) {
            const JobsScope scope(static_cast<CpuDevice&>(device).jobs());
            return told(voxelizeSolid(mesh, inside, progress));
        }
        if (inside.count() > std::numeric_limits<uint32_t>::max())  // kernels count voxels in 32 bits
            return told(voxelizeSolid(mesh, inside, progress));
        clear(inside);
        const Closed closed(mesh, inside);
        const Result<ColumnCrossings> crossings = crossColumnsOn(device, closed.triangles, inside, closed.caps.has_value());
        if (!crossings) return crossings.error();
        return told(!closed.caps || closed.caps->correct(mesh, *crossings, inside, progress));
    } catch (const std::bad_alloc&) {
        return failed("Not enough memory for solid voxels; lower the resolution.");
    }
}

}  // namespace rivulet
