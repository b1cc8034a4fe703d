// Buoyancy without coupling: what the water does to a host's own bodies, from samples of it, while the water does not know of them. For
// many small things, or far ones; what the water has to give way to is a Body (bodies.h).
//
// A body is points, each with the volume it stands for. Archimedes: a point bears the weight of rest-density water of its volume, times the
// share of it that is under, which is the water's density ratio there (1 at most): at the surface that rises from 0 to 1 over about two
// spacings, half of it on either side, so that a body higher than that floats as deep as it should, and a lower one as if it were that
// high. Drag (Morison et al. 1950, without its inertia term): linear, k rho V u, and quadratic, C rho A |u| u / 2, of the water's velocity
// u relative to the point; A is V^(2/3), shared among the points by their volumes. It never turns a motion round within a step.
//
// The host's part: ask for places, hand the samples back with the state, integrate. Waves that the body would make, water that it would
// carry along (added mass) and what it would shelter do not exist.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/query/water_query.h"
#include "fluid/sim/solids/bodies.h"

namespace rivulet {

struct FloatPoint {
    vec3 place{0.0F};  // m, own frame: its origin the centre of mass
    float volume = 0;  // m^3
};

// Points of a lattice `apart` m wide inside the shape (box, sphere, mesh: body_shapes.h), their volumes adding up to the shape's; at least
// one. A shape without `distance` is its centre of mass alone.
std::vector<FloatPoint> floatPoints(const BodyShape& shape, float apart);

struct BuoyancyParams {
    float restDensity = 1000.0F;       // kg/m^3, of the water
    vec3 gravity{0.0F, -9.81F, 0.0F};  // m/s^2
    float linearDrag = 1.0F;           // 1/s, of the water displaced
    float quadraticDrag = 1.0F;        // C: about 1 of a cube, 0.5 of a ball
    void visit(ParamVisitor& v);
};

// Where the water is to be sampled: the points in the world, m, appended to `places`.
void addPlaces(std::span<const FloatPoint> points, const Pose& pose, std::vector<vec3>& places);

// The water's force (N) and torque about the centre of mass (N m), world axes. `water`: at the points' places, one each. `mass` kg, > 0;
// `seconds`: how long the host will let it act, s.
BodyLoad buoyancy(std::span<const FloatPoint> points, const BodyState& state, std::span<const FluidSample> water,
                  const BuoyancyParams& params, double mass, double seconds);

}  // namespace rivulet
