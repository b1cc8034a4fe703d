// Whether particles are connected, and the volume that they cover.
#pragma once

#include <span>

#include "engine/core/math.h"

namespace rivulet {

// The share of particles, 0 to 1, in the largest set that is connected by distances below `reach`, m. Positions as ParticleView::position,
// free slots are skipped; `period`, m: of a domain that is periodic along z, with z from 0 to it, at least twice `reach`.
double largestCluster(std::span<const vec4> positions, double reach, double period);

// The volume, m^3, of the union of balls of `radius` m around the particles, counted on cells of about `cell` m. Arguments as above.
double coveredVolume(std::span<const vec4> positions, double radius, double cell, double period);

}  // namespace rivulet
