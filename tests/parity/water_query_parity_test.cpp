// Queries of the water at points and along rays give the same results on cl and gl as on the cpu, sorted or in linked lists, at t = 0 and
// later.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::water_query_parity_test {
namespace {

class WaterQueryParity : public testing::TestWithParam<const char*> {};

TEST_P(WaterQueryParity, TheSameOnAGpu) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    for (const char* grid : {"sorted", "linked_list"}) {
        FluidParams p;
        p.method = "wcsph_thesis";
        p.spacing = 0.03125F;
        p.box.max = vec3(0.5F);
        p.blocks = {{vec3(0.0F), vec3(0.3F, 0.2F, 0.5F), vec3(0.2F, 0.0F, 0.1F)}};
        auto here = FluidWorld::create(*cpu, p, {}, {});
        p.grid = grid;
        auto there = FluidWorld::create(*gpu->device, p, {}, {});
        ASSERT_TRUE(here && there);
        std::vector<vec3> places;
        std::vector<FluidRay> rays;
        for (int k = 0; k < 200; ++k) {
            places.emplace_back(0.5F * static_cast<float>(k % 19) / 18.0F, 0.3F * static_cast<float>(k % 7) / 6.0F,
                                0.5F * static_cast<float>(k % 31) / 30.0F);
            rays.push_back({vec3(0.25F, 0.6F, 0.25F), places.back() - vec3(0.25F, 0.6F, 0.25F)});
            rays.push_back({places.back(), vec3(0.3F, 1.0F, -0.2F)});
        }
        places.emplace_back(NAN);
        rays.push_back({vec3(NAN), vec3(1.0F)});
        for (int frame = 0; frame < 3; ++frame) {
            const std::vector<FluidSample> a = *(*here)->sample(places), b = *(*there)->sample(places);
            std::vector<FluidSample> late;
            ASSERT_TRUE((*there)->sampleLater(places, [&](std::span<const FluidSample> s) { late.assign(s.begin(), s.end()); }));
            gpu->device->finish();
            gpu->device->poll();
            ASSERT_EQ(late.size(), places.size());
            float fullest = 0;
            for (size_t k = 0; k < a.size(); ++k) {
                fullest = std::max(fullest, a[k].density);
                EXPECT_NEAR(a[k].density, b[k].density, 1e-3F) << grid << k;
                EXPECT_LT(glm::length(a[k].gradient - b[k].gradient), 0.05F) << grid << k;
                if (a[k].density > 0.01F) EXPECT_LT(glm::length(a[k].velocity - b[k].velocity), 1e-3F) << grid << k;
                EXPECT_EQ(late[k].density, b[k].density) << grid << k;
            }
            EXPECT_GT(fullest, 0.9F);
            const std::vector<FluidHit> x = *(*here)->cast(rays), y = *(*there)->cast(rays);
            size_t met = 0, inside = 0, other = 0;
            for (size_t k = 0; k < x.size(); ++k) {
                met += x[k].hit ? 1 : 0;
                inside += x[k].inside ? 1 : 0;
                // For a ray that grazes or begins on the surface, rounding decides whether it hits.
                const bool same = x[k].hit == y[k].hit && x[k].inside == y[k].inside && std::abs(x[k].distance - y[k].distance) < 1e-3F;
                other += same ? 0 : 1;
                if (same && x[k].hit) EXPECT_LT(glm::length(x[k].normal - y[k].normal), 0.02F) << grid << k;
            }
            EXPECT_GT(met, x.size() / 4);
            EXPECT_GT(inside, x.size() / 20);
            EXPECT_LE(other, x.size() / 100) << grid;
            for (FluidWorld* w : {here->get(), there->get()}) w->step({.gravity = p.gravity}, 0.002);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, WaterQueryParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::water_query_parity_test
