// Light that the water refracts, against what a lens does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/light.h"
#include "fluid/render/renderers.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_caustics_test {
namespace {

constexpr int kSide = 256;

// Water in a box of 1 m, as a map along light from above, over a floor.
class LookCaustics : public LookPassesTest {
  protected:
    // `thickness`: m, by the distance (m) from the middle; its underside is level, at y = 0. Sets `light`: rgb of each texel.
    template <class Thickness>
    void shine(const Thickness& thickness, float floorHeight) {
        const Bounds water{vec3(-0.5F, 0.0F, -0.5F), vec3(0.5F, 1.0F, 0.5F)};
        FrameView view;
        view.width = view.height = 8;
        view.lightDirWorld = vec3(0, 1, 0);
        Studio studio;
        studio.floorHeight = floorHeight;
        studio.shown = water;
        FrameParams frame = packFrame(view, studio, {}, water);
        const mat4 toLight = frame.waterProjection;
        texel = frame.shadow.w / kSide;
        const float under = (toLight * vec4(0, 0, 0, 1)).z * 0.5F + 0.5F;
        std::vector<vec4> texels(size_t{kSide} * kSide);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float thick = thickness(texel * glm::length(vec2(x, y) + 0.5F - 0.5F * kSide));
                texels[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)] =
                    vec4(thick, thick * (under - 0.5F * thick / frame.shadow.w), thick > 0 ? 1.0F : 0.0F, 1.0F);
            }
        gpu::Texture map = std::move(*gpu::Texture::create({.width = kSide, .height = kSide, .format = gpu::Format::rgba32f}));
        map.upload(std::as_bytes(std::span(texels)));
        const gpu::Buffer block = std::move(*gpu::Buffer::from(std::vector<FrameParams>{frame}));
        gpu::FrameGraph graph(pool);
        FluidDraw d;
        d.view = view;
        d.fluid.spacing = 0.01F;
        d.look.absorption = absorption;
        d.look.scattering = vec3(0.0F);
        d.frame = graph.importBuffer("frame", block.name(), block.bytes());
        d.shadowSharp = d.shadowSoft = graph.importTexture("nothing", map);
        const gpu::TextureHandle made = addCaustics(graph, programs, d, graph.importTexture("water", map), toLight);
        graph.output(made);
        const Status ran = graph.execute();
        ASSERT_TRUE(ran) << ran.error().message;
        light.resize(texels.size());
        graph.result(made).read(std::as_writable_bytes(std::span(light)));
    }
    const vec4& at(int x, int y) const { return light[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)]; }

    vec3 absorption{0.0F};
    float texel = 0.0F;  // m
    std::vector<vec4> light;
};

constexpr float kIndex = 1.333F;
const float kPasses = 1.0F - std::pow((kIndex - 1.0F) / (kIndex + 1.0F), 2.0F);  // at normal incidence (Fresnel 1823)

TEST_F(LookCaustics, levelWaterDimsEvenly) {
    absorption = vec3(2.0F, 0.5F, 0.0F);
    shine([](float) { return 0.4F; }, 0.0F);
    for (int y = 100; y < 156; ++y)
        for (int x = 100; x < 156; ++x)
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(at(x, y)[k], kPasses * std::exp(-0.4F * absorption[k]), 0.01F) << x << " " << y;
}

// A plano-convex lens of radius of curvature R gathers parallel light at R / (n - 1) behind it.
TEST_F(LookCaustics, aLensHasItsFocalLength) {
    constexpr float kCurvature = 0.5F, kAperture = 0.1F, kFocal = kCurvature / (kIndex - 1.0F);
    const auto cap = [](float r) { return r < kAperture ? 0.03F + std::sqrt(kCurvature * kCurvature - r * r) - kCurvature : 0.0F; };
    for (const float away : {0.25F, 0.5F, 0.75F}) {
        shine(cap, -away * kFocal);
        // Of the light beyond what falls beside the lens: nothing outside of the shrunk disc, nearly all in it.
        const float radius = (1.0F - away) * kAperture;
        double inside = 0, all = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float r = texel * glm::length(vec2(x, y) + 0.5F - 0.5F * kSide);
                if (r > kAperture - 2.0F * texel) continue;
                all += at(x, y).r;
                if (r < radius + 2.5F * texel) inside += at(x, y).r;
            }
        EXPECT_GT(inside, 0.97 * all) << away;
        // What is inside is as much brighter as its disc is smaller. The light converges from the curved face on, through 0.03 m of water.
        const float middle = at(kSide / 2, kSide / 2).r, shrunk = 1.0F - away - 0.03F / kIndex / kFocal;
        EXPECT_NEAR(middle * shrunk * shrunk, kPasses * kPasses, 0.06F) << away;
    }
}

// Whatever the water does, no light is made.
TEST_F(LookCaustics, wavesOnlyMoveLight) {
    shine([](float r) { return 0.2F + 0.001F * std::cos(120.0F * r); }, 0.0F);
    double sum = 0;
    float least = 10.0F, most = 0.0F;
    for (const vec4& texelLight : light) sum += texelLight.r;
    for (int y = 100; y < 156; ++y)
        for (int x = 100; x < 156; ++x) {
            least = std::min(least, at(x, y).r);
            most = std::max(most, at(x, y).r);
        }
    EXPECT_NEAR(sum / (double{kSide} * kSide), kPasses, 0.03);
    EXPECT_LT(least, 0.8F);
    EXPECT_GT(most, 1.4F);
}

}  // namespace
}  // namespace rivulet::look_caustics_test
