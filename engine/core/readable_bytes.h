// Amounts of memory as text.
#pragma once

#include <cstddef>
#include <string>

namespace rivulet {

std::string readableBytes(double bytes);  // "800 bytes", "36 kB", "3.6 MB", "1.2 GB"
inline std::string readableBytes(size_t bytes) { return readableBytes(static_cast<double>(bytes)); }

}  // namespace rivulet
