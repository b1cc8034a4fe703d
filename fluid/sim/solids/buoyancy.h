// Buoyancy without coupling: the force of the water on bodies of the host, computed from samples of the water, which the bodies do not
// affect. For many small or distant objects; a body that displaces water is a Body (bodies.h).
//
// A body is points, each with the volume it stands for. Archimedes: the lift of a point is the weight of its volume in water at rest
// density, times its submerged share, which is the density ratio of the water there (at most 1). At the surface this share rises from 0 to
// 1 over about two spacings, half on either side. A body higher than that floats at the right depth, a lower one as if it were that high.
// Drag (Morison et al. 1950, without its inertia term): linear, k rho V u, and quadratic, C rho A |u| u / 2, of the water's velocity u
// relative to the point; A is V^(2/3), shared among the points by their volumes. It never reverses a motion within a step. The host gets
// the places, samples the water there, passes the samples and the state back, and integrates. Waves made by the body, added mass and
// shelter are not modelled.
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

// Appends the points at which the water must be sampled to `places`, world coordinates, m.
void addPlaces(std::span<const FloatPoint> points, const Pose& pose, std::vector<vec3>& places);

// Returns the water's force (N) and torque about the centre of mass (N m), world axes. `water`: one sample for each point. `mass` kg, > 0;
// `seconds`: time for which the host applies them, s.
BodyLoad buoyancy(std::span<const FloatPoint> points, const BodyState& state, std::span<const FluidSample> water,
                  const BuoyancyParams& params, double mass, double seconds);

}  // namespace rivulet
