// Paths of Params, "fluid.box.min", "colliders[2].mesh", and the error message for an unknown name.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/core/json.h"

namespace rivulet {

inline std::string pathOf(std::string_view group, std::string_view name) {
    return group.empty() ? std::string(name) : std::string(group) + "." + std::string(name);
}
inline std::string pathOf(std::string_view list, size_t index) { return std::string(list) + "[" + std::to_string(index) + "]"; }

// `fluid.spacingg is not a parameter; did you mean fluid.spacing?`: suggests the nearest of the names `beside` it in `group`, else a
// parameter of the same name in another group, else lists all names of the group.
std::string unknownParam(std::string_view group, std::string_view name, std::span<const std::string> beside, const VisitFn& visit);

}  // namespace rivulet
