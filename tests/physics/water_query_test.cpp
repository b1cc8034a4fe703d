// Queries of the water at points and along rays. Compared with sums over all particles in double, and with water of a known shape.
#include "fluid/sim/query/water_query.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/physics/worlds.h"

namespace rivulet::water_query_test {
namespace {

constexpr float kSpacing = 0.03125F;  // m

struct Fluid {
    std::vector<vec3> position, velocity;
};
Fluid fluidOf(const FluidWorld& world) {
    const ParticleView view = world.particles();
    const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.count),
                            v = world.device().readAll<vec4>(*view.velocity, view.count);
    Fluid f;
    for (size_t i = 0; i < x.size(); ++i)
        if (!(x[i].w < 0)) {
            f.position.emplace_back(x[i]);
            f.velocity.emplace_back(v[i]);
        }
    return f;
}

// Wendland's kernel (1995), normed so that a cubic lattice is at 1.
double wendland(double r, double h) { return r < h ? std::pow(1 - r / h, 4) * (4 * r / h + 1) : 0; }
double unit(double support) {
    double sum = 0;
    for (int z = -4; z <= 4; ++z)
        for (int y = -4; y <= 4; ++y)
            for (int x = -4; x <= 4; ++x) sum += wendland(std::sqrt(double(x * x + y * y + z * z)), support);
    return 1 / sum;
}

struct Known {
    double density = 0;
    dvec3 velocity{0.0};
};
Known known(const Fluid& f, const FluidParams& p, const dvec3& at) {
    const double h = double{p.supportSpacings} * double{p.spacing}, one = unit(double{p.supportSpacings});
    Known k;
    for (size_t i = 0; i < f.position.size(); ++i) {
        dvec3 d = at - dvec3(f.position[i]);
        for (int axis = 0; axis < 3; ++axis)
            if (const double size = double{p.box.max[axis] - p.box.min[axis]}; p.box.periodic()[axis])
                d[axis] -= size * std::round(d[axis] / size);
        const double share = one * wendland(glm::length(d), h);
        k.density += share;
        k.velocity += share * dvec3(f.velocity[i]);
    }
    if (k.density > 0) k.velocity /= k.density;
    return k;
}

// A pool 0.1875 m deep in a box of 0.5 m.
FluidParams pool() {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.box.max = vec3(0.5F);
    p.blocks = {{vec3(0.0F), vec3(0.5F, 0.1875F, 0.5F), vec3(0.0F)}};
    return p;
}

// A lattice ball in the middle of a box of 1 m, without gravity.
FluidParams ball(float radius) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.gravity = vec3(0.0F);
    p.blocks = {{vec3(0.5F - radius), vec3(0.5F + radius), vec3(0.3F, -0.2F, 0.1F)}};
    p.blocks[0].shape = "ball";
    return p;
}

TEST(WaterQuery, AtAPointEqualsTheSumOverAllParticles) {
    for (const bool periodic : {false, true}) {
        auto device = cpu();
        FluidParams p = pool();
        p.blocks[0].max.x = 0.3F;
        p.blocks[0].velocity = vec3(1.0F, 0.0F, 0.5F);
        p.box.periodicX = p.box.periodicZ = periodic;
        auto world = makeWorld(*device, p);
        std::vector<vec3> places;
        places.reserve(400);
        for (int row = 0; row < 20; ++row)
            for (int k = 0; k < 20; ++k)
                places.emplace_back(0.001F + 0.498F * static_cast<float>(k) / 19.0F, 0.001F + 0.3F * static_cast<float>(row) / 19.0F,
                                    0.001F + 0.498F * static_cast<float>((20 * row + k) * 7 % 31) / 30.0F);
        for (int frame = 0; frame < 5; ++frame) {  // at t = 0, too
            const Fluid f = fluidOf(*world);
            const std::vector<FluidSample> got = *world->sample(places);
            double fullest = 0, emptiest = 1;
            for (size_t k = 0; k < places.size(); ++k) {
                const dvec3 at(places[k]);
                const Known is = known(f, p, at);
                fullest = std::max(fullest, is.density);
                emptiest = std::min(emptiest, is.density);
                EXPECT_NEAR(double{got[k].density}, is.density, 1e-3) << k;
                // With one or two particles in reach, it is their mean.
                if (is.density > 0.01) EXPECT_LT(glm::length(dvec3(got[k].velocity) - is.velocity), 2e-3) << k;
                const double e = 1.0e-4;
                for (int axis = 0; axis < 3; ++axis) {
                    dvec3 step(0.0);
                    step[axis] = e;
                    const double slope = (known(f, p, at + step).density - known(f, p, at - step).density) / (2 * e);
                    EXPECT_NEAR(double{got[k].gradient[axis]}, slope, 0.1) << k;  // 1/m, of up to 30
                }
            }
            EXPECT_GT(fullest, 0.9);
            EXPECT_EQ(emptiest, 0.0);
            world->step({.gravity = p.gravity}, 1.0 / 60);
        }
    }
}

TEST(WaterQuery, OutsideTheWaterThereIsAir) {
    auto device = cpu();
    auto world = makeWorld(*device, pool());
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<vec3> nowhere = {vec3(NAN),      vec3(0.25F, NAN, 0.25F),  vec3(inf),
                                       vec3(-1.0e30F), vec3(0.25F, 7.0F, 0.25F), vec3(0.25F, -7.0F, 0.25F)};
    for (int k = 0; k < 2; ++k) {
        const std::vector<FluidSample> air = *world->sample(nowhere);
        for (const FluidSample& s : air) {
            EXPECT_EQ(s.density, 0.0F);
            EXPECT_EQ(s.velocity, vec3(0.0F));
            EXPECT_EQ(s.gradient, vec3(0.0F));
        }
        EXPECT_TRUE(world->sample({})->empty());
        EXPECT_TRUE(world->cast({})->empty());
        world->step({}, 1.0 / 60);
    }
    FluidParams dry = pool();
    dry.blocks.clear();
    auto desert = makeWorld(*device, dry);
    EXPECT_EQ(desert->sample(nowhere)->size(), nowhere.size());
    EXPECT_TRUE(std::isnan((*desert->heights(std::vector<vec2>{vec2(0.25F)}))[0]));
}

// A query changes nothing: the bits are the same with and without it, from the first step on.
TEST(WaterQuery, ChangesNothing) {
    for (const char* method : {"wcsph", "pbf", "dfsph"}) {
        auto device = cpu();
        FluidParams p = pool();
        p.method = method;
        p.blocks[0].max.x = 0.3F;
        auto asked = makeWorld(*device, p), alone = makeWorld(*device, p);
        for (int k = 0; k < 5; ++k) {
            (void)asked->sample(std::vector<vec3>{vec3(0.2F), vec3(0.1F)});
            (void)asked->heights(std::vector<vec2>{vec2(0.2F)});
            for (FluidWorld* w : {asked.get(), alone.get()}) w->step({}, 1.0 / 60);
        }
        EXPECT_EQ(fluidOf(*asked).position, fluidOf(*alone).position) << method;
        EXPECT_EQ(fluidOf(*asked).velocity, fluidOf(*alone).velocity) << method;
    }
}

TEST(WaterQuery, DelayedResultsEqualImmediateOnes) {
    auto device = cpu();
    auto world = makeWorld(*device, pool());
    world->step({}, 1.0 / 60);
    const std::vector<vec3> places = {vec3(0.2F, 0.1F, 0.2F), vec3(0.3F, 0.18F, 0.3F), vec3(0.25F, 0.4F, 0.25F)};
    int called = 0;
    const std::vector<FluidSample> now = *world->sample(places);
    ASSERT_TRUE(world->sampleLater(places, [&](std::span<const FluidSample> samples) {
        ++called;
        ASSERT_EQ(samples.size(), now.size());
        for (size_t k = 0; k < now.size(); ++k) EXPECT_EQ(samples[k].density, now[k].density);
    }));
    EXPECT_EQ(called, 1);
    ASSERT_TRUE(world->sampleLater({}, [&](std::span<const FluidSample> samples) { called += static_cast<int>(samples.size()) + 1; }));
    EXPECT_EQ(called, 2);
}

// The height of a still pool is its volume over its area.
TEST(WaterQuery, AStillPoolStandsAtItsVolumeOverItsArea) {
    for (const char* method : {"wcsph", "dfsph"}) {
        auto device = cpu();
        FluidParams p = pool();
        p.method = method;
        auto world = makeWorld(*device, p);
        std::vector<vec2> places;
        places.reserve(49);
        for (int row = 0; row < 7; ++row)
            for (int k = 0; k < 7; ++k)
                places.emplace_back(0.08F + 0.34F * static_cast<float>(k) / 6.0F, 0.08F + 0.34F * static_cast<float>(row) / 6.0F);
        for (const int frames : {0, 90}) {
            for (int k = 0; k < frames; ++k) world->step({}, 1.0 / 60);
            const double level = static_cast<double>(fluidOf(*world).position.size()) * std::pow(double{kSpacing}, 3) / 0.25;
            double mean = 0;
            const std::vector<float> heights = *world->heights(places);
            for (const float y : heights) {
                EXPECT_NEAR(double{y}, level, 0.3 * double{kSpacing}) << method << frames;
                mean += double{y} / 49;
            }
            EXPECT_NEAR(mean, level, 0.15 * double{kSpacing}) << method << frames;
        }
        const float above = (*world->heights(std::vector<vec2>{vec2(0.25F, 0.6F)}))[0];
        EXPECT_TRUE(std::isnan(above)) << "beside the box there is no water";
    }
}

// Rays at a ball from all sides, oblique ones and ones from within, against the geometry of the sphere.
TEST(WaterQuery, RaysHitABallOnTheSphere) {
    auto device = cpu();
    const float radius = 0.25F;
    auto world = makeWorld(*device, ball(radius));
    const dvec3 centre(0.5);
    std::vector<FluidRay> rays;
    for (int k = 0; k < 60; ++k) {  // Fibonacci lattice: towards the centre, past the ball, from outside and inside the box
        const float y = 1.0F - 2.0F * (static_cast<float>(k) + 0.5F) / 60.0F, r = std::sqrt(1.0F - y * y),
                    a = 2.3999632F * static_cast<float>(k);
        const vec3 way(r * std::cos(a), y, r * std::sin(a));
        const vec3 beside = glm::normalize(glm::cross(way, vec3(0.3F, 0.5F, 0.8F))) * (0.6F * radius);
        rays.push_back({vec3(0.5F) - way * 0.45F, way});
        rays.push_back({vec3(0.5F) - way * 3.0F, way * 17.0F});
        rays.push_back({vec3(0.5F) - way * 3.0F + beside, way * 0.001F});
        rays.push_back({vec3(0.5F) + beside * 0.5F, way});
    }
    const auto check = [&](const dvec3& drift) {
        const std::vector<FluidHit> hits = *world->cast(rays);
        double upright = 0;
        for (size_t k = 0; k < rays.size(); ++k) {
            const dvec3 way = glm::normalize(dvec3(rays[k].direction)), from = dvec3(rays[k].origin) - centre - drift;
            const double b = glm::dot(from, way), c = glm::dot(from, from) - double{radius * radius};
            const bool inside = c < 0;
            const double distance = -b + (inside ? 1 : -1) * std::sqrt(b * b - c);
            ASSERT_TRUE(hits[k].hit) << k;
            EXPECT_EQ(hits[k].inside, inside) << k;
            EXPECT_NEAR(double{hits[k].distance}, distance, 0.5 * double{kSpacing}) << k;
            EXPECT_LT(glm::length(dvec3(hits[k].place) - dvec3(rays[k].origin) - way * double{hits[k].distance}), 1e-5);
            const dvec3 out = glm::normalize(dvec3(hits[k].place) - centre - drift);
            // The lattice has steps of one spacing: a mean error of 18 degrees, as for binary voxels on a sphere.
            EXPECT_GT(glm::dot(dvec3(hits[k].normal), out), 0.8) << k;
            upright += glm::dot(dvec3(hits[k].normal), out) / static_cast<double>(rays.size());
            EXPECT_NEAR(glm::length(hits[k].normal), 1.0F, 1e-5F);
            EXPECT_LT(glm::length(dvec3(hits[k].velocity) - dvec3(0.3, -0.2, 0.1)), 0.02) << k;
        }
        EXPECT_GT(upright, 0.95);
    };
    check(dvec3(0.0));
    world->step({.gravity = vec3(0.0F)}, 1.0 / 60);
    check(dvec3(0.3, -0.2, 0.1) / 60.0);
}

TEST(WaterQuery, RaysWithoutWaterMiss) {
    auto device = cpu();
    auto world = makeWorld(*device, ball(0.2F));
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<FluidRay> rays = {{vec3(0.5F), vec3(0.0F)},
                                        {vec3(0.5F), vec3(NAN, 1, 0)},
                                        {vec3(NAN), vec3(0, 1, 0)},
                                        {vec3(inf), vec3(0, -1, 0)},
                                        {vec3(0.5F, 0.9F, 0.5F), vec3(0, 1, 0)},
                                        {vec3(0.5F, 2.0F, 0.5F), vec3(0, 1, 0)},
                                        {vec3(0.2F, 2.0F, 0.2F), vec3(0, -1, 0)},
                                        {vec3(5.0F, 0.5F, 0.5F), vec3(0, -1, 0)},
                                        {vec3(0.5F, 1.0F, 0.5F), vec3(0, -1, 0), 0.25F},
                                        {vec3(0.5F, 1.0F, 0.5F), vec3(0, -1, 0), NAN},
                                        {vec3(0.5F, 0.5F, 0.5F), vec3(0, -1, 0), 0.1F}};
    const std::vector<FluidHit> hits = *world->cast(rays);
    for (size_t k = 0; k < rays.size(); ++k) {
        EXPECT_FALSE(hits[k].hit) << k;
        EXPECT_EQ(hits[k].inside, k == rays.size() - 1) << k;
    }
    EXPECT_TRUE((*world->cast(std::vector<FluidRay>{{vec3(0.5F, 1.0F, 0.5F), vec3(0, -1, 0), 0.35F}}))[0].hit);
}

// Water has a surface at walls: a ray through the floor enters and leaves the water there.
TEST(WaterQuery, WaterEndsAtItsWalls) {
    auto device = cpu();
    auto world = makeWorld(*device, pool());
    for (int k = 0; k < 2; ++k) {
        const std::vector<FluidHit> hits = *world->cast(std::vector<FluidRay>{{vec3(0.25F, -1.0F, 0.25F), vec3(0, 1, 0)},
                                                                              {vec3(0.25F, 0.1F, 0.25F), vec3(0, -2, 0)},
                                                                              {vec3(0.25F, 0.1F, 0.25F), vec3(3, 0, 0)}});
        for (const FluidHit& h : hits) EXPECT_TRUE(h.hit);
        EXPECT_NEAR(hits[0].distance, 1.0F, 0.3F * kSpacing);
        EXPECT_FALSE(hits[0].inside);
        EXPECT_NEAR(hits[1].distance, 0.1F, 0.3F * kSpacing);
        EXPECT_NEAR(hits[2].distance, 0.25F, 0.3F * kSpacing);
        EXPECT_LT(hits[0].normal.y, -0.9F);
        EXPECT_LT(hits[1].normal.y, -0.9F);
        EXPECT_GT(hits[2].normal.x, 0.9F);
        EXPECT_TRUE(hits[1].inside && hits[2].inside);
        world->step({}, 1.0 / 60);
    }
}

}  // namespace
}  // namespace rivulet::water_query_test
