// Noise in space, the same on every machine: what pictures and hair are scattered by.
#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace rivulet::head {

using glm::dvec3;

inline double hash(int64_t x, int64_t y, int64_t z, uint64_t seed) {
    uint64_t h = static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^ static_cast<uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^
                 static_cast<uint64_t>(z) * 0x165667B19E3779F9ULL ^ seed * 0xD6E8FEB86659FD93ULL;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93ULL;
    h ^= h >> 29;
    h *= 0x9E3779B97F4A7C15ULL;
    h ^= h >> 32;
    return static_cast<double>(h >> 11) / 9007199254740992.0;
}

// Value noise in [-1, 1].
inline double noise(dvec3 p, uint64_t seed) {
    dvec3 c = glm::floor(p), f = p - c;
    f = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    auto x = static_cast<int64_t>(c.x), y = static_cast<int64_t>(c.y), z = static_cast<int64_t>(c.z);
    double sum = 0;
    for (int k = 0; k < 8; ++k) {
        int dx = k & 1, dy = k >> 1 & 1, dz = k >> 2;
        sum += (dx ? f.x : 1 - f.x) * (dy ? f.y : 1 - f.y) * (dz ? f.z : 1 - f.z) * hash(x + dx, y + dy, z + dz, seed);
    }
    return 2 * sum - 1;
}

inline double fractal(dvec3 p, int octaves, uint64_t seed) {
    double sum = 0, size = 0.5;
    for (int i = 0; i < octaves; ++i, size *= 0.5, p = p * 2.03 + dvec3(1.7, 9.2, 3.1)) sum += size * noise(p, seed + i);
    return sum;
}

// Distance to the nearest of jittered points, one per cell; `which` receives the random number of the cell.
inline double cells(dvec3 p, uint64_t seed, double& which) {
    dvec3 c = glm::floor(p);
    double best = 9;
    for (int k = 0; k < 27; ++k) {
        auto x = static_cast<int64_t>(c.x) + k % 3 - 1, y = static_cast<int64_t>(c.y) + k / 3 % 3 - 1,
             z = static_cast<int64_t>(c.z) + k / 9 - 1;
        dvec3 q = dvec3(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) +
                  dvec3(hash(x, y, z, seed), hash(x, y, z, seed + 1), hash(x, y, z, seed + 2));
        if (double d = glm::distance(p, q); d < best) {
            best = d;
            which = hash(x, y, z, seed + 3);
        }
    }
    return best;
}

}  // namespace rivulet::head
