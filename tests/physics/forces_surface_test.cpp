// Surface forces against geometry and conservation: normals of a cube and a pool, a cube that becomes a ball, drops on walls, vortices,
// wind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/physics/worlds.h"

namespace rivulet::forces_surface_test {
namespace {

struct State {
    std::vector<vec4> position, velocity, normal;
};
State state(const FluidWorld& world) {
    const ParticleView v = world.particles();
    Device& device = world.device();
    return {device.readAll<vec4>(*v.position, v.count), device.readAll<vec4>(*v.velocity, v.count),
            v.normal != nullptr ? device.readAll<vec4>(*v.normal, v.count) : std::vector<vec4>{}};
}

double degreesBetween(const vec3& a, const vec3& b) {
    return std::acos(std::clamp(double{glm::dot(glm::normalize(a), glm::normalize(b))}, -1.0, 1.0)) * 180 / M_PI;
}

class Normals : public testing::TestWithParam<const char*> {};

TEST_P(Normals, OfTheFacesOfACubeAreItsAxes) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.forces.normals = GetParam();
    p.blocks = {{vec3(0.3F), vec3(0.7F), vec3(0.0F)}};
    p.blocks[0].jitter = 0;
    auto world = makeWorld(*device, p);
    world->step({vec3(0.0F)}, 1.0e-4);
    const State s = state(*world);
    ASSERT_EQ(s.normal.size(), 8000U);
    int faces = 0, inside = 0;
    double worst = 0, length = 0, rest = 0;
    for (size_t i = 0; i < s.position.size(); ++i) {
        // Depth below the nearest face of each axis; only particles far from the edges.
        const vec3 fromCentre = vec3(s.position[i]) - 0.5F;
        int outer = 0, axis = 0, deep = 0;
        for (int k = 0; k < 3; ++k) {
            const float depth = 0.2F - std::abs(fromCentre[k]);
            if (depth < 0.015F) {
                ++outer;
                axis = k;
            }
            if (depth > 0.05F) ++deep;
        }
        if (outer == 1 && deep == 2) {
            ++faces;
            vec3 out(0.0F);
            out[axis] = fromCentre[axis] < 0 ? -1.0F : 1.0F;
            worst = std::max(worst, degreesBetween(vec3(s.normal[i]), out));
            length += double{s.normal[i].w};
        }
        if (deep == 3) {
            ++inside;
            rest = std::max(rest, double{s.normal[i].w});
        }
    }
    EXPECT_GT(faces, 1000);
    EXPECT_GT(inside, 1000);
    EXPECT_LT(worst, 1.0) << "degrees";
    EXPECT_NEAR(length / faces, 1.0, 0.01) << "a flat surface's has length 1";
    EXPECT_LT(rest, 1.0e-3) << "inside there is none";
}

INSTANTIATE_TEST_SUITE_P(Kinds, Normals, testing::Values("thesis", "gradient"), [](const auto& row) { return std::string(row.param); });

TEST(Normals, CoincidentParticlesAndSprayAreFinite) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.forces.normals = "thesis";
    p.forces.thesisTension = -5.0F;
    // Two blocks in the same place, and one particle alone.
    p.blocks = {{vec3(0.3F), vec3(0.4F), vec3(0.0F)}, {vec3(0.3F), vec3(0.4F), vec3(0.0F)}, {vec3(0.8F), vec3(0.82F), vec3(0.0F)}};
    auto world = makeWorld(*device, p);
    world->step({vec3(0.0F)}, 1.0e-4);
    const State s = state(*world);
    double longest = 0;
    vec4 spray(0.0F);
    for (size_t i = 0; i < s.position.size(); ++i) {
        ASSERT_TRUE(std::isfinite(s.normal[i].x + s.normal[i].y + s.normal[i].z + s.normal[i].w)) << i;
        ASSERT_TRUE(std::isfinite(s.velocity[i].x + s.velocity[i].y + s.velocity[i].z)) << i;
        if (s.position[i].x > 0.7F)
            spray = s.normal[i];
        else
            longest = std::max(longest, double{glm::length(vec3(s.normal[i]))});
    }
    EXPECT_EQ(spray.x, 0.0F);
    EXPECT_EQ(spray.z, 0.0F);
    EXPECT_GT(-double{spray.y}, longest);
}

// Ratio of the largest to the smallest extent of a cloud in 26 directions: 1 for a ball, 1.7 for a cube.
double outOfRound(const std::vector<vec4>& x) {
    double centre[3] = {0, 0, 0};
    for (const vec4& p : x)
        for (int k = 0; k < 3; ++k) centre[k] += double{p[k]} / static_cast<double>(x.size());
    // Without the farthest hundredth.
    double least = 1.0e9, most = 0;
    for (int dx = -1; dx <= 1; ++dx)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dz = -1; dz <= 1; ++dz) {
                const double n = std::sqrt(double(dx * dx + dy * dy + dz * dz));
                if (n == 0) continue;
                std::vector<double> reach;
                for (const vec4& p : x)
                    reach.push_back((dx * (double{p.x} - centre[0]) + dy * (double{p.y} - centre[1]) + dz * (double{p.z} - centre[2])) / n);
                std::nth_element(reach.begin(), reach.end() - static_cast<std::ptrdiff_t>(reach.size() / 100), reach.end());
                const double r = reach[reach.size() - reach.size() / 100];
                least = std::min(least, r);
                most = std::max(most, r);
            }
    return most / least;
}

TEST(Tension, ACubeBecomesABallAndMomentaStay) {
    auto device = cpu();
    FluidParams p;
    p.method = "wcsph";
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.viscosity = 2.0e-3F;
    p.forces.tension = 1.0F;
    p.blocks = {{vec3(0.4F, 0.4F, 0.4F), vec3(0.6F, 0.6F, 0.6F), vec3(0.0F)}};
    auto world = makeWorld(*device, p);
    const double before = outOfRound(state(*world).position);
    EXPECT_GT(before, 1.4);
    double scale = 0, turned = 0;
    // Its corners oscillate (n = 4) with a period of 1.02 s by Lamb 1932, and decay in about the same time.
    for (int frame = 0; frame < 60; ++frame) {
        world->step({vec3(0.0F)}, 1.0 / 60);
        const State s = state(*world);
        double speeds = 0, arms = 0;
        for (size_t i = 0; i < s.position.size(); ++i) {
            speeds += double{glm::length(vec3(s.velocity[i]))};
            arms += double{glm::length(vec3(s.velocity[i]))} * double{glm::length(vec3(s.position[i]) - 0.5F)};
        }
        scale = std::max(scale, speeds);
        turned = std::max(turned, arms);
    }
    const State s = state(*world);
    double momentum[3] = {0, 0, 0}, spin[3] = {0, 0, 0};
    for (size_t i = 0; i < s.position.size(); ++i) {
        const vec3 r = vec3(s.position[i]) - 0.5F, v(s.velocity[i]), l = glm::cross(r, v);
        for (int k = 0; k < 3; ++k) {
            momentum[k] += double{v[k]};
            spin[k] += double{l[k]};
        }
    }
    EXPECT_LT(outOfRound(s.position), 1.1);
    EXPECT_LT(std::hypot(momentum[0], momentum[1], momentum[2]) / scale, 1.0e-5);
    EXPECT_LT(std::hypot(spin[0], spin[1], spin[2]) / turned, 2.0e-5) << "the force is central";
    EXPECT_EQ(world->stats().nan, 0U);
}

TEST(Tension, AdhesionSpreadsADropOnTheFloor) {
    auto device = cpu();
    double width[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
        FluidParams p;
        p.method = "dfsph";
        p.spacing = 0.02F;
        p.gravity = vec3(0.0F, -0.5F, 0.0F);
        p.viscosity = 5.0e-3F;
        p.forces.tension = 1.0F;
        p.forces.adhesion = k == 0 ? 0.0F : 2.0F;
        p.blocks = {{vec3(0.42F, 0.0F, 0.42F), vec3(0.58F, 0.16F, 0.58F), vec3(0.0F)}};
        auto world = makeWorld(*device, p);
        for (int frame = 0; frame < 60; ++frame) world->step({p.gravity}, 1.0 / 60);
        const State s = state(*world);
        int onFloor = 0;
        for (const vec4& x : s.position) {
            ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
            if (x.y < 0.015F) ++onFloor;
        }
        width[k] = std::sqrt(onFloor);
    }
    EXPECT_GT(width[1], 1.2 * width[0]);
}

TEST(Air, ALoneDropFallsAsFastAsItsDragLets) {
    auto device = cpu();
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.forces.airDrag = 0.47F;
    p.forces.wind = vec3(0.0F, 5.0F, 0.0F);
    p.blocks = {{vec3(0.5F, 0.1F, 0.5F), vec3(0.52F, 0.12F, 0.52F), vec3(0.0F)}};
    auto world = makeWorld(*device, p);
    ASSERT_EQ(world->particles().count, 1U);
    for (int frame = 0; frame < 120; ++frame) world->step({vec3(0.0F)}, 1.0 / 240);
    // u' = -k u^2 for the velocity u relative to the wind; a sphere of the particle's volume.
    const double radius = 0.02 * std::cbrt(3 / (4 * M_PI)), k = 0.5 * 1.2 * 0.47 * M_PI * radius * radius / (1000 * 8.0e-6);
    const double expected = 5 - 5 / (1 + k * 5 * world->time());
    EXPECT_NEAR(double{state(*world).velocity[0].y} / expected, 1.0, 0.01);
}

TEST(Vorticity, ConfinementSustainsAVortex) {
    auto device = cpu();
    double energy[2] = {0, 0};
    for (int k = 0; k < 2; ++k) {
        FluidParams p;
        p.method = "dfsph";
        p.spacing = 0.05F;
        p.gravity = vec3(0.0F);
        p.viscosity = 1.0e-3F;
        p.forces.vorticity = k == 0 ? 0.0F : 0.5F;
        p.box.max = vec3(0.8F, 0.25F, 0.8F);
        p.box.periodicY = true;
        p.blocks = {{p.box.min, p.box.max, vec3(0.0F)}};
        auto world = makeWorld(*device, p);
        State s = state(*world);
        for (size_t i = 0; i < s.position.size(); ++i) {
            // Along the walls at the walls.
            const float x = kPi * s.position[i].x / 0.8F, z = kPi * s.position[i].z / 0.8F;
            s.velocity[i] = 0.5F * vec4(std::sin(x) * std::cos(z), 0.0F, -std::cos(x) * std::sin(z), 0.0F);
        }
        device->writeAll<vec4>(const_cast<Buffer&>(*world->particles().velocity), s.velocity);
        for (int frame = 0; frame < 30; ++frame) world->step({vec3(0.0F)}, 1.0 / 60);
        energy[k] = world->stats().kinetic;
    }
    EXPECT_GT(energy[1], 1.1 * energy[0]);
    EXPECT_LT(energy[1], 10 * energy[0]);
}

}  // namespace
}  // namespace rivulet::forces_surface_test
