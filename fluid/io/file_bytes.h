// Numbers as a file's bytes, little-endian on any machine.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

#include "fluid/io/export_frame.h"

namespace rivulet {

inline void putWord(std::string& out, uint32_t word) {
    for (unsigned shift = 0; shift < 32; shift += 8) out += static_cast<char>(word >> shift & 0xFFU);
}
inline void putLong(std::string& out, uint64_t word) {
    putWord(out, static_cast<uint32_t>(word));
    putWord(out, static_cast<uint32_t>(word >> 32U));
}
inline void putFloat(std::string& out, float number) { putWord(out, std::bit_cast<uint32_t>(number)); }
inline void putDouble(std::string& out, double number) { putLong(out, std::bit_cast<uint64_t>(number)); }
inline void putVector(std::string& out, const vec3& v) {
    for (int k = 0; k < 3; ++k) putFloat(out, v[k]);
}
// m; three doubles if frame.doubles(), else floats.
inline void putPlace(std::string& out, const vec3& p, const ExportFrame& frame) {
    if (!frame.doubles()) return putVector(out, frame.turned(p));
    const dvec3 far = frame.place(p);
    for (int k = 0; k < 3; ++k) putDouble(out, far[k]);
}

}  // namespace rivulet
