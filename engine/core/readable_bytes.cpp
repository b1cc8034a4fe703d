#include "engine/core/readable_bytes.h"

#include <fmt/format.h>

namespace rivulet {

std::string readableBytes(double bytes) {
    if (bytes < 1e4) return fmt::format("{:.0f} bytes", bytes);
    if (bytes < 1e5) return fmt::format("{:.0f} kB", bytes / 1e3);
    if (bytes < 1e9) return fmt::format("{:.1f} MB", bytes / 1e6);
    if (bytes < 1e12) return fmt::format("{:.1f} GB", bytes / 1e9);
    return bytes < 1e15 ? fmt::format("{:.1f} TB", bytes / 1e12) : "over 1000 TB";
}

}  // namespace rivulet
