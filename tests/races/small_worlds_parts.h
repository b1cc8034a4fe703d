// What the files of small worlds share.
#pragma once

#include <vector>

#include "engine/core/math.h"
#include "tests/races/small_worlds.h"

namespace rivulet::races {

inline void add(std::vector<float>& to, const vec4& v) { to.insert(to.end(), {v.x, v.y, v.z, v.w}); }
inline void add(std::vector<float>& to, const vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

// small_worlds_skins.cpp
Answer skin(Device& device);
Answer flow(Device& device);
Answer flowWithoutTrails(Device& device);
Answer thesisFlow(Device& device);

}  // namespace rivulet::races
