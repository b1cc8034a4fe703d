// ExportFrame: the axes of a file's coordinates and its origin.
#pragma once

#include <cstdint>

#include "engine/core/math.h"

namespace rivulet {

enum class UpAxis : uint8_t { y, z };

struct ExportFrame {
    UpAxis up = UpAxis::y;  // y: as simulated; z: rotated about x: (x, y, z) -> (x, -z, y)
    dvec3 origin{0.0};      // m: FluidWorld::origin(), added to each place
    // A float has a relative precision of 1e-7: far from zero that is more than a particle moves, so places are written as doubles.
    bool doubles() const { return origin != dvec3(0.0); }
    vec3 turned(const vec3& v) const { return up == UpAxis::z ? vec3(v.x, 0.0F - v.z, v.y) : v; }
    dvec3 turned(const dvec3& v) const { return up == UpAxis::z ? dvec3(v.x, 0.0 - v.z, v.y) : v; }
    dvec3 place(const vec3& p) const { return turned(origin + dvec3(p)); }
    char upLetter() const { return up == UpAxis::z ? 'Z' : 'Y'; }
};

}  // namespace rivulet
