// Draught: how deep floating bodies lie, by the level that the water itself says.
//
// Particles' centres lie within the water and a body's samples within the body, both by half a spacing: neither shows a surface. So the
// level is found from the tank: particles stand for spacing^3 each, less what they are compressed by, and
//     level * area = water + what is under the level of the bodies,
// which knows nothing of how particles lie at the top or beside a body. If the fluid kept too far off a body, or crept under its skin, it
// would stand higher or lower there, and the body float elsewhere than this level says.
#pragma once

#include <span>

#include "engine/core/math.h"

namespace rivulet {

// A box, or a ball, that floats upright. SI units.
struct Floater {
    double height = 0, volume = 0;
    double keel = 0;  // of its lowest point, from the tank's floor
    bool ball = false;

    // The share of its volume that is under, its lowest point `deep` m below the level.
    double shareUnder(double deep) const;
};

// m^3; `positions` as ParticleView::position, free slots among them or not.
double waterVolume(std::span<const vec4> positions, double spacing);

// m, above the floor of a tank with upright walls. `water` m^3, `area` m^2 of the floor.
double waterLevel(double water, double area, std::span<const Floater> floaters);

}  // namespace rivulet
