// The water's surface is where the particles say it is, and nowhere else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/golden/look_fixture.h"

namespace rivulet {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr float kNothing = 1.0e6F;

// The surface's depth (m), bottom row first, as the screen-space renderer finds it in an empty scene.
class LookSurface : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        Result<FluidPrograms> made = FluidPrograms::create(ShaderFiles::developer());
        ASSERT_TRUE(made) << made.error().message;
        programs = std::move(*made);
        camera.position = vec3(0.0F, 0.0F, 2.0F);
        camera.target = vec3(0.0F);
        camera.nearPlane = 0.1F;
        camera.farPlane = 10.0F;
    }

    void draw(const TestParticles& particles) {
        const FrameView view = frameViewOf(camera, settings.light, kWidth, kHeight, 0);
        frame = packFrame(view, {}, {}, {});
        const gpu::Buffer block = std::move(*gpu::Buffer::from(std::vector<FrameParams>{frame}));
        gpu::Texture colour = std::move(*gpu::Texture::create({.width = kWidth, .height = kHeight, .format = gpu::Format::rgba16f}));
        gpu::Texture sceneDepth = std::move(*gpu::Texture::create({.width = kWidth, .height = kHeight, .format = gpu::Format::depth32f}));
        colour.clear(vec4(0.5F));
        sceneDepth.clear(vec4(1.0F));
        gpu::FrameGraph graph(pool);
        FluidDraw d;
        d.view = view;
        d.fluid = upload(particles);
        d.frame = graph.importBuffer("frame", block.name(), block.bytes());
        d.position = graph.importBuffer("positions", d.fluid.position, particles.position.size() * sizeof(vec4));
        d.colour = graph.importTexture("colour", colour);
        d.depth = graph.importTexture("depth", sceneDepth);
        d.shadowSharp = d.shadowSoft = d.waterLight = graph.importTexture("nothing", colour);
        const FluidLayers layers = add(graph, programs, d);
        graph.output(layers.fluidDepth);
        graph.output(layers.colour);
        const Status ran = graph.execute();
        ASSERT_TRUE(ran) << ran.error().message;
        depth.resize(size_t{kWidth} * kHeight);
        graph.result(layers.fluidDepth).read(std::as_writable_bytes(std::span(depth)));
    }

    float at(int x, int y) const { return depth[static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)]; }
    vec3 ray(float x, float y) const {  // through a pixel's centre, z = -1
        return vec3((x + 0.5F) * frame.ray.x + frame.ray.z, (y + 0.5F) * frame.ray.y + frame.ray.w, -1.0F);
    }
    vec3 point(int x, int y) const { return ray(static_cast<float>(x), static_cast<float>(y)) * at(x, y); }
    vec3 normal(int x, int y) const {
        return glm::normalize(glm::cross(point(x + 1, y) - point(x - 1, y), point(x, y + 1) - point(x, y - 1)));
    }
    // Depth of a sphere at the view-space centre along a pixel's ray; NaN: the ray misses it.
    float sphereDepth(int x, int y, const vec3& centre, float radius) const {
        const glm::dvec3 v = ray(static_cast<float>(x), static_cast<float>(y)), c = centre;
        const double a = glm::dot(v, v), b = glm::dot(v, c), disc = b * b - a * (glm::dot(c, c) - double{radius} * double{radius});
        return disc < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>((b - std::sqrt(disc)) / a);
    }

    FluidLayers (*add)(gpu::FrameGraph&, FluidPrograms&, const FluidDraw&) = addScreenSpace;
    FluidPrograms programs;
    gpu::TransientPool pool;
    Camera camera;
    FrameParams frame{};
    std::vector<float> depth;
};

TEST_F(LookSurface, aDropIsAnExactSphereAlsoAtThePicturesEdge) {
    for (const vec3& centre : {vec3(0.0F), vec3(0.9F, 0.5F, 0.2F), vec3(-1.0F, -0.4F, -0.3F)}) {
        TestParticles drop;
        drop.spacing = 0.2F;
        drop.add(centre, 0.3F);  // alone: drawn at half the radius, unsmoothed
        draw(drop);
        const vec3 centreView = centre - camera.position;
        const float radius = 0.5F * 0.6F * drop.spacing;
        int hit = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float wanted = sphereDepth(x, y, centreView, radius);
                if (std::isnan(wanted)) {
                    EXPECT_EQ(at(x, y), kNothing) << x << " " << y;
                } else if (at(x, y) != kNothing) {  // a pixel on the very rim may fall either way
                    ++hit;
                    EXPECT_NEAR(at(x, y), wanted, 1e-3F) << x << " " << y;
                } else {
                    EXPECT_GT(wanted, -centreView.z - 0.2F * radius) << "a hole at " << x << " " << y;
                }
            }
        EXPECT_GT(hit, 120);
    }
}

// As the iso-surface has it: 0.51 spacings, see IsoSurface.ASheetIsFlatAndADropIsASmallBall; wherever in the picture it is.
TEST_F(LookSurface, theTruthOfADropIsAnExactSphere) {
    add = addTruth;
    for (const vec3& centre : {vec3(0.0F), vec3(0.9F, 0.5F, 0.2F), vec3(-1.0F, -0.4F, -0.3F)}) {
        TestParticles drop;
        drop.spacing = 0.2F;
        drop.add(centre);
        draw(drop);
        int hit = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float wanted = sphereDepth(x, y, centre - camera.position, 0.51007F * drop.spacing);
                if (std::isnan(wanted)) {
                    EXPECT_EQ(at(x, y), kNothing) << x << " " << y;
                } else if (at(x, y) != kNothing) {
                    ++hit;
                    EXPECT_NEAR(at(x, y), wanted, 1e-3F) << x << " " << y;
                }
            }
        EXPECT_GT(hit, 120);
    }
}

TEST_F(LookSurface, aBallOfParticlesHasTheBallsDepthAndNormal) {
    TestParticles ball;
    ball.spacing = 0.02F;
    const float radius = 0.35F;
    TestRandom random;
    for (float x = -radius; x <= radius; x += ball.spacing)
        for (float y = -radius; y <= radius; y += ball.spacing)
            for (float z = -radius; z <= radius; z += ball.spacing) {
                const vec3 p = vec3(x, y, z) + 0.25F * ball.spacing * random.inCube();
                if (glm::length(p) <= radius - 0.5F * ball.spacing) ball.add(p);
            }
    draw(ball);
    const vec3 centre = -camera.position;
    const float found = at(kWidth / 2, kHeight / 2);
    EXPECT_NEAR(found, sphereDepth(kWidth / 2, kHeight / 2, centre, radius), 0.6F * ball.spacing);
    EXPECT_GT(normal(kWidth / 2, kHeight / 2).z, std::cos(6.0F * kPi / 180.0F));
    // Over the inner three quarters of the disc: no bump of a single particle is left in depth or normal.
    double worst = 0, angle = 0;
    int count = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float wanted = sphereDepth(x, y, centre, 0.75F * radius);
            if (std::isnan(wanted)) continue;
            ASSERT_LT(at(x, y), kNothing) << "a hole at " << x << " " << y;
            worst = std::max(worst, std::abs(double{at(x, y)} - double{sphereDepth(x, y, centre, radius)}));
            const vec3 exact =
                glm::normalize(ray(static_cast<float>(x), static_cast<float>(y)) * sphereDepth(x, y, centre, radius) - centre);
            angle += std::acos(std::min(1.0F, glm::dot(normal(x, y), exact))) * 180.0F / kPi;
            ++count;
        }
    EXPECT_LT(worst, 1.2 * double{ball.spacing});
    EXPECT_LT(angle / count, 6.0);
    RecordProperty("meanNormalErrorDegrees", std::to_string(angle / count));
}

TEST_F(LookSurface, theSurfaceIsSmoothedAsMuchFromAfarAsFromNear) {
    // Ripples of 6 spacings, which the smoothing halves: how much, would show a kernel of fixed size in pixels.
    TestParticles sheet;
    sheet.spacing = 0.03F;
    const float amplitude = 0.5F * sheet.spacing, k = 2.0F * kPi / (6.0F * sheet.spacing);
    for (float x = -0.5F; x <= 0.5F; x += sheet.spacing / 3)
        for (float y = -0.3F; y <= 0.3F; y += sheet.spacing / 3)
            for (int layer = 0; layer < 3; ++layer)
                sheet.add(vec3(x, y, amplitude * std::sin(k * x) - static_cast<float>(layer) * sheet.spacing));
    auto ripple = [&] {  // the amplitude of the surface's sine along the middle row
        double sine = 0, cosine = 0, mean = 0;
        std::vector<vec3> points;
        for (int x = 1; x + 1 < kWidth; ++x) {
            const vec3 p = point(x, kHeight / 2) + camera.position;
            if (std::abs(p.x) < 12.0F * sheet.spacing) points.push_back(p);
        }
        for (const vec3& p : points) mean += p.z / static_cast<double>(points.size());
        for (const vec3& p : points) {
            sine += (p.z - mean) * std::sin(double{k} * p.x) * 2 / static_cast<double>(points.size());
            cosine += (p.z - mean) * std::cos(double{k} * p.x) * 2 / static_cast<double>(points.size());
        }
        return std::hypot(sine, cosine) / double{amplitude};
    };
    draw(sheet);
    const double far = ripple();
    camera.position.z = 1.2F;
    draw(sheet);
    const double near = ripple();
    EXPECT_GT(far, 0.3);
    EXPECT_LT(far, 0.9);
    EXPECT_NEAR(near / far, 1.0, 0.12);
}

}  // namespace
}  // namespace rivulet
