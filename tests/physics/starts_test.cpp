// The water of a world at t = 0: shapes and velocities of blocks; against formulas of
// geometry and mechanics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/sources/block.h"
#include "tests/physics/worlds.h"

namespace rivulet::starts_test {
namespace {

std::vector<NewParticle> filled(const BlockParams& block, float spacing) {
    std::vector<NewParticle> made;
    fillBlock(block, spacing, made);
    return made;
}

// m^3, of all particles
double volumeOf(const std::vector<NewParticle>& particles, float spacing) {
    return static_cast<double>(particles.size()) * std::pow(double{spacing}, 3);
}

class Shapes : public testing::TestWithParam<const char*> {
  protected:
    int axis() const { return GetParam()[0] - 'x'; }
    // Half its width, half its depth, its height along the axis, m.
    BlockParams block(const char* shape, float a, float b, float height) const {
        BlockParams p{.min = vec3(0.3F, -0.2F, 1.0F), .shape = shape, .axis = GetParam()};
        p.max = p.min;
        p.max[axis()] += height;
        p.max[(axis() + 1) % 3] += 2 * a;
        p.max[(axis() + 2) % 3] += 2 * b;
        return p;
    }
};

// Radii that are no multiples of the spacing, too: the sites within the ellipse would be up to 0.7 % too many.
TEST_P(Shapes, ACylinderHasItsVolume) {
    constexpr float spacing = 0.01F;
    for (float radius = 0.19F; radius < 0.26F; radius += 0.0013F) {
        const BlockParams b = block("cylinder", radius, 1.2F * radius, 0.3F);
        const std::vector<NewParticle> made = filled(b, spacing);
        EXPECT_NEAR(volumeOf(made, spacing) / (double{kPi} * radius * 1.2 * radius * 0.3), 1, 0.001) << radius;
        const vec3 middle = 0.5F * (b.min + b.max);
        for (const NewParticle& p : made) {
            vec3 r = (p.position - middle) / (0.5F * (b.max - b.min) + 0.25F * spacing);
            EXPECT_LT(std::abs(r[axis()]), 1);
            r[axis()] = 0;
            ASSERT_LT(glm::length(r), 1) << "a particle is a quarter of a spacing outside";
        }
    }
}

// Its volume, and its centre of mass at a quarter of its height above the base.
TEST_P(Shapes, AConeHasItsVolumeAndCentreOfMass) {
    constexpr float spacing = 0.01F;
    for (const float radius : {0.2F, 0.2037F, 0.2471F}) {
        const BlockParams b = block("cone", radius, 0.9F * radius, 0.4F);
        const std::vector<NewParticle> made = filled(b, spacing);
        EXPECT_NEAR(volumeOf(made, spacing) / (double{kPi} * radius * 0.9 * radius * 0.4 / 3), 1, 0.001) << radius;
        dvec3 sum(0.0);
        for (const NewParticle& p : made) sum += dvec3(p.position);
        const dvec3 centre = sum / static_cast<double>(made.size());
        dvec3 expected = 0.5 * (dvec3(b.min) + dvec3(b.max));
        expected[axis()] = double{b.min[axis()]} + 0.1;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(centre[k], expected[k], 0.001) << k;
    }
}

INSTANTIATE_TEST_SUITE_P(EachAxis, Shapes, testing::Values("x", "y", "z"));

// A cylinder that turns about its axis and moves: momentum m v, angular momentum and energy of a rigid body with I = m r^2 / 2.
TEST(Start, SpinIsARigidRotation) {
    constexpr float spacing = 0.01F, radius = 0.2F, rate = 7;
    const BlockParams b{.min = vec3(0.1F),
                        .max = vec3(0.1F + 2 * radius, 0.3F, 0.1F + 2 * radius),
                        .velocity = vec3(1, -2, 0.5F),
                        .shape = "cylinder",
                        .spin = vec3(0, rate, 0)};
    const dvec3 middle = 0.5 * dvec3(b.min + b.max);
    const std::vector<NewParticle> made = filled(b, spacing);
    const auto mass = static_cast<double>(made.size());
    dvec3 momentum(0.0), turning(0.0);
    double energy = 0;
    for (const NewParticle& p : made) {
        momentum += dvec3(p.velocity);
        const dvec3 u = dvec3(p.velocity) - dvec3(b.velocity);
        turning += glm::cross(dvec3(p.position) - middle, u);
        energy += 0.5 * glm::dot(u, u);
    }
    const double inertia = 0.5 * mass * radius * radius;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(momentum[k] / mass, double{b.velocity[k]}, 0.002 * radius * rate);
    EXPECT_NEAR(turning.y / (inertia * rate), 1, 0.005);
    EXPECT_LT(std::max(std::abs(turning.x), std::abs(turning.z)), 0.005 * turning.y);
    EXPECT_NEAR(energy / (0.5 * inertia * rate * rate), 1, 0.005);
    const double rim = glm::length(vec3(1, 0, 0.5F)) + std::sqrt(2.0) * radius * rate;
    EXPECT_LT(fastestOf(b), std::hypot(rim, 2)) << "a corner of the box is the fastest point that a block can have";
    for (const NewParticle& p : made) EXPECT_LE(glm::length(p.velocity), fastestOf(b));
}

// The velocity along each axis, fitted by least squares over the particles: the slope is the requested gradient. Each row is its own.
TEST(Start, GradientsAreThoseOfTheVelocity) {
    const BlockParams b{.min = vec3(-0.1F, 0.2F, 0.3F),
                        .max = vec3(0.3F, 0.5F, 0.5F),
                        .velocity = vec3(0.5F, 0, -1),
                        .gradientX = vec3(0, 3, -1),
                        .gradientY = vec3(2, 0.5F, 4),
                        .gradientZ = vec3(-5, 1, -0.5F)};
    const std::vector<NewParticle> made = filled(b, 0.02F);
    const vec3 rows[] = {b.gradientX, b.gradientY, b.gradientZ};
    for (int of = 0; of < 3; ++of) {
        double mean = 0;
        for (const NewParticle& p : made) mean += double{p.velocity[of]} / static_cast<double>(made.size());
        EXPECT_NEAR(mean, double{b.velocity[of]}, 1e-4);
        for (int along = 0; along < 3; ++along) {
            double product = 0, square = 0;
            for (const NewParticle& p : made) {
                const double r = double{p.position[along]} - 0.5 * double{b.min[along] + b.max[along]};
                product += r * double{p.velocity[of]};
                square += r * r;
            }
            EXPECT_NEAR(product / square, double{rows[of][along]}, 1e-3) << of << along;
        }
    }
}

// The world starts with this motion: its energy is that of the rotation, and its steps are short enough for the fastest particle.
TEST(Start, AWorldStartsWithTheSpinOfItsBlock) {
    FluidParams p;
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = vec3(0.3F), .max = vec3(0.7F), .shape = "cylinder", .spin = vec3(0, 10, 0)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    EXPECT_GE(world->fastestFall(), 2) << "the rim, 0.2 m from the axis";
    const double mass = static_cast<double>(world->particles().count) * 1000 * 8.0e-6;
    world->step({}, 1.0e-4);
    EXPECT_NEAR(world->stats().kinetic / (0.25 * mass * 0.04 * 100), 1, 0.02);
    EXPECT_NEAR(world->stats().maxSpeed, 2, 0.05);
    world->reset();
    world->step({}, 1.0e-4);
    EXPECT_NEAR(world->stats().maxSpeed, 2, 0.05);
}

}  // namespace
}  // namespace rivulet::starts_test
