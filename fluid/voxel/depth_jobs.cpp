// Projects triangles along the axes, and draws them by scan lines.
#include "fluid/voxel/depth_jobs.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "engine/core/parallel.h"

namespace rivulet {
namespace {

constexpr size_t kTriangles = 4096;  // per task
constexpr double kEdgeError = 1e-6;  // voxels: error of an edge; a column that one triangle leaves out its neighbour must include
constexpr int kMostPixels = 4096;    // of a job's bounds; some shader loops are limited to 65,535

struct Corner {
    double u = 0, v = 0, depth = 0;
};

// du / dv; 0 if no row can lie between, to avoid infinity.
double slopeOf(const Corner& from, const Corner& to) {
    const double slope = (to.u - from.u) / (to.v - from.v);
    return std::isfinite(slope) ? slope : 0.0;
}

void addJobs(const std::array<dvec3, 3>& triangle, int axis, const ivec3& size, std::vector<DepthJob>& jobs) {
    const int u = axisU(axis), v = axisV(axis);
    std::array<Corner, 3> c;
    for (size_t k = 0; k < 3; ++k) c[k] = {triangle[k][u], triangle[k][v], triangle[k][axis]};
    const auto [lowU, highU] = std::minmax({c[0].u, c[1].u, c[2].u});
    const int columns = firstAfter(highU + kEdgeError) - firstAfter(lowU - kEdgeError);
    if (columns == 0) return;
    std::sort(c.begin(), c.end(), [](const Corner& a, const Corner& b) { return a.v != b.v ? a.v < b.v : a.u < b.u; });
    const int first = std::max(0, firstAtOrAfter(c[0].v)), end = std::min(size[v], firstAtOrAfter(c[2].v));
    if (first >= end) return;

    DepthJob job{};
    job.axis = axis;
    job.lowU = c[0].u;
    job.lowV = c[0].v;
    job.middleU = c[1].u;
    job.middleV = c[1].v;
    job.middleRow = firstAtOrAfter(c[1].v);
    job.slopeLow = slopeOf(c[0], c[1]);
    job.slopeHigh = slopeOf(c[1], c[2]);
    job.slopeLong = slopeOf(c[0], c[2]);
    const auto [near, far] = std::minmax({c[0].depth, c[1].depth, c[2].depth});
    job.nearest = std::clamp(floorOf(near), 0, size[axis] - 1);
    job.furthest = std::clamp(floorOf(far), 0, size[axis] - 1);
    // The plane through the corners: two vectors in it, and their cross product.
    const double u1 = c[1].u - c[0].u, v1 = c[1].v - c[0].v, d1 = c[1].depth - c[0].depth;
    const double u2 = c[2].u - c[0].u, v2 = c[2].v - c[0].v, d2 = c[2].depth - c[0].depth;
    const double area = u1 * v2 - u2 * v1;
    job.depth = c[0].depth;
    job.depthU = (d1 * v2 - d2 * v1) / area;
    job.depthV = (d2 * u1 - d1 * u2) / area;
    if (!std::isfinite(job.depthU) || !std::isfinite(job.depthV)) {  // edge-on: along its longest edge in v
        job.depthU = 0.0;
        job.depthV = v2 > 0.0 && std::isfinite(d2 / v2) ? d2 / v2 : 0.0;
    }
    const int rows = std::max(1, kMostPixels / columns);
    for (int row = first; row < end; row += rows) {
        job.firstRow = row;
        job.endRow = std::min(end, row + rows);
        jobs.push_back(job);
    }
}

void atomicMin(uint32_t& word, uint32_t value) {
    const std::atomic_ref<uint32_t> shared(word);
    uint32_t is = shared.load(std::memory_order_relaxed);
    while (value < is && !shared.compare_exchange_weak(is, value, std::memory_order_relaxed)) {
    }
}

void draw(const DepthJob& job, const DepthParams& params, std::span<const DepthBox> boxes, std::span<uint32_t> images) {
    const int axis = job.axis;
    const int columns = axis == 0 ? params.sizeY : params.sizeX;
    for (int row = job.firstRow; row < job.endRow; ++row) {
        const double one = longEdge(job, row), other = shortEdge(job, row);
        const int first = std::max(0, firstAfter(std::min(one, other))), end = std::min(columns, firstAfter(std::max(one, other)));
        for (int column = first; column < end; ++column) {
            const int depth = depthAt(job, column, row);
            const int x = axis == 0 ? depth : column;
            const int y = axis == 0 ? column : axis == 1 ? depth : row;
            const int z = axis == 2 ? depth : row;
            const int slab = pick(params.slabAxis, x, y, z) / params.thickness - params.firstSlab;
            if (slab < 0 || slab >= params.slabs) continue;
            const DepthBox& box = boxes[static_cast<size_t>(slab)];
            if (!boxHolds(box, x, y, z)) continue;
            const uint pixel = pixelOf(box, axis, x, y, z);
            atomicMin(images[pixel], static_cast<uint32_t>(depth - pick(axis, box.lowX, box.lowY, box.lowZ)));
            atomicMin(images[pixel + 1], static_cast<uint32_t>(pick(axis, box.highX, box.highY, box.highZ) - depth));
        }
    }
}

}  // namespace

std::vector<DepthJob> depthJobs(std::span<const MeshView> meshes, const VoxelGrid& grid) {
    struct Piece {
        const MeshView* mesh;
        size_t first, end;
        std::vector<DepthJob> jobs;
    };
    std::vector<Piece> pieces;
    for (const MeshView& mesh : meshes) {
        for (size_t k = 0; k < mesh.triangleCount(); k += kTriangles)
            pieces.push_back({&mesh, k, std::min(mesh.triangleCount(), k + kTriangles), {}});
    }
    const dvec3 origin(grid.origin);
    const auto voxel = static_cast<double>(grid.voxel);
    parallelFor(size_t{0}, pieces.size(), [&](size_t p) {
        Piece& piece = pieces[p];
        for (size_t k = piece.first; k < piece.end; ++k) {
            std::array<dvec3, 3> triangle;
            for (size_t c = 0; c < 3; ++c) triangle[c] = (dvec3(piece.mesh->positions[piece.mesh->indices[3 * k + c]]) - origin) / voxel;
            for (int axis = 0; axis < 3; ++axis) addJobs(triangle, axis, grid.size, piece.jobs);
        }
    });
    size_t total = 0;
    for (const Piece& piece : pieces) total += piece.jobs.size();
    std::vector<DepthJob> jobs;
    jobs.reserve(total);
    for (Piece& piece : pieces) {
        jobs.insert(jobs.end(), piece.jobs.begin(), piece.jobs.end());
        piece.jobs = {};
    }
    return jobs;
}

void drawDepthJobs(std::span<const DepthJob> jobs, const DepthParams& params, std::span<const DepthBox> boxes, std::span<uint32_t> images) {
    parallelParts(jobs.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t k = begin; k != end; ++k) draw(jobs[k], params, boxes, images);
    });
}

}  // namespace rivulet
