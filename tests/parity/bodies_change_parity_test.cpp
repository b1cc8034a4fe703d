// Bodies that are added and removed: the same on every device.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::bodies_change_parity_test {
namespace {

struct Outcome {
    size_t before = 0, after = 0;
    dvec3 centre{0.0};
    double drained = 0;  // m^3
    std::vector<BodyState> bodies;
    std::vector<uint32_t> ids;
};

// A fixed block appears in a pool, two boxes fall into it, and one of them is removed before a third comes where its samples were.
Outcome run(Device& device) {
    FluidParams p{.method = "pbf"};
    p.spacing = 0.05F;
    p.box.max = vec3(0.6F, 0.8F, 0.6F);
    p.maxBodySamples = 400;
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.6F, 0.25F, 0.6F)}};
    auto world = FluidWorld::create(device, p, {}, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    const auto steps = [&](int count) {
        for (int k = 0; k < count; ++k) (*world)->step({}, 1.0 / 120);
        device.finish();
        device.poll();
    };
    const auto add = [&](const vec3& place, const vec3& size, double density) {
        Body body;
        body.shape = boxShape(size, density, p.spacing);
        body.state.pose.position = place;
        const Result<uint32_t> id = (*world)->addBody(body);
        EXPECT_TRUE(id) << (id ? "" : id.error().message);
        return id ? *id : UINT32_MAX;
    };
    steps(3);
    Outcome out;
    out.before = positions(**world).size();
    add(vec3(0.3F, 0.1F, 0.3F), vec3(0.2F, 0.15F, 0.2F), 0);
    const uint32_t gone = add(vec3(0.15F, 0.33F, 0.15F), vec3(0.15F), 300);
    steps(3);
    add(vec3(0.45F, 0.31F, 0.45F), vec3(0.15F, 0.1F, 0.15F), 500);
    EXPECT_TRUE((*world)->removeBody(gone));
    add(vec3(0.15F, 0.31F, 0.45F), vec3(0.1F), 700);
    steps(4);
    const std::vector<vec3> all = positions(**world);
    out.after = all.size();
    for (const vec3& at : all) out.centre += dvec3(at) / static_cast<double>(all.size());
    out.drained = (*world)->stats().drained;
    out.bodies = (*world)->bodies();
    out.ids = (*world)->bodyIds();
    return out;
}

void matchesTheCpu(const char* name) {
    Result<TestGpu> gpu = makeTestGpu(name);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const Outcome expected = run(*makeTestCpu()), got = run(*gpu->device);
    EXPECT_LT(expected.after, expected.before);
    EXPECT_EQ(got.before, expected.before);
    EXPECT_EQ(got.after, expected.after);
    EXPECT_NEAR(got.drained, expected.drained, 1.0e-9);
    EXPECT_EQ(got.ids, expected.ids);
    // Rounding, after 10 steps. A body that fell through the water, or one that was not added, would be off by more: in 7 steps of 1/120 s
    // a body falls 17 mm and reaches 0.57 m/s.
    EXPECT_LT(glm::length(got.centre - expected.centre), 1.0e-3);
    ASSERT_EQ(got.bodies.size(), expected.bodies.size());
    for (size_t k = 0; k < got.bodies.size(); ++k) {
        EXPECT_LT(glm::length(got.bodies[k].pose.position - expected.bodies[k].pose.position), 1.0e-3F) << k;
        EXPECT_LT(glm::length(got.bodies[k].velocity - expected.bodies[k].velocity), 2.0e-2F) << k;
    }
}

TEST(BodiesChangeParity, OpenGlMatchesCpu) { matchesTheCpu("gl"); }
TEST(BodiesChangeParity, OpenClMatchesCpu) { matchesTheCpu("cl"); }

}  // namespace
}  // namespace rivulet::bodies_change_parity_test
