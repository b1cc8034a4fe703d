// What the files of small worlds share.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/races/small_worlds.h"

namespace rivulet::races {

constexpr float kSpacing = 0.05F;
constexpr double kStep = 1.0 / 240;

inline void add(std::vector<float>& to, const vec4& v) { to.insert(to.end(), {v.x, v.y, v.z, v.w}); }
inline void add(std::vector<float>& to, const vec3& v) { to.insert(to.end(), {v.x, v.y, v.z}); }

// A column of 216 particles in a box, of which two frames are two steps.
FluidParams column(const char* method);
std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& p, const Solids& solids = {}, const Sources& sources = {});
// A step; what a GPU reports late arrives before the next one, so that runs do not differ by it.
void step(FluidWorld& world, const FluidInputs& inputs = {}, double seconds = kStep);
// Every particle, by id.
void addParticles(FluidWorld& world, std::vector<float>& to);
// Their number, mean places and mean squares.
void addMeans(std::span<const vec4> all, std::vector<float>& to);
void addMeans(FluidWorld& world, std::vector<float>& to);

// small_worlds_services.cpp
Answer sources(Device& device);
Answer foam(Device& device);
Answer sleep(Device& device);
Answer wetness(Device& device);
Answer queries(Device& device);

// small_worlds_skins.cpp
Answer skin(Device& device);
Answer flow(Device& device);
Answer flowWithoutTrails(Device& device);
Answer thesisFlow(Device& device);

}  // namespace rivulet::races
