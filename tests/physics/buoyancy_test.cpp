// Bodies that float on sampled water, integrated by a small host: their draught obeys Archimedes' principle, and the water is not affected.
#include "fluid/sim/solids/buoyancy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/physics/worlds.h"

namespace rivulet::buoyancy_test {
namespace {

constexpr float kSpacing = 0.025F;

// A pool 0.3 m deep that has come to rest.
FluidParams pool() {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.artificialViscosity = 0.1F;
    p.box.max = vec3(0.5F, 0.6F, 0.5F);
    p.box.periodicX = p.box.periodicZ = true;
    p.blocks = {{vec3(0.0F), vec3(0.5F, 0.3F, 0.5F), vec3(0.0F)}};
    return p;
}

// The host: a rigid body, symplectic Euler.
struct Floater {
    BodyShape shape;
    std::vector<FloatPoint> points;
    BodyState state;
    BuoyancyParams params;

    void step(FluidWorld& world, double dt) {
        std::vector<vec3> places;
        addPlaces(points, state.pose, places);
        const BodyLoad load = buoyancy(points, state, *world.sample(places), params, double{shape.mass}, dt);
        state.velocity += vec3((load.force / double{shape.mass} + dvec3(params.gravity)) * dt);
        const quat turn = state.pose.rotation;
        const vec3 own = glm::conjugate(turn) * vec3(load.torque) / shape.inertia;  // without the gyroscopic term: it turns slowly
        state.spin += turn * own * static_cast<float>(dt);
        state.pose.position += state.velocity * static_cast<float>(dt);
        state.pose.rotation =
            glm::normalize(turn + 0.5F * static_cast<float>(dt) * quat(0, state.spin.x, state.spin.y, state.spin.z) * turn);
    }
};

Floater floating(BodyShape shape, float apart, const vec3& at) {
    Floater f{.shape = std::move(shape), .points = {}, .state = {}, .params = {}};
    f.points = floatPoints(f.shape, apart);
    f.state.pose.position = at;
    return f;
}

TEST(Buoyancy, PointsFillTheShape) {
    const BodyShape box = boxShape(vec3(0.2F, 0.1F, 0.3F), 500, kSpacing);
    const BodyShape ball = sphereShape(0.1F, 500, kSpacing);
    for (const BodyShape* s : {&box, &ball}) {
        const std::vector<FloatPoint> points = floatPoints(*s, 0.02F);
        double volume = 0;
        dvec3 centre(0.0), squares(0.0);
        for (const FloatPoint& p : points) {
            EXPECT_LT(s->distance(p.place), 1e-6F);
            volume += double{p.volume};
            centre += double{p.volume} * dvec3(p.place);
            squares += double{p.volume} * dvec3(p.place) * dvec3(p.place);
        }
        EXPECT_NEAR(volume, double{s->volume}, 1e-5 * double{s->volume});
        EXPECT_LT(glm::length(centre / volume), 1e-6);
        // Its inertia equals that of the body, within the accuracy of points.
        EXPECT_NEAR(500 * (squares.y + squares.z), double{s->inertia.x}, 0.05 * double{s->inertia.x});
    }
    EXPECT_EQ(floatPoints(box, 10.0F).size(), 1U);
    BodyShape bare;
    bare.volume = 0.5F;
    ASSERT_EQ(floatPoints(bare, 0.1F).size(), 1U);
    EXPECT_EQ(floatPoints(bare, 0.1F)[0].volume, 0.5F);
}

// Prescribed water: body submerged, half submerged, and in a stream.
TEST(Buoyancy, ForcesAreThoseOfArchimedesAndMorison) {
    const BodyShape box = boxShape(vec3(0.2F), 500, kSpacing);
    const std::vector<FloatPoint> points = floatPoints(box, 0.02F);
    BodyState state;
    state.pose.position = vec3(3.0F, 1.0F, -2.0F);
    BuoyancyParams params;
    std::vector<FluidSample> water(points.size(), {1.0F, vec3(0.0F), vec3(0.0F)});
    const double weight = 1000 * 0.008 * 9.81;
    BodyLoad load = buoyancy(points, state, water, params, 4, 1e-6);
    EXPECT_NEAR(load.force.y, weight, 1e-4 * weight);
    EXPECT_LT(glm::length(load.torque), 1e-4);
    // Water above rest density gives no more buoyancy.
    for (FluidSample& s : water) s.density = 1.3F;
    EXPECT_NEAR(buoyancy(points, state, water, params, 4, 1e-6).force.y, weight, 1e-4 * weight);
    // Half submerged: half the force, at a quarter of the width from the centre.
    for (size_t k = 0; k < points.size(); ++k) water[k].density = points[k].place.x > 0 ? 1.0F : 0.0F;
    load = buoyancy(points, state, water, params, 4, 1e-6);
    EXPECT_NEAR(load.force.y, weight / 2, 1e-4 * weight);
    EXPECT_NEAR(load.torque.z, weight / 2 * 0.05, 0.01 * weight / 2 * 0.05);
    // A stream of 2 m/s against a cube at rest: C rho A v^2 / 2 + k rho V v.
    params.gravity = vec3(0.0F);
    for (FluidSample& s : water) s = {1.0F, vec3(2.0F, 0.0F, 0.0F), vec3(0.0F)};
    load = buoyancy(points, state, water, params, 4, 1e-6);
    EXPECT_NEAR(load.force.x, 0.5 * 1000 * 0.04 * 4 + 1000 * 0.008 * 2, 0.1);
    // Over any time it removes at most the velocity difference.
    EXPECT_LE(buoyancy(points, state, water, params, 4, 10.0).force.x * 10.0 / 4, 2.0);
}

TEST(Buoyancy, ACubeOfHalfTheDensityFloatsHalfUnder) {
    auto device = cpu();
    auto world = makeWorld(*device, pool()), alone = makeWorld(*device, pool());
    const float edge = 0.1F;
    Floater light = floating(boxShape(vec3(edge), 500, kSpacing), 0.02F, vec3(0.15F, 0.36F, 0.25F));
    Floater heavy = floating(boxShape(vec3(edge), 1500, kSpacing), 0.02F, vec3(0.35F, 0.36F, 0.25F));
    double mean = 0;
    int counted = 0;
    for (int k = 0; k < 360; ++k) {
        for (FluidWorld* w : {world.get(), alone.get()})
            if (k % 2 == 0) w->step({}, 1.0 / 60);
        light.step(*world, 1.0 / 120);
        if (heavy.state.pose.position.y > 0) heavy.step(*world, 1.0 / 120);
        if (k >= 240) {
            mean += double{light.state.pose.position.y};
            ++counted;
        }
    }
    double level = 0;
    const std::vector<vec4> x = device->readAll<vec4>(*world->particles().position, world->particles().count);
    for (const vec4& p : x) level += 2 * double{p.y} / static_cast<double>(x.size());  // twice the mean height of an evenly filled box
    EXPECT_NEAR(mean / counted, level, 0.05 * double{edge});
    EXPECT_LT(glm::length(light.state.velocity), 0.05F);
    EXPECT_LT(heavy.state.pose.position.y, 0.1F) << "it sinks";
    EXPECT_TRUE(x == device->readAll<vec4>(*alone->particles().position, alone->particles().count)) << "the water is not affected";
}

}  // namespace
}  // namespace rivulet::buoyancy_test
