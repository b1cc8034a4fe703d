// Misses with a known cause. `rivulet validate` prints the cause, and the miss does not fail a run.
#pragma once

#include <span>
#include <string_view>

namespace rivulet {

struct KnownMiss {
    std::string_view name, method;  // case and method
    std::string_view what;          // the beginning of Finding::what
    std::string_view cause;
};
std::span<const KnownMiss> knownMisses();

// The cause of a miss; "" = not known.
std::string_view knownMiss(std::string_view name, std::string_view method, std::string_view what);

}  // namespace rivulet
