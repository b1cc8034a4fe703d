// The camera's lens: exposure, glare and depth of field, against what a lens does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/render/lens.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_lens_test {
namespace {

constexpr int kSide = 256;

class LookLens : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        Result<LensPrograms> made = LensPrograms::create(ShaderFiles::developer());
        ASSERT_TRUE(made) << made.error().message;
        programs = std::move(*made);
        view.width = view.height = kSide;
        camera.position = vec3(0.0F);
        camera.target = vec3(0.0F, 0.0F, -1.0F);
        camera.fieldOfView = 40.0F;
        camera.nearPlane = 0.1F;
        camera.farPlane = 20.0F;
        view = frameViewOf(camera, settings.light, kSide, kSide, 0);
    }

    // Light of `value` in the picture's middle pixel, at `depth` m like all else, as the lens shows it: red.
    std::vector<vec4> point(const Lens& lens, float value, float depth) {
        const FrameParams frame = packFrame(view, {}, {}, {});
        std::vector<vec4> dark(size_t{kSide} * kSide, vec4(0, 0, 0, 1));
        dark[size_t{kSide / 2} * kSide + kSide / 2] = vec4(value, 0, 0, 1);
        gpu::Texture colour = std::move(*gpu::Texture::create({.width = kSide, .height = kSide, .format = gpu::Format::rgba16f}));
        colour.upload(std::as_bytes(std::span(dark)));
        gpu::Texture sceneDepth = std::move(*gpu::Texture::create({.width = kSide, .height = kSide, .format = gpu::Format::depth32f}));
        const vec4 clip = view.projection * vec4(0.0F, 0.0F, -depth, 1.0F);
        sceneDepth.clear(vec4(0.5F + 0.5F * clip.z / clip.w));
        const gpu::Buffer block = std::move(*gpu::Buffer::from(std::vector<FrameParams>{frame}));
        gpu::FrameGraph graph(pool);
        const gpu::BufferHandle frameBlock = graph.importBuffer("frame", block.name(), block.bytes());
        gpu::TextureHandle seen = graph.importTexture("colour", colour);
        seen = addDepthOfField(graph, programs, frameBlock, view, lens, seen, graph.importTexture("depth", sceneDepth), {});
        seen = addBloom(graph, programs, lens, seen);
        graph.output(seen);
        EXPECT_TRUE(graph.execute());
        std::vector<vec4> out(dark.size());
        graph.result(seen).read(std::as_writable_bytes(std::span(out)));
        return out;
    }

    LensPrograms programs;
    gpu::TransientPool pool;
    Camera camera;
    FrameView view;
};

// A lens of focal length f, f-number N, focused at s: from the lens equation 1/f = 1/u + 1/v.
TEST_F(LookLens, blurIsThatOfAThinLens) {
    const Lens lens{.aperture = 2.0F, .focus = 1.5F};
    const float f = 0.012F / std::tan(glm::radians(20.0F));  // of a sensor 24 mm high
    const float film = 1.0F / (1.0F / f - 1.0F / lens.focus);
    for (const float depth : {0.9F, 1.2F, 1.5F, 2.0F, 5.0F}) {
        const float sharp = 1.0F / (1.0F / f - 1.0F / depth);
        const float disc = f / lens.aperture * std::abs(sharp - film) / sharp / 0.024F;
        EXPECT_NEAR(std::abs(blurDiameter(lens, view, depth)), std::min(disc, 0.03F), 1e-4F) << depth;
    }
    EXPECT_EQ(blurDiameter({}, view, 5.0F), 0.0F);
}

TEST_F(LookLens, aPointOutOfFocusBecomesADisc) {
    const Lens lens{.aperture = 2.0F, .focus = 1.0F};
    for (const float depth : {1.0F, 1.3F, 1.6F}) {
        const std::vector<vec4> seen = point(lens, 1000.0F, depth);
        const float radius = 0.5F * kSide * std::abs(blurDiameter(lens, view, depth));
        double sum = 0;
        float most = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float red = seen[static_cast<size_t>(y) * kSide + static_cast<size_t>(x)].r;
                sum += red;
                if (red > 0.1F) most = std::max(most, glm::length(vec2(x - kSide / 2, y - kSide / 2)));
            }
        EXPECT_LT(most, radius + 1.6F) << depth;
        if (radius > 1.0F) EXPECT_GT(most, radius - 1.6F) << depth;
        EXPECT_NEAR(sum, 1000.0, 350.0) << depth;  // by a few samples of it
    }
}

// What is in the middle is sharp at any depth; with nothing there the given focus holds.
TEST_F(LookLens, anAutomaticFocusIsOnTheMiddle) {
    const auto middle = [&](const Lens& lens, float depth) { return point(lens, 1000.0F, depth)[size_t{kSide / 2} * kSide + kSide / 2].r; };
    for (const float depth : {0.5F, 1.6F, 4.0F}) {
        EXPECT_GT(middle({.aperture = 2.0F, .focus = 1.0F, .automatic = true}, depth), 900.0F) << depth;
        EXPECT_LT(middle({.aperture = 2.0F, .focus = 1.0F}, depth), 500.0F) << depth;
    }
    const float background = 1.0e6F;  // beyond the far plane: window depth 1
    EXPECT_EQ(middle({.aperture = 2.0F, .focus = 1.0F, .automatic = true}, background),
              middle({.aperture = 2.0F, .focus = 1.0F}, background));
}

TEST_F(LookLens, glareSpreadsLightAndMakesNone) {
    const std::vector<vec4> seen = point({.bloom = 0.2F}, 1000.0F, 1.0F);
    double sum = 0;
    for (const vec4& texel : seen) sum += texel.r;
    EXPECT_NEAR(sum, 1000.0, 20.0);
    const size_t middle = size_t{kSide / 2} * kSide + kSide / 2;
    EXPECT_GT(seen[middle].r, 800.0F);
    EXPECT_LT(seen[middle].r, 900.0F);
    EXPECT_GT(seen[middle + 20].r, 0.0F);
    EXPECT_GT(seen[middle + 4].r, seen[middle + 20].r);
}

// A stop more is twice the light: less than white, the picture is brighter, by the same as from a light twice as strong.
TEST_F(LookLens, aStopIsTwiceTheLight) {
    settings.background.horizon = settings.background.zenith = vec3(0.1F);
    settings.background.showFloor = false;
    settings.background.showBox = false;
    settings.camera.exposure = 1.0F;
    const std::vector<uint8_t> stop = picture(camera, 64, 64, {});
    settings.camera.exposure = 0.0F;
    settings.background.horizon = settings.background.zenith = vec3(0.2F);
    const std::vector<uint8_t> twice = picture(camera, 64, 64, {});
    settings.background.horizon = settings.background.zenith = vec3(0.1F);
    EXPECT_LT(meanAbsoluteError(stop, twice), 0.5);
    EXPECT_GT(meanAbsoluteError(stop, picture(camera, 64, 64, {})), 10.0);
}

}  // namespace
}  // namespace rivulet::look_lens_test
