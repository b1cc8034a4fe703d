// The matter of particles in a saved state is checked before the state is restored.
#include <gtest/gtest.h>

#include <cstring>

#include "fluid/sim/sources/liquids.h"
#include "tests/physics/worlds.h"

namespace rivulet::state_matter_test {
namespace {

TEST(SavedMatter, InvalidMatterIsRefused) {
    FluidParams p;
    p.spacing = 0.1F;
    p.blocks = {{.min = vec3(0.1F), .max = vec3(0.5F), .liquid = "oil"}};
    Body body;
    body.shape = {.samples = {vec3(0.02F, 0, 0), vec3(-0.02F, 0, 0)}, .mass = 0.1F, .inertia = vec3(1.0e-4F), .volume = 1.0e-4F};
    body.state.pose.position = vec3(0.7F);
    auto device = cpu();
    auto world = makeWorld(*device, p, {.bodies = {body}});
    ASSERT_TRUE(world);
    WorldState good;
    world->save(good);
    const auto refusal = [&](size_t particle, int part, float value) -> std::string {
        WorldState state;
        for (const auto& [name, bytes] : good.sections()) {
            WorldState::Bytes copy = bytes;
            if (name == "particles.matter")
                std::memcpy(copy.data() + particle * sizeof(vec4) + static_cast<size_t>(part) * sizeof(float), &value, sizeof(float));
            state.putBytes(name, copy);
        }
        const Status done = world->restore(state);
        return done ? "" : done.error().message;
    };
    const size_t last = good.sections().at("particles.matter").size() / sizeof(vec4) - 1;  // a sample on the body
    const auto rows = static_cast<float>(liquids().rows.size());
    const float oil = liquidOf(p, "oil").row;
    EXPECT_EQ(refusal(3, 3, oil), "");
    EXPECT_EQ(refusal(last, 3, -1.0F), "");
    for (int part = 0; part < 4; ++part)
        for (const float wrong : {NAN, INFINITY, -INFINITY}) {
            EXPECT_NE(refusal(3, part, wrong).find("particle 3"), std::string::npos) << part << ' ' << wrong;
            EXPECT_NE(refusal(last, part, wrong), "") << part << ' ' << wrong;
        }
    for (const float row : {-1.0F, 0.5F, rows + 1, 1.0e9F}) EXPECT_NE(refusal(3, 3, row), "") << row;
    for (const float of : {0.0F, 1.0F, -2.0F, -1.5F, -1.0e9F}) EXPECT_NE(refusal(last, 3, of), "") << of;
    EXPECT_NE(refusal(3, 0, 0.0F), "") << "no volume";
    EXPECT_NE(refusal(3, 1, -1.0F), "") << "a density below 0";
    EXPECT_NE(refusal(3, 2, -1.0F), "") << "a viscosity below 0";
    EXPECT_EQ(refusal(3, 3, 0.0F), "") << "of the world's own liquid";
}

}  // namespace
}  // namespace rivulet::state_matter_test
