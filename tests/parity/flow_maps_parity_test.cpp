// Maps of a flow on every device, and the texture made from them.
#include <gtest/gtest.h>

#include <glm/packing.hpp>

#include <algorithm>
#include <cmath>

#include "engine/app/context_egl.h"
#include "fluid/flow/flow_layer.h"
#include "tests/parity/devices.h"
#include "tests/physics/charted_skins.h"

namespace rivulet::flow_maps_parity_test {
namespace {

constexpr int kSize = 128;

// Three drops run down a ball, a fourth lies across a seam; the maps are drawn each frame. `layer`: receives the texture with all mips;
// null: not needed.
std::vector<vec4> run(Device& device, std::vector<std::vector<vec4>>* layer) {
    const test::Skin skin = test::cubeBall(0.03F, 10);
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    EXPECT_TRUE(mesh);
    const std::vector<vec2> uvs = cornerUvs(*mesh, skin.view());
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*mesh), {});
    EXPECT_TRUE(flow) << (flow ? "" : flow.error().message);
    if (!flow) return {};
    Result<FlowMaps> maps = FlowMaps::create(*flow, uvs, kSize);
    EXPECT_TRUE(maps) << (maps ? "" : maps.error().message);
    if (!maps) return {};
    Result<FlowLayer> made = failed("not asked for");
    if (layer) made = FlowLayer::create(kSize);
    for (const vec3& x : {vec3(1, 1.1F, 0.2F), vec3(0.2F, 1, 1.3F), vec3(-1, 2, 0.3F), vec3(1, 0, 1)})
        flow->add(nearestPoint(flow->mesh(), 0.03F * glm::normalize(x)), 7000000);
    for (int k = 0; k < 8; ++k) {
        EXPECT_TRUE(flow->step({}, 1.0 / 60));
        maps->draw(*flow);
        if (made) made->update(*maps);
    }
    const auto words = device.readAll<uint32_t>(maps->texels(), maps->texels().bytes() / 4);
    std::vector<vec4> texels;
    for (size_t k = 0; k < words.size(); k += 2) texels.emplace_back(glm::unpackHalf2x16(words[k]), glm::unpackHalf2x16(words[k + 1]));
    if (made) {
        // Delayed results have arrived; one more call requests the last ones.
        for (int k = 0; k < 2; ++k) {
            device.finish();
            maps->draw(*flow);
            made->update(*maps);
        }
        for (int mip = 0; mip < maps->mips(); ++mip) {
            const auto edge = static_cast<size_t>(kSize >> mip);
            layer->emplace_back(edge * edge);
            made->texture().read(std::as_writable_bytes(std::span(layer->back())), mip);
        }
    }
    return texels;
}

class FlowMapsParity : public testing::TestWithParam<const char*> {};

TEST_P(FlowMapsParity, TheSameTexels) {
    Result<TestGpu> gpu = makeTestGpu(GetParam());
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    const std::vector<vec4> here = run(*cpu, nullptr), there = run(*gpu->device, nullptr);
    ASSERT_EQ(here.size(), there.size());
    vec4 largest(0.0F), worst(0.0F);
    double high = 0, wet = 0;
    for (size_t k = 0; k < here.size(); ++k) {
        largest = glm::max(largest, glm::abs(here[k]));
        worst = glm::max(worst, glm::abs(here[k] - there[k]));
        high += double{glm::abs(here[k] - there[k]).z};
        wet += double{glm::abs(here[k] - there[k]).w};
    }
    EXPECT_GT(largest.z, 0.3F);
    // Rounding decides about a texel on a drop's rim and about a cell at the film's edge.
    for (int k = 0; k < 3; ++k) EXPECT_LT(worst[k], 0.05F * largest[k]) << k;
    EXPECT_LT(high / static_cast<double>(here.size()), 1e-5 * double{largest.z});
    EXPECT_LT(wet / static_cast<double>(here.size()), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Devices, FlowMapsParity, testing::Values("cl", "gl"), [](const auto& row) { return std::string(row.param); });

class FlowLayerTest : public testing::TestWithParam<const char*> {};

TEST_P(FlowLayerTest, TheTextureIsWhatWasDrawn) {
    Result<ContextEgl> context = failed("none");
    Result<TestGpu> gpu = failed("none");
    std::unique_ptr<Device> cpu;
    Device* device = nullptr;
    if (std::string_view(GetParam()) != "gl") {
        context = ContextEgl::create({.debug = true});
        if (!context) GTEST_SKIP() << context.error().message;
    }
    if (std::string_view(GetParam()) == "cpu") {
        cpu = makeTestCpu();
        device = cpu.get();
    } else {
        gpu = makeTestGpu(GetParam());
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        device = gpu->device.get();
    }
    std::vector<std::vector<vec4>> layer;
    const std::vector<vec4> texels = run(*device, &layer);
    size_t at = 0, wet = 0;
    for (const std::vector<vec4>& level : layer)
        for (const vec4& t : level) {
            wet += t.w > 0 ? 1 : 0;
            ASSERT_EQ(t, texels[at++]);
        }
    EXPECT_EQ(at, texels.size());
    EXPECT_GT(wet, 200U);
}

INSTANTIATE_TEST_SUITE_P(Devices, FlowLayerTest, testing::Values("cpu", "cl", "gl"),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::flow_maps_parity_test
