// Floating bodies and no-slip bodies against Archimedes, Stokes and Rayleigh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/validate/draught.h"
#include "tests/physics/worlds.h"

namespace rivulet::floating_test {
namespace {

struct Fluid {
    std::vector<vec4> position, velocity;
};
Fluid fluidOf(const FluidWorld& world) {
    const ParticleView view = world.particles();
    const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.slots),
                            v = world.device().readAll<vec4>(*view.velocity, view.slots);
    Fluid f;
    for (size_t i = 0; i < x.size(); ++i)
        if (x[i].w >= 0) {
            f.position.push_back(x[i]);
            f.velocity.push_back(v[i]);
        }
    return f;
}

// ---- Archimedes ----

struct Dropped {
    const char* method;
    double ratio;  // its density over the water's
    bool ball = false;
};
void PrintTo(const Dropped& f, std::ostream* out) { *out << f.method << (f.ball ? " ball " : " box ") << f.ratio; }

class Draught : public testing::TestWithParam<Dropped> {};

TEST_P(Draught, TheDisplacedWaterWeighsAsMuchAsTheBody) {
    const Dropped& what = GetParam();
    const float s = 0.0125F;
    // A cube of half the density of water would tilt: this box is 1.5 times as wide as high.
    const vec3 size = what.ball ? vec3(10 * s) : vec3(12 * s, 8 * s, 12 * s);
    const double height = double{size.y}, volume = what.ball ? M_PI / 6 * height * height * height : double{size.x * size.y * size.z};
    Floater floater{height, volume, 0, what.ball};
    double draught = 0;
    while (floater.shareUnder(draught) < what.ratio && draught < height) draught += 1.0e-5 * height;
    // At a support of 2 spacings, from a lattice; and at default settings.
    for (const bool lattice : {true, false}) {
        FluidParams p;
        p.method = what.method;
        p.spacing = s;
        if (lattice) p.supportSpacings = 2;
        p.box.max = vec3(24 * s, 0.4F, 24 * s);
        p.box.periodicX = p.box.periodicZ = true;  // no walls, so no gap between water and walls
        p.soundSpeed = 15;
        p.cfl = 0.8F;
        p.artificialViscosity = 0.05F;
        const double area = double{p.box.max.x * p.box.max.z};
        const double level = std::ceil(draught / double{s} + 4.999) * double{s};  // five spacings below its keel
        p.blocks = {{vec3(0.0F), vec3(p.box.max.x, static_cast<float>(level), p.box.max.z), vec3(0.0F)}};
        if (lattice) p.blocks[0].jitter = 0;
        Body body;
        body.shape = what.ball ? sphereShape(0.5F * size.y, 1000 * what.ratio, s) : boxShape(size, 1000 * what.ratio, s);
        // Dropped from six spacings above equilibrium: particles at rest lie in layers, and a flat keel that is set down gently stays on a
        // layer, up to half a spacing too high or too low. The splash destroys the layers.
        const float drop = (what.ball ? 2 : 6) * s;
        body.state.pose.position = vec3(0.5F * p.box.max.x, static_cast<float>(level - draught + 0.5 * height) + drop, 0.5F * p.box.max.z);
        auto device = cpu();
        auto world = makeWorld(*device, p, {.bodies = {body}});
        ASSERT_TRUE(world);
        double under = 0, tilt = 0, moved = 0;
        constexpr int kFrames = 110, kLast = 45;
        for (int frame = 0; frame < kFrames; ++frame) {
            world->step({.gravity = p.gravity}, 1.0 / 60);
            if (frame < kFrames - kLast) continue;
            const BodyState& b = world->bodies()[0];
            floater.keel = double{b.pose.position.y} - 0.5 * height;
            const double top = waterLevel(waterVolume(fluidOf(*world).position, double{s}), area, std::span(&floater, 1));
            under += floater.shareUnder(top - floater.keel) / kLast;
            tilt = std::max(tilt, 1 - double{(b.pose.rotation * vec3(0, 1, 0)).y});
            moved = std::max(moved, double{glm::length(b.velocity)});
        }
        std::printf("%s %s %g: under %.4f (%+.2f %%), tilt %.1e, speed %.3f\n", what.method, what.ball ? "ball" : "box", what.ratio, under,
                    100 * (under / what.ratio - 1), tilt, moved);
        // These boxes are 8 spacings high, and at the default support their keels stand off the water by a part of a spacing:
        // docs/decisions/0021. Larger ones float closer to their depth (rivulet validate floating).
        EXPECT_NEAR(under * height / double{s}, what.ratio * height / double{s}, lattice ? 0.15 : 0.4) << "of a spacing";
        if (!what.ball) EXPECT_LT(tilt, 0.01) << "it floats upright";
        EXPECT_EQ(world->stats().lost, 0U);
    }
}

INSTANTIATE_TEST_SUITE_P(Bodies, Draught,
                         testing::Values(Dropped{"wcsph", 0.25}, Dropped{"wcsph", 0.5}, Dropped{"wcsph", 0.75}, Dropped{"wcsph", 0.5, true},
                                         Dropped{"pbf", 0.5}, Dropped{"dfsph", 0.5}),
                         [](const auto& row) {
                             return std::string(row.param.method) + (row.param.ball ? "_ball_" : "_box_") +
                                    std::to_string(static_cast<int>(100 * row.param.ratio));
                         });

// A ball with the density of water keeps its position.
TEST(Neutral, ABallOfTheDensityOfWaterKeepsItsHeight) {
    for (const char* method : {"wcsph", "dfsph"}) {
        const float s = 0.0125F;
        FluidParams p;
        p.method = method;
        p.spacing = s;
        p.box.max = vec3(16 * s, 0.3F, 16 * s);
        p.box.periodicX = p.box.periodicZ = true;
        p.soundSpeed = 20;
        p.cfl = 0.8F;
        p.artificialViscosity = 0.05F;
        p.blocks = {{vec3(0.0F), vec3(16 * s, 16 * s, 16 * s), vec3(0.0F)}};
        Body body;
        body.shape = sphereShape(4 * s, 1000, s);
        body.state.pose.position = vec3(8 * s);
        auto device = cpu();
        auto world = makeWorld(*device, p, {.bodies = {body}});
        ASSERT_TRUE(world);
        for (int frame = 0; frame < 30; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
        const double sunk = 8 - double{world->bodies()[0].pose.position.y / s};
        std::printf("%s: sunk by %.3f spacings\n", method, sunk);
        // With a net force of 3 % of its weight, and added mass, it would move two spacings.
        EXPECT_LT(std::abs(sunk), 2.0) << method;
        EXPECT_EQ(world->stats().lost, 0U);
    }
}

// ---- no-slip bodies ----

class Sticking : public testing::TestWithParam<const char*> {};

// A plate at the bottom of water at rest begins to slide (Rayleigh 1911; Stokes's first problem): without slip u = U erfc(y / sqrt(4 nu
// t)), y from the surface, half a spacing above the samples; with slip u = 0.
TEST_P(Sticking, APlateDragsWaterOnlyWithoutSlip) {
    const double nu = 0.05, speed = 0.1;
    for (const float sticks : {1.0F, 0.0F}) {
        FluidParams p;
        p.method = GetParam();
        p.spacing = 0.02F;
        p.viscosity = static_cast<float>(nu);
        p.artificialViscosity = 0;
        p.soundSpeed = 4;
        p.gravity = vec3(0.0F);
        p.box.max = vec3(0.16F, 0.8F, 0.16F);
        p.box.periodicX = p.box.periodicZ = true;
        p.blocks = {{vec3(0.0F, 0.1F, 0.0F), vec3(0.16F, 0.7F, 0.16F), vec3(0.0F)}};
        Body plate;  // of one layer of samples, from side to side
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 8; ++k)
                plate.shape.samples.emplace_back(0.02F * (static_cast<float>(i) - 3.5F), -0.01F, 0.02F * (static_cast<float>(k) - 3.5F));
        plate.shape.sticks = sticks;
        plate.state.pose.position = vec3(0.08F, 0.1F, 0.08F);
        plate.state.velocity = vec3(static_cast<float>(speed), 0.0F, 0.0F);
        BodyHost sliding;  // prescribes the motion
        sliding.reset = [](void*, std::span<const BodyState>) {};
        sliding.advance = [](void*, std::span<const BodyLoad>, const vec3&, double seconds, std::span<BodyState> states) {
            states[0].pose.position += states[0].velocity * static_cast<float>(seconds);
        };
        auto device = cpu();
        auto world = makeWorld(*device, p, {.bodies = {plate}, .bodyHost = sliding});
        ASSERT_TRUE(world);
        for (int frame = 0; frame < 24; ++frame) world->step({p.gravity}, 1.0 / 120);
        const Fluid f = fluidOf(*world);
        double error = 0, whole = 0, fastest = 0;
        for (size_t i = 0; i < f.position.size(); ++i) {
            const double u = speed * std::erfc((double{f.position[i].y} - 0.1) / std::sqrt(4 * nu * world->time()));
            error += std::pow(double{f.velocity[i].x} - u, 2);
            whole += u * u;
            fastest = std::max(fastest, std::abs(double{f.velocity[i].x}));
        }
        std::printf("%s %g: error %.4f, fastest %.4f\n", GetParam(), double{sticks}, std::sqrt(error / whole), fastest / speed);
        if (sticks > 0)
            EXPECT_LT(std::sqrt(error / whole), 0.05);
        else
            EXPECT_LT(fastest, 0.05 * speed);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, Sticking, testing::Values("wcsph", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::floating_test
