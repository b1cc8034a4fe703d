// Draught of floating bodies, from the water level of the tank.
//
// Centres of particles lie half a spacing inside the water, samples of a body half a spacing inside the body, so neither marks a surface.
// The level is therefore computed from the tank. A particle stands for spacing^3, reduced by its compression, and
//     level * area = volume of water + volume of the bodies below the level,
// which does not depend on the arrangement of particles at the surface or beside a body. If the fluid kept too far from a body, or entered
// its surface layer, the body would float at a depth that disagrees with this level.
#pragma once

#include <span>

#include "engine/core/math.h"

namespace rivulet {

// A box or a ball that floats without tilt. SI units.
struct Floater {
    double height = 0, volume = 0;
    double keel = 0;  // height of its lowest point above the floor of the tank
    bool ball = false;

    // The share of its volume below the level if its lowest point is `deep` m below the level.
    double shareUnder(double deep) const;
};

// m^3; `positions` as ParticleView::position; free slots are skipped.
double waterVolume(std::span<const vec4> positions, double spacing);

// m above the floor of a tank with vertical walls; `water` in m^3, `area` of the floor in m^2.
double waterLevel(double water, double area, std::span<const Floater> floaters);

}  // namespace rivulet
