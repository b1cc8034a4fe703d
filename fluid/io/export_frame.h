// In which axes a file's coordinates are, and where its (0, 0, 0) is.
#pragma once

#include <cstdint>

#include "engine/core/math.h"

namespace rivulet {

enum class UpAxis : uint8_t { y, z };

struct ExportFrame {
    UpAxis up = UpAxis::y;  // y: as simulated; z: turned about x, so that y points where z did: (x, y, z) -> (x, -z, y)
    dvec3 origin{0.0};      // m: FluidWorld::origin(), added to each place
    // Floats hold a place to a ten-millionth of its distance: far away that is more than a particle moves, so there doubles are written.
    bool doubles() const { return origin != dvec3(0.0); }
    vec3 turned(const vec3& v) const { return up == UpAxis::z ? vec3(v.x, 0.0F - v.z, v.y) : v; }
    dvec3 turned(const dvec3& v) const { return up == UpAxis::z ? dvec3(v.x, 0.0 - v.z, v.y) : v; }
    dvec3 place(const vec3& p) const { return turned(origin + dvec3(p)); }
    char upLetter() const { return up == UpAxis::z ? 'Z' : 'Y'; }
};

}  // namespace rivulet
