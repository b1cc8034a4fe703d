// WCSPH against independent references: sums in double, quadrature of the kernel, conservation, a column at rest, and degenerate input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/worlds.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::sim_wcsph_test {
namespace {

FluidParams boxOfWater(float spacing, vec3 min, vec3 max) {
    FluidParams p{.method = "wcsph"};
    p.spacing = spacing;
    p.blocks = {{min, max, vec3(0.0F)}};
    return p;
}

double wendland(double r, double h) {  // Wendland C2 in 3D, normalised, written from the formula
    const double q = r / h;
    return q < 1 ? 21.0 / (2.0 * M_PI * h * h * h) * std::pow(1 - q, 4) * (4 * q + 1) : 0.0;
}

// ---- density ----

TEST(Wcsph, DensityIsTheSumOverAllPairsInDouble) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.04F, vec3(0.3F), vec3(0.7F));  // no wall within reach
    p.gravity = vec3(0.0F);
    auto world = makeWorld(*device, p);
    const uint32_t n = world->particles().count;
    // Disturb, take one tiny step, and compare what it measured with every pair summed in double.
    std::vector<vec4> x = device->readAll<vec4>(*world->particles().position, n);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> jitter(-0.01F, 0.01F);
    for (vec4& v : x) v += vec4(jitter(random), jitter(random), jitter(random), 0.0F);
    Buffer& position = const_cast<Buffer&>(*world->particles().position);
    device->writeAll<vec4>(position, x);
    world->step({vec3(0.0F)}, 1.0e-9);
    const std::vector<vec4> after = device->readAll<vec4>(*world->particles().position, n);
    const std::vector<uint32_t> id = device->readAll<uint32_t>(*world->particles().id, n);
    const double support = double{p.supportSpacings}, h = 0.04 * support, mass = std::pow(0.04, 3), lattice = wendlandLatticeSum(support);
    double worst = 0;
    for (uint32_t i = 0; i < n; ++i) {
        double ratio = 0;
        const vec4& a = x[id[i]];
        for (const vec4& b : x) ratio += mass * wendland(std::hypot(double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z), h) / lattice;
        worst = std::max(worst, std::abs(double{after[i].w} - ratio) / ratio);
    }
    EXPECT_LT(worst, 2.0e-6);
}

TEST(Wcsph, TheLatticeSumIsTheKernelsSumOverALattice) {
    for (double support : {2.0, 2.5, 3.0}) {
        double sum = 0;
        for (int z = -4; z <= 4; ++z)
            for (int y = -4; y <= 4; ++y)
                for (int x = -4; x <= 4; ++x) sum += wendland(std::sqrt(double(x * x + y * y + z * z)), support);
        EXPECT_NEAR(wendlandLatticeSum(support), sum, 1e-12);
    }
}

// A block that fills its box from wall to wall is at rest density everywhere, along edges and in corners too: walls continue the lattice.
TEST(Wcsph, ALatticeAgainstWallsIsAtRestDensity) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.05F, vec3(0.0F), vec3(1.0F, 0.5F, 1.0F));
    p.gravity = vec3(0.0F);
    p.blocks[0].jitter = 0;
    auto world = makeWorld(*device, p);
    world->step({vec3(0.0F)}, 1.0e-9);
    const uint32_t n = world->particles().count;
    ASSERT_EQ(n, 20U * 10U * 20U);
    double worst = 0;
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, n)) {
        if (x.y > 0.35F) continue;  // the free surface
        worst = std::max(worst, std::abs(double{x.w} - 1.0));
    }
    EXPECT_LT(worst, 3.0e-6);
}

// Three squares that meet at `corner`.
test::Mesh innerCorner(const vec3& corner, float size) {
    test::Mesh mesh;
    for (int axis = 0; axis < 3; ++axis) {
        vec3 u(0.0F), v(0.0F);
        u[(axis + 1) % 3] = size;
        v[(axis + 2) % 3] = size;
        mesh.quad(corner, corner + u, corner + u + v, corner + v);
    }
    return mesh;
}

// Walls of the box, of planes and of a mesh are planes of symmetry: in a corner, the density is the sum over all particles and their seven
// reflections, in double.
TEST(Wcsph, DensityInACornerIsTheSumOverReflections) {
    auto device = cpu();
    std::mt19937 random(5);
    std::uniform_real_distribution<float> jitter(-0.01F, 0.01F);
    for (const char* walls : {"box", "planes", "mesh"}) {
        FluidParams p = boxOfWater(0.04F, vec3(0.2F), vec3(0.52F));
        p.gravity = vec3(0.0F);
        Solids solids;
        VoxelField field;
        if (std::string_view(walls) == "box") p.box.min = vec3(0.2F);
        if (std::string_view(walls) == "planes")
            for (int k = 0; k < 3; ++k) {
                vec3 n(0.0F);
                n[k] = 1;
                solids.planes.push_back({vec3(0.2F), n, 0});
            }
        if (std::string_view(walls) == "mesh") {
            field = test::baked(innerCorner(vec3(0.2F), 0.8F), 0.01F, 2 * p.spacing);
            solids.field = &field;
        }
        auto world = makeWorld(*device, p, solids);
        const uint32_t n = world->particles().count;
        ASSERT_EQ(n, 512U);
        std::vector<vec4> x = device->readAll<vec4>(*world->particles().position, n);
        for (vec4& v : x) v += vec4(jitter(random), jitter(random), jitter(random), 0.0F);
        device->writeAll<vec4>(const_cast<Buffer&>(*world->particles().position), x);
        world->step({vec3(0.0F)}, 1.0e-9);
        const std::vector<vec4> after = device->readAll<vec4>(*world->particles().position, n);
        const std::vector<uint32_t> id = device->readAll<uint32_t>(*world->particles().id, n);
        const double support = double{p.supportSpacings}, h = 0.04 * support, mass = std::pow(0.04, 3),
                     lattice = wendlandLatticeSum(support);
        double worst = 0;
        for (uint32_t i = 0; i < n; ++i) {
            double ratio = 0;
            for (const vec4& b : x)
                for (int image = 0; image < 8; ++image) {
                    double squares = 0;
                    for (int k = 0; k < 3; ++k) {
                        const double there = (image >> k & 1) != 0 ? 2 * double{0.2F} - double{b[k]} : double{b[k]};
                        squares += std::pow(double{x[id[i]][k]} - there, 2);
                    }
                    ratio += mass * wendland(std::sqrt(squares), h) / lattice;
                }
            worst = std::max(worst, std::abs(double{after[i].w} - ratio) / ratio);
        }
        EXPECT_LT(worst, std::string_view(walls) == "mesh" ? 2.0e-3 : 2.0e-5) << walls;
    }
}

// ---- motion ----

TEST(Wcsph, PairForcesConserveMomentum) {
    auto device = cpu();
    FluidParams p{.method = "wcsph"};
    p.spacing = 0.04F;
    p.gravity = vec3(0.0F);
    p.blocks = {{vec3(0.2F, 0.4F, 0.4F), vec3(0.4F, 0.6F, 0.6F), vec3(1.0F, 0.0F, 0.0F)},
                {vec3(0.44F, 0.44F, 0.36F), vec3(0.64F, 0.6F, 0.56F), vec3(-0.5F, 0.1F, 0.0F)}};
    auto world = makeWorld(*device, p);
    const uint32_t n = world->particles().count;
    auto momentum = [&](double& scale) {
        double sum[3] = {0, 0, 0};
        scale = 0;
        for (const vec4& v : device->readAll<vec4>(*world->particles().velocity, n)) {
            for (int k = 0; k < 3; ++k) sum[k] += double{v[k]};
            scale += std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z);
        }
        return dvec3(sum[0], sum[1], sum[2]);
    };
    double scale = 0, ignored = 0;
    const dvec3 before = momentum(scale);
    for (int frame = 0; frame < 6; ++frame) world->step({vec3(0.0F)}, 1.0 / 60);
    const dvec3 after = momentum(ignored);
    EXPECT_LT(glm::length(after - before) / scale, 1.0e-5);
    EXPECT_GT(ignored, 0.2 * scale) << "they collided and went on, they did not freeze";
}

TEST(Wcsph, FreeParticlesFallByGalileosLaw) {
    auto device = cpu();
    FluidParams p{.method = "wcsph"};
    p.spacing = 0.02F;
    p.blocks = {{vec3(0.5F, 0.9F, 0.5F), vec3(0.52F, 0.92F, 0.52F), vec3(0.0F)}};
    auto world = makeWorld(*device, p);
    ASSERT_EQ(world->particles().count, 1U);
    const float start = device->readAll<vec4>(*world->particles().position, 1)[0].y;
    for (int frame = 0; frame < 18; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    const float end = device->readAll<vec4>(*world->particles().position, 1)[0].y;
    EXPECT_NEAR(start - end, 0.5 * 9.81 * 0.3 * 0.3, 0.002) << "symplectic Euler is g t dt / 2 ahead at most";
    EXPECT_NEAR(world->time(), 0.3, 1e-9);
}

// Water at rest stays at rest: pressure rho g (H - z), little motion, no particle lost or below the floor.
TEST(Wcsph, AColumnAtRestStaysAtRestUnderHydrostaticPressure) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.05F, vec3(0.0F), vec3(0.5F, 0.5F, 0.5F));
    p.box.max = vec3(0.5F, 1.0F, 0.5F);
    p.artificialViscosity = 0.2F;  // damps motion quickly
    auto world = makeWorld(*device, p);
    for (int frame = 0; frame < 90; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    const FluidStats& s = world->stats();
    EXPECT_EQ(s.lost, 0U);
    EXPECT_LT(s.avgCompression, 0.01);
    EXPECT_NEAR(s.centreOfMass[1], 0.25, 0.01);
    EXPECT_LT(std::sqrt(2 * s.kinetic / (1000 * 0.125)), 0.03 * std::sqrt(9.81 * 0.5));
    // Tait's equation at the measured densities gives the weight of the water above.
    const double c0 = 10 * std::sqrt(2 * 9.81 * 0.5), rho0 = 1000;
    const uint32_t n = world->particles().count;
    double low = 0, lowPlace = 0;
    int count = 0;
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, n)) {
        EXPECT_GE(x.y, 0.5F * p.spacing - 1e-5F);
        if (x.y < 0.15F && x.x > 0.1F && x.x < 0.4F && x.z > 0.1F && x.z < 0.4F) {
            low += std::max(c0 * c0 * rho0 / 7 * (std::pow(double{x.w}, 7) - 1), 0.0);
            lowPlace += double{x.y};
            ++count;
        }
    }
    ASSERT_GT(count, 20);
    const double expected = rho0 * 9.81 * (0.5 - lowPlace / count);
    EXPECT_NEAR(low / count / expected, 1.0, 0.1);
}

TEST(Wcsph, ThesisModeRunsTheSameColumnAndKeepsEverythingInItsBox) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.04F, vec3(0.0F), vec3(0.4F, 0.6F, 0.4F));
    p.method = "wcsph_thesis";
    p.viscosity = 5.0e-3F;
    auto world = makeWorld(*device, p);
    for (int frame = 0; frame < 30; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_EQ(world->stats().lost, 0U);
    EXPECT_GT(world->stats().maxSpeed, 0.1);
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, world->particles().count)) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_GE(x[k], 0.0F);
            EXPECT_LE(x[k], 1.0F);
        }
    }
}

// Equation (6) as the thesis prints it has grad W_visc where Mueller's Laplacian belongs. A gradient points along r: read as
// (v_j - v_i) . grad W it gives no force at all between layers that shear past each other, which is what viscosity is for.
TEST(WcsphThesis, TheGradientPrintedInEquationSixCannotSlowAShear) {
    const dvec3 r(0, 0.02, 0), sheared(1, 0, 0);  // one layer above another, moving along x
    const double h = 0.04;
    auto printedGradient = [&](const dvec3& d) {  // of Mueller's W_visc
        const double l = glm::length(d), k = 15 / (2 * M_PI * std::pow(h, 3));
        return d * (k * (-1.5 * l / std::pow(h, 3) + 2 / (h * h) - h / (2 * std::pow(l, 3))));
    };
    EXPECT_NEAR(glm::dot(sheared, printedGradient(r)), 0.0, 1e-12);
    // Rivulet uses the Laplacian, a force along the velocity difference. Two particles, one sliding over the other.
    auto device = cpu();
    FluidParams p;
    p.method = "wcsph_thesis";
    p.spacing = 0.02F;
    p.viscosity = 1.0e-2F;
    p.gravity = vec3(0.0F);
    p.blocks = {{vec3(0.50F), vec3(0.52F), vec3(0.0F)}, {vec3(0.50F, 0.52F, 0.50F), vec3(0.52F, 0.54F, 0.52F), vec3(1.0F, 0.0F, 0.0F)}};
    auto world = makeWorld(*device, p);
    ASSERT_EQ(world->particles().count, 2U);
    world->step({vec3(0.0F)}, 1.0e-5);
    const auto v = device->readAll<vec4>(*world->particles().velocity, 2);
    const auto id = device->readAll<uint32_t>(*world->particles().id, 2);
    const float below = v[id[0] == 0 ? 0 : 1].x, above = v[id[0] == 0 ? 1 : 0].x;
    EXPECT_GT(below, 0.0F) << "dragged along";
    EXPECT_LT(above, 1.0F) << "held back";
    EXPECT_NEAR(below + above, 1.0F, 1e-6);
}

// ---- degenerate input ----

TEST(Wcsph, NoneOneAndTwoAtTheSamePointAreNoErrors) {
    auto device = cpu();
    FluidParams none{.method = "wcsph"};
    auto empty = makeWorld(*device, none);
    empty->step({none.gravity}, 1.0 / 60);
    EXPECT_EQ(empty->stats().particles, 0U);
    FluidParams two;
    two.blocks = {{vec3(0.5F), vec3(0.52F), vec3(0.0F)}, {vec3(0.5F), vec3(0.52F), vec3(0.0F)}};
    for (const char* method : {"wcsph", "wcsph_thesis"}) {
        two.method = method;
        auto world = makeWorld(*device, two);
        ASSERT_EQ(world->particles().count, 2U);
        for (int frame = 0; frame < 30; ++frame) world->step({two.gravity}, 1.0 / 60);
        EXPECT_EQ(world->stats().lost, 0U) << method;
        for (const vec4& x : device->readAll<vec4>(*world->particles().position, 2)) EXPECT_TRUE(isFinite(vec3(x))) << method;
    }
}

TEST(Wcsph, LostParticlesAreCountedFrozenAndReported) {
    auto device = cpu();
    std::string said;
    FluidParams p = boxOfWater(0.05F, vec3(0.0F), vec3(0.5F));
    auto made = FluidWorld::create(*device, p, {}, Log{[&](LogLevel, std::string_view text) { said += text; }});
    ASSERT_TRUE(made);
    FluidWorld& world = **made;
    const uint32_t n = world.particles().count;
    std::vector<vec4> x = device->readAll<vec4>(*world.particles().position, n);
    x[3] = vec4(std::numeric_limits<float>::quiet_NaN(), 0.2F, 0.2F, 1.0F);
    x[5] = vec4(40.0F, 0.2F, 0.2F, 1.0F);
    x[7] = vec4(0.2F, -std::numeric_limits<float>::infinity(), 0.2F, 1.0F);
    device->writeAll<vec4>(const_cast<Buffer&>(*world.particles().position), x);
    for (int frame = 0; frame < 10; ++frame) world.step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_EQ(world.stats().lost, 3U);
    EXPECT_EQ(world.stats().nan, 2U);
    EXPECT_NE(said.find("lost"), std::string::npos) << said;
    const auto after = device->readAll<vec4>(*world.particles().position, n);
    const auto id = device->readAll<uint32_t>(*world.particles().id, n);
    for (uint32_t i = 0; i < n; ++i) {
        if (id[i] == 5) {
            EXPECT_EQ(after[i].x, 40.0F) << "frozen where it was last seen";
        }
        if (id[i] != 3 && id[i] != 5 && id[i] != 7) {
            EXPECT_TRUE(isFinite(vec3(after[i])));
        }
    }
}

TEST(Wcsph, AFrameTooLongForItsSubstepsSlowsTimeInsteadOfGrowingSteps) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.05F, vec3(0.0F), vec3(0.3F));
    p.maxSubsteps = 5;
    p.longestFrame = 1;
    auto world = makeWorld(*device, p);
    world->step({.gravity = p.gravity}, 0.25);
    EXPECT_LT(world->time(), 0.02);
    ASSERT_EQ(world->stats().limited.size(), 1U);
    EXPECT_NE(world->stats().limited[0].find("maxSubsteps"), std::string::npos);
    EXPECT_EQ(world->stats().lost, 0U);
}

TEST(Wcsph, APlaneHoldsWaterOnItsNormalsSide) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.04F, vec3(0.0F), vec3(0.6F, 0.6F, 0.6F));
    const PlaneSolid slope{vec3(0.0F, 0.2F, 0.0F), vec3(0.3F, 1.0F, 0.0F)};
    auto world = makeWorld(*device, p, {.planes = {slope}});
    for (int frame = 0; frame < 30; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    const vec3 n = glm::normalize(slope.normal);
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, world->particles().count))
        EXPECT_GT(glm::dot(n, vec3(x) - slope.position), 0.4F * p.spacing);
}

// A block over a closed box: no particle is spawned in its walls or inside it, and all others are.
TEST(Wcsph, WhatAClosedMeshEnclosesStaysEmpty) {
    std::vector<vec3> corners;
    for (int k = 0; k < 8; ++k) corners.emplace_back((k & 1) != 0 ? 0.7F : 0.3F, (k & 2) != 0 ? 0.7F : 0.3F, (k & 4) != 0 ? 0.7F : 0.3F);
    const std::vector<uint32_t> triangles = {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                                             2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};
    const MeshView mesh{corners, triangles, {}, {}};
    auto field = bakeVoxelField(std::span(&mesh, 1), {.resolution = 32, .band = 0.1F, .padding = 0.12F});
    ASSERT_TRUE(field) << field.error().message;
    auto device = cpu();
    const FluidParams p = boxOfWater(0.04F, vec3(0.0F), vec3(1.0F));
    auto world = makeWorld(*device, p, {.field = &*field});
    const uint32_t n = world->particles().count;
    const float contact = fieldParams(*field, {.spacing = p.spacing}).contact, lo = 0.3F - contact, hi = 0.7F + contact;
    uint32_t expected = 0;
    for (int z = 0; z < 25; ++z)
        for (int y = 0; y < 25; ++y)
            for (int x = 0; x < 25; ++x) {
                const vec3 at = (vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) + 0.5F) * p.spacing;
                expected += at.x < lo || at.x > hi || at.y < lo || at.y > hi || at.z < lo || at.z > hi ? 1 : 0;
            }
    EXPECT_EQ(n, expected);
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, n))
        EXPECT_FALSE(x.x > 0.3F && x.x < 0.7F && x.y > 0.3F && x.y < 0.7F && x.z > 0.3F && x.z < 0.7F);
}

// A hollow ball with a wall: the hollow is not part of the solid, so a block fills it, and the wall stays empty.
TEST(Wcsph, AHollowOfAClosedMeshCanBeFilled) {
    test::Mesh ball = test::makeSphere(vec3(0.5F), 0.45F, 24);
    const test::Mesh hollow = test::makeSphere(vec3(0.5F), 0.3F, 24);
    for (size_t t = 0; t < hollow.indices.size(); t += 3)
        ball.triangle(hollow.positions[hollow.indices[t]], hollow.positions[hollow.indices[t + 2]],
                      hollow.positions[hollow.indices[t + 1]]);
    const MeshView mesh = ball.view();
    auto field = bakeVoxelField(std::span(&mesh, 1), {.resolution = 64, .band = 0.1F, .padding = 0.12F});
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_TRUE(field->closed);
    auto device = cpu();
    const FluidParams p = boxOfWater(0.04F, vec3(0.0F), vec3(1.0F));
    auto world = makeWorld(*device, p, {.field = &*field});
    size_t within = 0, outside = 0, wall = 0;
    const float contact = fieldParams(*field, {.spacing = p.spacing}).contact;
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, world->particles().count)) {
        const float r = glm::length(vec3(x) - 0.5F);
        within += r < 0.3F ? 1 : 0;
        outside += r > 0.45F ? 1 : 0;
        wall += r > 0.3F - 0.9F * contact && r < 0.45F ? 1 : 0;
    }
    EXPECT_EQ(wall, 0U);
    const float r = 0.3F - contact, cell = p.spacing * p.spacing * p.spacing;
    EXPECT_NEAR(static_cast<double>(within), 4.18879 * static_cast<double>(r * r * r / cell), 0.15 * static_cast<double>(within));
    EXPECT_GT(outside, 5000U);
}

TEST(Wcsph, ResetRestoresTheStartAndTheSameRun) {
    auto device = cpu();
    FluidParams p = boxOfWater(0.05F, vec3(0.0F), vec3(0.4F));
    auto world = makeWorld(*device, p);
    auto run = [&] {
        for (int frame = 0; frame < 5; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
        return device->readAll<vec4>(*world->particles().position, world->particles().count);
    };
    const auto first = run();
    world->reset();
    EXPECT_EQ(world->time(), 0.0);
    const auto second = run();
    for (size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i], second[i]);
}

TEST(Wcsph, ABoxTooLargeForItsSpacingIsRefusedWithTheSpacingThatFits) {
    auto device = cpu();
    FluidParams p{.method = "wcsph"};
    p.spacing = 0.001F;
    p.box.max = vec3(10.0F);
    p.box.periodicX = true;  // else the grid follows the particles
    auto world = FluidWorld::create(*device, p, {}, {});
    ASSERT_FALSE(world);
    EXPECT_NE(world.error().message.find("spacing of at least"), std::string::npos) << world.error().message;
    p.box.max = vec3(1.0F);
    p.box.periodicX = false;
    p.blocks = {{vec3(0.0F), vec3(1.0F), vec3(0.0F)}};
    p.spacing = 0.0006F;
    auto crowded = FluidWorld::create(*device, p, {}, {});
    ASSERT_FALSE(crowded);
    EXPECT_NE(crowded.error().message.find("million"), std::string::npos) << crowded.error().message;
}

}  // namespace
}  // namespace rivulet::sim_wcsph_test
