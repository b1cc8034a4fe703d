// Finds the bricks that a change of places can affect, and the wall's motion at their points.
#include "fluid/voxel/deforming_field.h"

#include <fmt/format.h>

#include <array>
#include <new>

#include "engine/core/parallel.h"
#include "fluid/voxel/distance_band.h"
#include "fluid/voxel/nearest_weights.h"
#include "fluid/voxel/voxelize_surface.h"

namespace rivulet {
namespace {

constexpr int kBrick = DistanceBand::kBrick;

bool within(const Bounds& b, const vec3& p) {
    return p.x >= b.min.x && p.y >= b.min.y && p.z >= b.min.z && p.x <= b.max.x && p.y <= b.max.y && p.z <= b.max.z;  // false for NaN
}

std::string named(const vec3& p) { return fmt::format("({:g}, {:g}, {:g})", p.x, p.y, p.z); }

// Calls body(index of the point, point) for a brick's points; `size` is of the grid in points.
template <class Body>
void forPoints(const ivec3& brick, const ivec3& size, const Body& body) {
    const ivec3 first = brick * kBrick, end = glm::min(first + ivec3(kBrick), size);
    for (int z = first.z; z < end.z; ++z) {
        for (int y = first.y; y < end.y; ++y) {
            size_t at = (static_cast<size_t>(z) * static_cast<size_t>(size.y) + static_cast<size_t>(y)) * static_cast<size_t>(size.x) +
                        static_cast<size_t>(first.x);
            for (int x = first.x; x < end.x; ++x, ++at) body(at, ivec3(x, y, z));
        }
    }
}

// The voxels of a brick.
void clearBits(const ivec3& brick, VoxelGrid& grid) {
    const ivec3 first = brick * kBrick, end = glm::min(first + ivec3(kBrick), grid.size);
    for (int z = first.z; z < end.z; ++z) {
        for (int y = first.y; y < end.y; ++y) {
            for (int x = first.x; x < end.x; ++x) {
                const size_t i = grid.index({x, y, z});
                grid.bits[i >> 3U] = static_cast<uint8_t>(grid.bits[i >> 3U] & ~(1U << (i & 7U)));
            }
        }
    }
}

}  // namespace

Result<DeformingField> DeformingField::create(std::span<const MeshView> restMesh, const Bounds& reach, const VoxelFieldOptions& options) {
    if (restMesh.size() != 1) return badInput(fmt::format("A deforming field takes one mesh, not {}; join them.", restMesh.size()));
    if (reach.empty() || !isFinite(reach.min) || !isFinite(reach.max))
        return badInput(fmt::format("The reach of a deforming mesh is not a box: {} to {}; each minimum must be below its maximum.",
                                    named(reach.min), named(reach.max)));
    try {
        Result<VoxelField> field = emptyVoxelField(restMesh, &reach, options, sizeof(uint32_t) + sizeof(vec4));
        if (!field) return field.error();
        const MeshView& mesh = restMesh.front();
        DeformingField d;
        d.field_ = std::move(*field);
        d.reach_ = reach;
        d.surfaces_.assign(options.surfaces.begin(), options.surfaces.end());
        d.indices_.assign(mesh.indices.begin(), mesh.indices.end());
        d.used_.assign(mesh.positions.size(), 0);
        for (uint32_t index : d.indices_) d.used_[index] = 1;
        if (Status status = d.checkPlaces(mesh.positions); !status) return status.error();
        d.positions_.assign(mesh.positions.begin(), mesh.positions.end());
        d.moved_.assign(mesh.triangleCount(), 0);
        d.nearest_.assign(d.field_.distance.size(), kNoTriangle);
        d.displacement_.assign(d.field_.distance.size(), vec4(0.0F));
        const ivec3 bricks = DistanceBand(d.field_.surface, d.field_.band).bricks();
        for (auto* flags : {&d.occupied_, &d.dirty_, &d.displaced_})
            flags->assign(static_cast<size_t>(bricks.x) * static_cast<size_t>(bricks.y) * static_cast<size_t>(bricks.z), 0);
        d.bakeAll();
        d.stale_ = false;
        return d;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("Not enough memory for a deforming field of resolution {}; lower the resolution.", options.resolution));
    }
}

Status DeformingField::checkPlaces(std::span<const vec3> positions) const {
    if (positions.size() != used_.size())
        return badInput(
            fmt::format("A deforming mesh of {} vertices was given {} places; give one place per vertex.", used_.size(), positions.size()));
    for (size_t k = 0; k < positions.size(); ++k) {
        if (used_[k] != 0 && !within(reach_, positions[k]))
            return badInput(
                fmt::format("Vertex {} of a deforming mesh is at {}, outside the box from {} to {} that its field covers; widen the box.",
                            k, named(positions[k]), named(reach_.min), named(reach_.max)));
    }
    return ok();
}

Result<DeformingField::Change> DeformingField::update(std::span<const vec3> positions) {
    if (Status status = checkPlaces(positions); !status) return status.error();
    std::vector<vec3> before;
    try {
        before = positions_;
        const size_t moved = findMoved(positions);
        const bool all = stale_ || 2 * moved > moved_.size();
        if (stale_) std::fill(occupied_.begin(), occupied_.end(), uint8_t{1});
        stale_ = true;
        std::copy(positions.begin(), positions.end(), positions_.begin());
        if (all) {
            bakeAll();
        } else {
            std::fill(dirty_.begin(), dirty_.end(), uint8_t{0});
            if (moved > 0) bakePart(before);
        }
        const Change change = displace(before);
        stale_ = false;
        return change;
    } catch (const std::bad_alloc&) {
        if (!before.empty()) positions_.swap(before);  // the next update begins where this one did
        return noMemory("Not enough memory to voxelise a deforming mesh again; lower its resolution.");
    }
}

// Sets moved_ and returns the number of moved triangles.
size_t DeformingField::findMoved(std::span<const vec3> positions) {
    size_t count = 0;
    for (size_t k = 0; k < moved_.size(); ++k) {
        bool moved = false;
        for (size_t corner = 3 * k; corner < 3 * k + 3; ++corner)
            moved = moved || positions_[indices_[corner]] != positions[indices_[corner]];
        moved_[k] = moved ? 1 : 0;
        count += moved_[k];
    }
    return count;
}

void DeformingField::bakeAll() {
    VoxelGrid& grid = field_.surface;
    const MeshView mesh{positions_, indices_, {}, {}};
    const GridTriangles list(std::span(&mesh, 1), grid);
    const DistanceBand band(grid, field_.band);
    std::fill(grid.bits.begin(), grid.bits.end(), uint8_t{0});
    voxelizeSurface(list, grid);
    // Bricks that no triangle reaches any more are cleared; the others are baked.
    std::swap(occupied_, dirty_);
    std::fill(occupied_.begin(), occupied_.end(), uint8_t{0});
    band.bake(list, surfaces_, {}, {}, occupied_, {field_.distance, field_.normal, nearest_});
    const ivec3 bricks = band.bricks();
    parallelFor(0, bricks.z, [&](int z) {
        for (int y = 0; y < bricks.y; ++y) {
            for (int x = 0; x < bricks.x; ++x) {
                const ivec3 brick(x, y, z);
                const size_t b = band.brickIndex(brick);
                if (dirty_[b] != 0 && occupied_[b] == 0) {
                    forPoints(brick, grid.size + 1, [&](size_t at, const ivec3&) {
                        field_.distance[at] = field_.band;
                        field_.normal[at] = 0;
                        nearest_[at] = kNoTriangle;
                    });
                }
                dirty_[b] = dirty_[b] | occupied_[b];
            }
        }
    });
}

// Flags the bricks of `band` that the moved triangles reach from their old or new places, and extends [low, high] to contain them.
void DeformingField::markMoved(const DistanceBand& band, const std::vector<vec3>& before, std::span<uint8_t> flags, ivec3& low,
                               ivec3& high) const {
    const MeshView oldMesh{before, indices_, {}, {}}, newMesh{positions_, indices_, {}, {}};
    const GridTriangles oldList(std::span(&oldMesh, 1), field_.surface), newList(std::span(&newMesh, 1), field_.surface);
    for (size_t k = 0; k < moved_.size(); ++k) {
        if (moved_[k] == 0) continue;
        for (const GridTriangles* list : {&oldList, &newList}) {
            const GridTriangle t = (*list)[k];
            ivec3 first, last;
            band.reach(t.low(), t.high(), first, last);
            low = glm::min(low, first);
            high = glm::max(high, last);
            band.markReach(t, flags);
        }
    }
}

// Finds the triangles whose box is within `margin` (m) of the bricks [low, high], in their original order: numbers and corners.
void DeformingField::findNear(const ivec3& low, const ivec3& high, float margin, std::vector<uint32_t>& numbers,
                              std::vector<uint32_t>& corners) const {
    const VoxelGrid& grid = field_.surface;
    const vec3 boxLow = grid.origin + grid.voxel * vec3(low * kBrick) - margin;
    const vec3 boxHigh = grid.origin + grid.voxel * vec3((high + 1) * kBrick) + margin;
    for (size_t k = 0; k < moved_.size(); ++k) {
        const vec3& a = positions_[indices_[3 * k]];
        const vec3& b = positions_[indices_[3 * k + 1]];
        const vec3& c = positions_[indices_[3 * k + 2]];
        bool apart = false;
        for (int axis = 0; axis < 3; ++axis) {
            apart = apart || std::min(a[axis], std::min(b[axis], c[axis])) > boxHigh[axis] ||
                    std::max(a[axis], std::max(b[axis], c[axis])) < boxLow[axis];
        }
        if (apart) continue;
        numbers.push_back(static_cast<uint32_t>(k));
        for (size_t corner = 3 * k; corner < 3 * k + 3; ++corner) corners.push_back(indices_[corner]);
    }
}

void DeformingField::bakePart(const std::vector<vec3>& before) {
    VoxelGrid& grid = field_.surface;
    // A voxel that a triangle touches has its low corner within sqrt(3) voxels of it. Bricks with such corners are voxelised again.
    const DistanceBand touch(grid, kContactVoxels * grid.voxel);
    std::vector<uint8_t> cleared(dirty_.size(), 0);
    ivec3 low = touch.bricks(), high(-1);
    markMoved(touch, before, cleared, low, high);
    for (int z = low.z; z <= high.z; ++z) {
        for (int y = low.y; y <= high.y; ++y) {
            for (int x = low.x; x <= high.x; ++x) {
                if (cleared[touch.brickIndex({x, y, z})] != 0) clearBits(ivec3(x, y, z), grid);
            }
        }
    }
    std::vector<uint32_t> numbers, corners;
    findNear(low, high, grid.voxel, numbers, corners);
    const MeshView touching{positions_, corners, {}, {}};
    voxelizeSurface(GridTriangles(std::span(&touching, 1), grid), grid);

    const DistanceBand band(grid, field_.band);
    markMoved(band, before, dirty_, low, high);
    numbers.clear();
    corners.clear();
    findNear(low, high, field_.band + grid.voxel, numbers, corners);
    const MeshView reaching{positions_, corners, {}, {}};
    band.bake(GridTriangles(std::span(&reaching, 1), grid), surfaces_, numbers, dirty_, occupied_,
              {field_.distance, field_.normal, nearest_});
}

// Sets displacements at the points of bricks baked in this update, and clears those of the last update elsewhere.
DeformingField::Change DeformingField::displace(const std::vector<vec3>& before) {
    const VoxelGrid& grid = field_.surface;
    const DistanceBand band(grid, field_.band);
    const ivec3 bricks = band.bricks();
    std::vector<size_t> rewritten(static_cast<size_t>(bricks.z), 0);  // of each layer of bricks
    std::vector<uint8_t> touched(static_cast<size_t>(bricks.z), 0);
    parallelFor(0, bricks.z, [&](int z) {
        for (int y = 0; y < bricks.y; ++y) {
            for (int x = 0; x < bricks.x; ++x) {
                const ivec3 brick(x, y, z);
                const size_t b = band.brickIndex(brick);
                if (dirty_[b] == 0 && displaced_[b] == 0) continue;
                bool any = false;
                forPoints(brick, grid.size + 1, [&](size_t at, const ivec3& point) {
                    const uint32_t k = nearest_[at];
                    vec4& out = displacement_[at];
                    out = vec4(0.0F);
                    if (dirty_[b] == 0 || k == kNoTriangle || moved_[k] == 0) return;
                    std::array<dvec3, 3> corners, ways;
                    for (size_t c = 0; c < 3; ++c) {
                        const uint32_t v = indices_[3 * size_t{k} + c];
                        corners[c] = dvec3(positions_[v]);
                        ways[c] = corners[c] - dvec3(before[v]);
                    }
                    const dvec3 p = dvec3(grid.origin) + dvec3(point) * static_cast<double>(grid.voxel);
                    const std::array<double, 3> weights = nearestWeights(p, corners[0], corners[1], corners[2]);
                    out = vec4(vec3(ways[0] * weights[0] + ways[1] * weights[1] + ways[2] * weights[2]), 0.0F);
                    any = true;
                });
                displaced_[b] = any ? 1 : 0;
                touched[static_cast<size_t>(z)] = 1;
                const ivec3 voxels = glm::min(ivec3(kBrick), grid.size - brick * kBrick);
                if (dirty_[b] != 0)
                    rewritten[static_cast<size_t>(z)] +=
                        static_cast<size_t>(voxels.x) * static_cast<size_t>(voxels.y) * static_cast<size_t>(voxels.z);
            }
        }
    });
    Change change;
    for (int z = 0; z < bricks.z; ++z) {
        change.voxels += rewritten[static_cast<size_t>(z)];
        if (touched[static_cast<size_t>(z)] == 0) continue;
        if (change.endLayer == 0) change.firstLayer = z * kBrick;
        change.endLayer = std::min((z + 1) * kBrick, grid.size.z + 1);
    }
    return change;
}

}  // namespace rivulet
