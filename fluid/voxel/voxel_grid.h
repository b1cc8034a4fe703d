// A grid of bits over a mesh: any w x h x d, x fastest, eight voxels per byte (bit k of byte b is voxel 8 b + k in row-major order).
#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

struct VoxelGrid {
    ivec3 size{0};              // voxels along x, y, z
    vec3 origin{0.0F};          // m, the low corner of voxel (0,0,0)
    float voxel = 0;            // m, edge
    std::vector<uint8_t> bits;  // (size.x * size.y * size.z + 7) / 8 bytes, padded to a multiple of 4

    size_t count() const { return static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z); }
    size_t index(const ivec3& c) const {
        return (static_cast<size_t>(c.z) * static_cast<size_t>(size.y) + static_cast<size_t>(c.y)) * static_cast<size_t>(size.x) +
               static_cast<size_t>(c.x);
    }
    bool contains(const ivec3& c) const { return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < size.x && c.y < size.y && c.z < size.z; }
    bool test(const ivec3& c) const {
        size_t i = index(c);
        return contains(c) && ((bits[i >> 3U] >> (i & 7U)) & 1U) != 0;
    }
    void set(const ivec3& c) {
        size_t i = index(c);
        bits[i >> 3U] = static_cast<uint8_t>(bits[i >> 3U] | (1U << (i & 7U)));
    }
    // A point outside the grid gives a cell outside it.
    ivec3 cellOf(const vec3& p) const {
        vec3 c = glm::floor((p - origin) / voxel);
        return ivec3(static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z));
    }
};

}  // namespace rivulet
