#include "fluid/voxel/voxelize_solid.h"

#include <oneapi/tbb/task_arena.h>

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
    std::vector<Corners> triangles;
    std::optional<BoundaryCaps> caps;  // of an open mesh
};

Closed closeMesh(const CleanMesh& mesh, const VoxelGrid& grid) {
    std::vector<dvec3> places(mesh.positions.size());
    for (size_t k = 0; k < places.size(); ++k)
        places[k] = (dvec3(mesh.positions[k]) - dvec3(grid.origin)) / static_cast<double>(grid.voxel);
    Closed closed;
    if (!mesh.unmatched.empty()) closed.caps.emplace(mesh, places);
    closed.triangles.reserve(mesh.source.size() + (closed.caps ? closed.caps->triangles().size() : 0));
    for (size_t t = 0; t < mesh.source.size(); ++t)
        closed.triangles.push_back({places[mesh.indices[3 * t]], places[mesh.indices[3 * t + 1]], places[mesh.indices[3 * t + 2]]});
    if (closed.caps) closed.triangles.insert(closed.triangles.end(), closed.caps->triangles().begin(), closed.caps->triangles().end());
    return closed;
}

void clear(VoxelGrid& grid) { grid.bits.assign((grid.count() + 31) / 32 * 4, 0); }

}  // namespace

void voxelizeSolid(const CleanMesh& mesh, VoxelGrid& inside) {
    clear(inside);
    const Closed closed = closeMesh(mesh, inside);
    const ColumnCrossings crossings = crossColumns(closed.triangles, inside);
    if (closed.caps) closed.caps->correct(mesh, crossings, inside);
}

Status voxelizeSolid(Device& device, const CleanMesh& mesh, VoxelGrid& inside) {
    try {
        if (device.backend() == Backend::cpu) {
            tbb::task_arena(static_cast<CpuDevice&>(device).threads()).execute([&] { voxelizeSolid(mesh, inside); });
            return ok();
        }
        if (inside.count() > std::numeric_limits<uint32_t>::max()) {  // kernels count voxels in 32 bits
            voxelizeSolid(mesh, inside);
            return ok();
        }
        clear(inside);
        const Closed closed = closeMesh(mesh, inside);
        const Result<ColumnCrossings> crossings = crossColumnsOn(device, closed.triangles, inside, closed.caps.has_value());
        if (!crossings) return crossings.error();
        if (closed.caps) closed.caps->correct(mesh, *crossings, inside);
        return ok();
    } catch (const std::bad_alloc&) {
        return failed("Not enough memory for solid voxels; lower the resolution.");
    }
}

}  // namespace rivulet
