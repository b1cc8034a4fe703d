// look.detail: from afar fewer and larger splats are drawn, and the picture stays what it was.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "tests/golden/look_fixture.h"

namespace rivulet::look_detail_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr GLenum kClippedPrimitives = 0x82F7;  // GL_CLIPPING_OUTPUT_PRIMITIVES, of GL_ARB_pipeline_statistics_query

class LookDetail : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.background.showBox = false;
        settings.look.quality = "fine";
        usual = settings.look.detail;
        camera.fieldOfView = 20.0F;
        water.spacing = 0.015F;
    }
    void from(float distance) {
        camera.target = vec3(0.5F, 0.15F, 0.5F);
        camera.position = camera.target + distance * glm::normalize(vec3(0.3F, 0.5F, 1.0F));
        camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    }
    // A pool with waves.
    void fillPool() {
        for (float x = 0.0075F; x < 1.0F; x += 0.015F)
            for (float z = 0.0075F; z < 1.0F; z += 0.015F)
                for (float y = 0.0075F; y < 0.2F + 0.04F * std::sin(9.0F * x) * std::cos(7.0F * z); y += 0.015F)
                    water.add(vec3(x, y, z) + 0.003F * random.inCube());
        settings.fluid.box = {.min = vec3(0.0F), .max = vec3(1.0F)};
    }
    // A ball with no walls about it, and drops around it.
    void fillBall() {
        for (int k = 0; k < 60000; ++k) {
            const vec3 p = random.inCube();
            if (glm::dot(p, p) < 1) water.add(vec3(0.5F, 0.4F, 0.5F) + 0.3F * p);
        }
        for (int k = 0; k < 3000; ++k) water.add(vec3(0.5F, 0.4F, 0.5F) + 0.6F * random.inCube(), 0.3F);
    }
    void uploaded() {
        fluid = upload(water);
        if (settings.fluid.box.max.x == 1.0F) fluid.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
    }
    std::vector<uint8_t> shot(float detail, const char* view = "water") {
        settings.look.detail = detail;
        settings.look.view = view;
        return picture(camera, kWidth, kHeight, fluid);
    }
    int covered(float detail) {
        settings.look.view = "depth";
        const std::vector<uint8_t> dry = picture(camera, kWidth, kHeight, {}), wet = shot(detail, "depth");
        int count = 0;
        for (size_t k = 0; k < wet.size(); k += 4) count += std::memcmp(&wet[k], &dry[k], 3) != 0 ? 1 : 0;
        return count;
    }
    double meanThickness(float detail) {
        const std::vector<uint8_t> rgba = shot(detail, "thickness");
        double sum = 0;
        for (size_t k = 0; k < rgba.size(); k += 4) sum += rgba[k];
        return sum;
    }
    // Of the pixels in which `a` or `b` has water, the rms difference of each from the truth, 0..255.
    std::array<double, 2> errors(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
        const std::vector<uint8_t> right = truth(), dry = picture(camera, kWidth, kHeight, {});
        double sums[2] = {}, count = 1;
        for (size_t k = 0; k < a.size(); k += 4) {
            if (std::memcmp(&a[k], &dry[k], 3) == 0 && std::memcmp(&b[k], &dry[k], 3) == 0) continue;
            for (size_t c = k; c < k + 3; ++c) {
                sums[0] += std::pow(int{a[c]} - int{right[c]}, 2);
                sums[1] += std::pow(int{b[c]} - int{right[c]}, 2);
                count += 1;
            }
        }
        return {std::sqrt(sums[0] / count), std::sqrt(sums[1] / count)};
    }
    // The picture as from infinitely many samples: of four times the size, averaged.
    std::vector<uint8_t> truth() {
        settings.look.detail = 0;
        settings.look.view = "water";
        const std::vector<uint8_t> large = picture(camera, 4 * kWidth, 4 * kHeight, fluid);
        std::vector<uint8_t> mean(static_cast<size_t>(kWidth) * kHeight * 4);
        for (size_t y = 0; y < kHeight; ++y)
            for (size_t x = 0; x < kWidth; ++x)
                for (size_t c = 0; c < 4; ++c) {
                    int sum = 0;
                    for (size_t k = 0; k < 16; ++k) sum += large[((4 * y + k / 4) * 4 * kWidth + 4 * x + k % 4) * 4 + c];
                    mean[(y * kWidth + x) * 4 + c] = static_cast<uint8_t>((sum + 8) / 16);
                }
        return mean;
    }
    // Points and triangles that reach the rasteriser, without photons, which are as many at any distance.
    uint64_t drawn(float detail) {
        settings.look.caustics = false;
        GLuint query = 0;
        glGenQueries(1, &query);
        glBeginQuery(kClippedPrimitives, query);
        (void)shot(detail);
        glEndQuery(kClippedPrimitives);
        GLuint64 count = 0;
        glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
        glDeleteQueries(1, &query);
        settings.look.caustics = true;
        return count;
    }
    struct Far {
        std::array<double, 2> errors;  // with look.detail, and with all particles
        std::array<int, 2> covered;    // pixels
        double thickness;              // with it over without
        double drawn;                  // the same of points and triangles
    };
    Far at(float distance) {
        from(distance);
        const std::vector<uint8_t> fewer = shot(usual), all = shot(0);
        const Far f{errors(fewer, all),
                    {covered(usual), covered(0)},
                    meanThickness(usual) / meanThickness(0),
                    static_cast<double>(drawn(usual)) / static_cast<double>(drawn(0))};
        std::printf("%g m: error %.2f (all: %.2f), covers %d (%d) pixels, thickness %.4f, points %.3f\n", double{distance}, f.errors[0],
                    f.errors[1], f.covered[0], f.covered[1], f.thickness, f.drawn);
        return f;
    }
    // The largest change from frame to frame of a camera that moves away by a 500th of its distance.
    double worstChange(float detail) {
        std::vector<uint8_t> last;
        double worst = 0;
        for (int k = 0; k < 40; ++k) {
            from(9.0F * std::pow(1.002F, static_cast<float>(k)));
            std::vector<uint8_t> now = shot(detail);
            if (k > 0) worst = std::max(worst, meanAbsoluteError(last, now));
            last = std::move(now);
        }
        return worst;
    }

    float usual = 0;
    Camera camera;
    TestParticles water;
    TestRandom random;
    FluidView fluid;
};

TEST_F(LookDetail, fromAfarFewerSplatsOfAPoolMakeThePicture) {
    fillPool();
    water.findEllipsoids();
    uploaded();
    double before = 1;
    for (const float distance : {3.0F, 6.0F, 12.0F, 24.0F, 48.0F}) {
        const Far f = at(distance);
        EXPECT_LT(f.errors[0], 1.1 * f.errors[1] + 0.2) << distance;
        EXPECT_NEAR(f.covered[0], f.covered[1], 0.01 * f.covered[1] + 8) << distance;
        EXPECT_NEAR(f.thickness, 1, 0.003) << distance;
        EXPECT_LE(f.drawn, before) << distance;
        before = f.drawn;
    }
    EXPECT_LT(before, 0.4) << "a third is the light's map, which does not depend on the distance; so small, none hides others first";
}

TEST_F(LookDetail, fromAfarFewerSplatsOfSprayMakeThePicture) {
    fillBall();
    water.findEllipsoids();
    uploaded();
    for (const float distance : {6.0F, 24.0F}) {
        const Far f = at(distance);
        EXPECT_LT(f.errors[0], 1.5 * f.errors[1]) << distance;
        EXPECT_NEAR(f.covered[0], f.covered[1], 0.02 * f.covered[1] + 8) << distance;
        EXPECT_NEAR(f.thickness, 1, 0.01) << distance;
    }
    EXPECT_LT(at(24.0F).drawn, 0.5);
}

TEST_F(LookDetail, nothingPopsAsTheCameraMoves) {
    fillPool();
    uploaded();
    const double all = worstChange(0), fewer = worstChange(usual);
    EXPECT_GT(all, 0);
    EXPECT_LT(fewer, 1.15 * all) << all;
}

}  // namespace
}  // namespace rivulet::look_detail_test
