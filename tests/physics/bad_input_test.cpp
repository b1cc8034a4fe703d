// Invalid input of a host that no file could contain: it is refused with an error that names it, and never causes a crash, a hang or a
// corrupt world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/physics/worlds.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::bad_input_test {
namespace {

FluidParams sound() {
    FluidParams p;
    p.spacing = 0.05F;
    p.blocks = {{vec3(0.1F), vec3(0.5F), vec3(0.0F)}};
    return p;
}

std::string refusal(const FluidParams& params, const Solids& solids = {}, const Sources& sources = {}) {
    auto device = cpu();
    auto world = FluidWorld::create(*device, params, solids, {}, sources);
    if (world) return "";
    EXPECT_EQ(world.error().fault, Fault::badInput) << world.error().message;
    return world.error().message;
}

TEST(BadInput, AParamOutOfItsRangeIsNamed) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const std::pair<const char*, std::function<void(FluidParams&)>> wrong[] = {
        {"fluid.spacing", [](FluidParams& p) { p.spacing = -1; }},
        {"fluid.spacing", [=](FluidParams& p) { p.spacing = nan; }},
        {"fluid.spacing", [](FluidParams& p) { p.spacing = 0; }},
        {"fluid.supportSpacings", [](FluidParams& p) { p.supportSpacings = 0; }},
        {"fluid.maxSubsteps", [](FluidParams& p) { p.maxSubsteps = -4; }},
        {"fluid.method", [](FluidParams& p) { p.method = "flip"; }},
        {"fluid.kernel", [](FluidParams& p) { p.kernel = "gauss"; }},
        {"fluid.gravity", [=](FluidParams& p) { p.gravity.y = nan; }},
        {"fluid.restDensity", [](FluidParams& p) { p.restDensity = 0; }},
        {"fluid.pbf.iterations", [](FluidParams& p) { p.pbf.iterations = 0; }},
        {"fluid.forces.tension", [=](FluidParams& p) { p.forces.tension = inf; }},
        {"fluid.box.min", [](FluidParams& p) { std::swap(p.box.min, p.box.max); }},
        {"fluid.box.max", [=](FluidParams& p) { p.box.max.z = nan; }},
        {"fluid.box.min", [](FluidParams& p) { p.box.max.y = p.box.min.y; }},
        {"fluid.blocks[0].velocity", [=](FluidParams& p) { p.blocks[0].velocity.x = inf; }},
        {"fluid.blocks[0].spin", [=](FluidParams& p) { p.blocks[0].spin.z = nan; }},
        {"fluid.blocks[0].axis", [](FluidParams& p) { p.blocks[0].axis = "w"; }},
        {"fluid.blocks[1].shape", [](FluidParams& p) { p.blocks.push_back({.shape = "torus"}); }},
    };
    for (const auto& [name, spoil] : wrong) {
        FluidParams p = sound();
        spoil(p);
        const std::string said = refusal(p);
        EXPECT_TRUE(said.starts_with(std::string(name) + " ")) << name << ": " << said;
    }
    EXPECT_EQ(refusal(sound()), "");
}

TEST(BadInput, InvalidInputLeavesAWorldUnchanged) {
    auto device = cpu();
    auto world = makeWorld(*device, sound());
    FluidParams p = sound();
    p.viscosity = std::numeric_limits<float>::quiet_NaN();
    p.cfl = 0.1F;
    EXPECT_FALSE(world->setParams(p));
    EXPECT_EQ(world->params().viscosity, sound().viscosity);
    EXPECT_EQ(world->params().cfl, sound().cfl);
    EXPECT_FALSE(world->setSurfaces(std::vector<Surface>{{.friction = NAN}}));
    EXPECT_FALSE(world->setSurfaces(std::vector<Surface>{{.restitution = 7}}));
    EXPECT_TRUE(world->setSurfaces(std::vector<Surface>{{.friction = 0.5F, .restitution = -1}}));
    world->step({.gravity = vec3(0, NAN, 0)}, 1.0 / 60);
    EXPECT_NE(std::find_if(world->stats().limited.begin(), world->stats().limited.end(),
                           [](const std::string& s) { return s.find("gravity") != std::string::npos; }),
              world->stats().limited.end());
    EXPECT_EQ(world->stats().nan, 0U);
    EXPECT_LT(world->stats().centreOfMass[1], 0.3) << "it falls by the gravity it had";
}

TEST(BadInput, EmittersAndSinksAreNamed) {
    EmitterParams faint;
    faint.litresPerSecond = -3;
    EXPECT_TRUE(refusal(sound(), {}, {.emitters = {{faint, {}}}}).starts_with("emitters[0].litresPerSecond "));
    EmitterParams lost;
    lost.position.x = NAN;
    EXPECT_TRUE(refusal(sound(), {}, {.emitters = {{EmitterParams{}, {}}, {lost, {}}}}).starts_with("emitters[1].position "));
    EXPECT_TRUE(refusal(sound(), {}, {.sinks = {{.radius = -1}}}).starts_with("sinks[0].radius "));
    EXPECT_NE(refusal(sound(), {}, {.seconds = std::numeric_limits<double>::quiet_NaN()}), "");
    EXPECT_NE(refusal(sound(), {}, {.expectedDeposit = -1}), "");
}

TEST(BadInput, SolidsAreNamed) {
    EXPECT_NE(refusal(sound(), {.planes = {{.normal = vec3(NAN, 1, 0)}}}), "");
    EXPECT_NE(refusal(sound(), {.planes = {{.position = vec3(INFINITY)}}}), "");
    EXPECT_NE(refusal(sound(), {.planes = {{.surface = 99}}}), "");
    EXPECT_NE(refusal(sound(), {.surfaces = {{.friction = NAN}}}), "");
    EXPECT_NE(refusal(sound(), {.deforming = {nullptr}}), "");

    // A band so narrow that a particle could cross it between two tests.
    const test::Mesh ball = test::makeSphere(vec3(0.5F), 0.05F);
    const MeshView views[] = {ball.view()};
    Result<VoxelField> field = bakeVoxelField(views, {.resolution = 128});
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_NE(refusal(sound(), {.field = &*field}).find("band"), std::string::npos);
    EXPECT_NE(refusal(sound(), {.rigid = {{.field = &*field, .pose = {}}}}).find("band"), std::string::npos);
    field = bakeVoxelField(views, {.resolution = 128, .band = 0.1F, .padding = 0.1F});
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_EQ(refusal(sound(), {.field = &*field}), "");
}

Body pebble() {
    Body body;
    body.shape = {.samples = {vec3(0.02F, 0, 0), vec3(-0.02F, 0, 0)}, .mass = 0.1F, .inertia = vec3(1.0e-4F), .volume = 1.0e-4F};
    body.state.pose.position = vec3(0.7F);
    return body;
}

TEST(BadInput, BodiesAndTheirHostAreNamed) {
    Body hollow = pebble();
    hollow.shape.volume = -1;
    EXPECT_TRUE(refusal(sound(), {.bodies = {hollow}}).starts_with("body 0 displaces"));
    const auto half = [](void*, std::span<const BodyLoad>, const vec3&, double, std::span<BodyState>) {};
    EXPECT_NE(refusal(sound(), {.bodies = {pebble()}, .bodyHost = {.advance = half}}).find("advance and reset"), std::string::npos);

    const auto mad = [](void*, std::span<const BodyLoad>, const vec3&, double, std::span<BodyState> states) {
        states[0].pose.position.y = std::numeric_limits<float>::quiet_NaN();
    };
    const auto reset = [](void*, std::span<const BodyState>) {};
    auto device = cpu();
    auto world = makeWorld(*device, sound(), {.bodies = {pebble()}, .bodyHost = {.advance = mad, .reset = reset}});
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->bodies()[0].pose.position, vec3(0.7F));
    EXPECT_NE(std::find_if(world->stats().limited.begin(), world->stats().limited.end(),
                           [](const std::string& s) { return s.find("body 0") != std::string::npos; }),
              world->stats().limited.end());
}

}  // namespace
}  // namespace rivulet::bad_input_test
