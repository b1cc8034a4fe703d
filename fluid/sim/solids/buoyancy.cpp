#include "fluid/sim/solids/buoyancy.h"

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"

namespace rivulet {

void BuoyancyParams::visit(ParamVisitor& v) {
    v.value({"restDensity", "kg/m^3", "rest density of the water", 1, 20000}, restDensity);
    v.value({"gravity", "m/s^2", "gravitational acceleration", -1000, 1000}, gravity);
    v.value({"linearDrag", "1/s", "linear drag, over the momentum of the displaced water", 0, 1000}, linearDrag);
    v.value({"quadraticDrag", "", "drag coefficient: about 1 of a cube, 0.5 of a ball", 0, 10}, quadraticDrag);
}

std::vector<FloatPoint> floatPoints(const BodyShape& shape, float apart) {
    ASSERT(apart > 0, "give floatPoints a distance between points");
    Bounds bounds;
    for (const vec3& s : shape.samples) bounds.add(s);
    std::vector<FloatPoint> points;
    if (shape.distance && !bounds.empty()) {
        // Samples lie under the surface; none farther under than the shape is thick.
        float under = 0;
        for (const vec3& s : shape.samples) under = std::max(under, -shape.distance(s));
        const vec3 low = bounds.min - under, size = bounds.size() + 2.0F * under;
        const ivec3 n = glm::max(ivec3(glm::ceil(size / apart)), ivec3(1));
        const vec3 step = size / vec3(n);
        for (int z = 0; z < n.z; ++z)
            for (int y = 0; y < n.y; ++y)
                for (int x = 0; x < n.x; ++x) {
                    const vec3 p = low + (vec3(ivec3(x, y, z)) + 0.5F) * step;
                    if (shape.distance(p) < 0) points.push_back({p, 0});
                }
    }
    if (points.empty()) points.push_back({});
    // The shape's centre of mass is its own frame's origin: so is the points'.
    dvec3 centre(0.0);
    for (const FloatPoint& p : points) centre += dvec3(p.place) / static_cast<double>(points.size());
    for (FloatPoint& p : points) p = {p.place - vec3(centre), shape.volume / static_cast<float>(points.size())};
    return points;
}

void addPlaces(std::span<const FloatPoint> points, const Pose& pose, std::vector<vec3>& places) {
    for (const FloatPoint& p : points) places.push_back(pose.toWorld(p.place));
}

BodyLoad buoyancy(std::span<const FloatPoint> points, const BodyState& state, std::span<const FluidSample> water,
                  const BuoyancyParams& params, double mass, double seconds) {
    ASSERT(points.size() == water.size(), "give buoyancy one sample a point");
    ASSERT(mass > 0, "give buoyancy a body with a mass above 0");
    double whole = 0;
    for (const FloatPoint& p : points) whole += double{p.volume};
    const double density = double{params.restDensity}, area = std::pow(whole, 2.0 / 3.0);
    BodyLoad load;
    for (size_t k = 0; k < points.size(); ++k) {
        const double volume = double{points[k].volume} * std::clamp(double{water[k].density}, 0.0, 1.0);
        if (!(volume > 0)) continue;
        const vec3 at = state.pose.toWorld(points[k].place);
        const dvec3 u = dvec3(water[k].velocity) - dvec3(state.velocityAt(at));
        const double frontal = area * volume / whole;
        // kg/s; what it would take in `seconds` is taken of what there is, as far as it lasts.
        const double drag = density * (double{params.linearDrag} * volume + 0.5 * double{params.quadraticDrag} * frontal * glm::length(u));
        const double own = mass * double{points[k].volume} / whole;
        const dvec3 force = -density * volume * dvec3(params.gravity) + u * (drag / (1 + drag * seconds / own));
        load.force += force;
        load.torque += glm::cross(dvec3(at) - dvec3(state.pose.position), force);
    }
    return load;
}

}  // namespace rivulet
