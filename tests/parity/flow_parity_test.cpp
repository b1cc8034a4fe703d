// Drops on a bumpy ball, on every device: the same volumes, the same places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/flow/flow_maps.h"
#include "fluid/validate/flow_shapes.h"
#include "tests/parity/devices.h"

namespace rivulet::flow_parity_test {
namespace {

Result<FlowMesh> bumpyBall() {
    constexpr uint32_t kRows = 32;
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t k = 0; k <= kRows; ++k)
        for (uint32_t i = 0; i < 2 * kRows; ++i) {
            const double t = 3.14159265358979 * k / kRows, f = 3.14159265358979 * i / kRows;
            const double r = k == 0 || k == kRows ? 0.05 : 0.05 + 0.002 * std::sin(5 * t) * std::sin(4 * f);
            const double sine = k == 0 || k == kRows ? 0 : std::sin(t);
            positions.emplace_back(r * sine * std::cos(f), r * std::cos(t), -r * sine * std::sin(f));
        }
    for (uint32_t k = 0; k < kRows; ++k)
        for (uint32_t i = 0; i < 2 * kRows; ++i) {
            const uint32_t a = k * 2 * kRows + i, b = k * 2 * kRows + (i + 1) % (2 * kRows), c = a + 2 * kRows, d = b + 2 * kRows;
            indices.insert(indices.end(), {a, c, d, a, d, b});
        }
    return makeFlowMesh({positions, indices, {}, {}});
}

struct After {
    std::vector<SkinDrop> drops;
    SurfaceFlow::Ledger ledger;
};

// `away`: how far (m) the skin stands from its rest pose.
After run(Device& device, const vec3& away) {
    Result<FlowMesh> mesh = bumpyBall();
    EXPECT_TRUE(mesh);
    std::vector<vec3> positions(*std::max_element(mesh->given.begin(), mesh->given.end()) + size_t{1});
    for (size_t k = 0; k < mesh->rest.size(); ++k) positions[mesh->given[k]] = mesh->rest[k] + away;
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*mesh), {});
    EXPECT_TRUE(flow) << (flow ? "" : flow.error().message);
    if (!flow) return {};
    for (int k = 0; k < 90; ++k) {
        if (k < 60) {
            const double a = 0.7 * k;
            flow->add(nearestPoint(flow->mesh(), 0.05F * vec3(dvec3(0.6 * std::cos(a), 0.7, 0.6 * std::sin(a)))),
                      1500000 + 40000 * (k % 7));
        }
        EXPECT_TRUE(flow->step({.positions = positions}, 1.0 / 60));
    }
    return {flow->drops(), flow->ledger()};
}

class FlowParity : public testing::TestWithParam<const char*> {};

TEST_P(FlowParity, TheSameDropsAtTheSamePlaces) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    for (const vec3& away : {vec3(0.0F), vec3(2.0F, -1.0F, 0.5F)}) {
        const After here = run(*cpu, away), there = run(*gpu->device, away);
        EXPECT_EQ(there.ledger.added,
                  there.ledger.drops + there.ledger.film + there.ledger.left + there.ledger.evaporated + there.ledger.refused);
        EXPECT_NEAR(static_cast<double>(there.ledger.drops), static_cast<double>(here.ledger.drops),
                    1.0e-4 * static_cast<double>(here.ledger.drops));
        EXPECT_EQ(there.ledger.merges, here.ledger.merges);
        EXPECT_GT(here.ledger.merges, 5U);
        ASSERT_EQ(there.drops.size(), here.drops.size());
        EXPECT_GT(here.drops.size(), 10U);
        // The free slot of a new drop, and so its id, may differ on a GPU.
        for (const SkinDrop& d : here.drops)
            EXPECT_TRUE(std::any_of(there.drops.begin(), there.drops.end(),
                                    [&](const SkinDrop& o) {
                                        return std::abs(o.volume / d.volume - 1) < 1.0e-3 &&
                                               glm::distance(o.position, d.position) < 5.0e-5F;
                                    }))
                << d.volume * 1e9 << " microlitres";
    }
}

// Thesis mode on a cone, with enough drops that they interact.
After runThesis(Device& device) {
    const Shape cone = coneShape(0.05F, 0.03F, 0.1F, 32, 20);
    Result<FlowMesh> mesh = makeFlowMesh(cone.view());
    EXPECT_TRUE(mesh);
    const std::vector<vec2> uvs = cornerUvs(*mesh, cone.view());
    Result<SurfaceFlow> flow = SurfaceFlow::createThesis(device, std::move(*mesh), uvs, {}, {});
    EXPECT_TRUE(flow) << (flow ? "" : flow.error().message);
    if (!flow) return {};
    const dmat4 tilted = glm::rotate(dmat4(1.0), 0.2, dvec3(0, 0, 1));
    for (int k = 0; k < 40; ++k) {
        for (const double a : {0.9 + 0.004 * k, 0.93 + 0.003 * k, 1.5})
            flow->add(nearestPoint(flow->mesh(), vec3(dvec3(0.04 * std::cos(a), 0.09, 0.04 * std::sin(a)))),
                      static_cast<uint32_t>(900000 + 40000 * (k % 7) + 1000 * a));
        EXPECT_TRUE(flow->step({.wind = vec3(1, 0, 0), .toWorld = tilted}, 1.0 / 60));
    }
    return {flow->drops(), flow->ledger()};
}

TEST_P(FlowParity, ThesisModeToo) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const After here = runThesis(*cpu), there = runThesis(*gpu->device);
    EXPECT_EQ(there.ledger.added, there.ledger.drops + there.ledger.left + there.ledger.refused);
    EXPECT_EQ(there.ledger.drops, here.ledger.drops);
    ASSERT_EQ(there.drops.size(), here.drops.size());
    EXPECT_GT(here.drops.size(), 10U);
    for (const SkinDrop& d : here.drops)
        EXPECT_TRUE(std::any_of(there.drops.begin(), there.drops.end(),
                                [&](const SkinDrop& o) {
                                    return o.volume == d.volume && glm::distance(o.position, d.position) < 2.0e-4F &&
                                           glm::distance(o.velocity, d.velocity) < 5.0e-3F;
                                }))
            << d.position.x << " " << d.position.y << " " << d.position.z;
}

INSTANTIATE_TEST_SUITE_P(Gpus, FlowParity, testing::Values("cl", "gl"));

}  // namespace
}  // namespace rivulet::flow_parity_test
