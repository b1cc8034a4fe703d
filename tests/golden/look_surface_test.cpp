// The water's surface is where the particles say it is, and nowhere else.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <map>

#include "fluid/render/filters.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_surface_test {
namespace {

constexpr float kNothing = 1.0e6F;

// The surface's depth (m), bottom row first, as the screen-space renderer finds it in an empty scene.
class LookSurface : public LookPassesTest {
  protected:
    void SetUp() override {
        LookPassesTest::SetUp();
        camera.position = vec3(0.0F, 0.0F, 2.0F);
        camera.target = vec3(0.0F);
        camera.nearPlane = 0.1F;
        camera.farPlane = 10.0F;
    }

    void draw(const TestParticles& particles) {
        const FrameView view = frameViewOf(camera, settings.light, width, height, 0);
        frame = packFrame(view, {}, {}, {});
        const gpu::Buffer block = std::move(*gpu::Buffer::from(std::vector<FrameParams>{frame}));
        gpu::Texture colour = std::move(*gpu::Texture::create({.width = width, .height = height, .format = gpu::Format::rgba16f}));
        gpu::Texture sceneDepth = std::move(*gpu::Texture::create({.width = width, .height = height, .format = gpu::Format::depth32f}));
        colour.clear(vec4(0.5F));
        sceneDepth.clear(vec4(1.0F));
        gpu::FrameGraph graph(pool);
        FluidDraw d;
        d.view = view;
        d.fluid = upload(particles);
        d.fluid.bounds = bounds;
        d.look.filter = filters().find(filter);
        d.frame = graph.importBuffer("frame", block.name(), block.bytes());
        for (const unsigned name : d.fluid.ellipsoids)
            if (name != 0) d.ellipsoids.push_back(graph.importBuffer("ellipsoids", name, particles.position.size() * sizeof(vec4)));
        if (exposure > 0) {
            d.fluid.exposure = exposure;
            d.velocity = graph.importBuffer("velocities", d.fluid.velocity, particles.position.size() * sizeof(vec4));
        }
        d.position = graph.importBuffer("positions", d.fluid.position, particles.position.size() * sizeof(vec4));
        d.colour = graph.importTexture("colour", colour);
        d.depth = graph.importTexture("depth", sceneDepth);
        d.shadowSharp = d.shadowSoft = graph.importTexture("nothing", colour);
        const FluidLayers layers = add(graph, programs, d);
        graph.output(layers.fluidDepth);
        graph.output(layers.colour);
        const Status ran = graph.execute();
        ASSERT_TRUE(ran) << ran.error().message;
        depth.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
        graph.result(layers.fluidDepth).read(std::as_writable_bytes(std::span(depth)));
        radiance.resize(depth.size());
        graph.result(layers.colour).read(std::as_writable_bytes(std::span(radiance)));
    }

    float at(int x, int y) const { return depth[static_cast<size_t>(y) * width + static_cast<size_t>(x)]; }
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
    int width = 320, height = 180;
    std::string filter = "narrow_range";
    Bounds bounds;
    float exposure = 0;  // s, simulated
    Camera camera;
    FrameParams frame{};
    std::vector<float> depth;
    std::vector<vec4> radiance;  // linear
};

// Of its volume, without a part in the surface: particles of a millimetre are drops, larger ones spray of droplets around their place.
TEST_F(LookSurface, aParticleByItselfIsADropOrSpray) {
    for (const float spacing : {0.001F, 0.2F}) {
        camera.position = vec3(0.0F, 0.0F, 10 * spacing);
        camera.nearPlane = spacing;
        TestParticles drop;
        drop.spacing = spacing;
        drop.add(vec3(0.0F), 0.3F);
        draw(drop);
        int covered = 0;
        float outermost = 0.0F;  // spacings
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                EXPECT_EQ(at(x, y), kNothing);
                const vec4 value = radiance[static_cast<size_t>(y) * width + static_cast<size_t>(x)];
                if (glm::length(vec3(value) - 0.5F) < 0.01F) continue;
                ++covered;
                const vec2 way(ray(static_cast<float>(x), static_cast<float>(y)));
                outermost = std::max(outermost, glm::length(way) * camera.position.z / spacing);
            }
        EXPECT_GT(covered, 60) << spacing;
        const float pixel = frame.ray.x * camera.position.z / spacing;
        if (spacing < 0.01F)
            EXPECT_NEAR(outermost, 0.62F, 1.5F * pixel);  // the ball of a particle's volume
        else
            EXPECT_LT(outermost, 2.0F);
    }
}

TEST_F(LookSurface, aParticleOfTheBodyIsAnExactSphereAlsoAtThePicturesEdge) {
    filter = "none";
    for (const vec3& centre : {vec3(0.0F), vec3(0.9F, 0.5F, 0.2F), vec3(-1.0F, -0.4F, -0.3F)}) {
        TestParticles drop;
        drop.spacing = 0.2F;
        drop.add(centre, 1.0F);
        draw(drop);
        const vec3 centreView = centre - camera.position;
        const float radius = 1.35F * 0.6F * drop.spacing;
        int hit = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
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

// OpenGL does not draw a point whose centre lies outside the picture. The part of a particle that reaches into the picture must be drawn.
TEST_F(LookSurface, pointsShowWhatQuadsShow) {
    filter = "none";
    bounds.add(vec3(-1.6F));
    bounds.add(vec3(1.6F, 1.6F, 0.8F));
    TestRandom random;
    TestParticles cloud;
    cloud.spacing = 0.1F;
    for (int k = 0; k < 400; ++k) cloud.add(1.5F * random.inCube() * vec3(1.0F, 1.0F, 0.5F), 0.3F + 0.7F * random.uniform());
    const float largest = programs.largestPoint;
    if (largest < 240 && !onLlvmpipe()) GTEST_SKIP() << "this GPU's points are too small for these particles";
    ASSERT_GE(largest, 240) << "quads are drawn, not points";
    for (const bool ellipsoids : {false, true}) {
        if (ellipsoids) cloud.findEllipsoids();
        exposure = ellipsoids ? 0.1F : 0.0F;  // and with streaks
        std::array<std::vector<float>, 2> depths;
        std::array<std::vector<vec4>, 2> pictures;
        for (const bool points : {false, true}) {
            programs.largestPoint = points ? largest : 0.0F;
            draw(cloud);
            depths[points ? 1 : 0] = depth;
            pictures[points ? 1 : 0] = radiance;
        }
        size_t water = 0, otherDepths = 0, otherColours = 0;
        for (size_t k = 0; k < depth.size(); ++k) {
            water += depths[0][k] != kNothing ? 1U : 0U;
            otherDepths += std::abs(depths[0][k] - depths[1][k]) > 1e-4F ? 1U : 0U;
            otherColours += glm::length(vec3(pictures[0][k] - pictures[1][k])) > 0.01F ? 1U : 0U;
        }
        EXPECT_GT(water, depth.size() / 10);
        EXPECT_EQ(otherDepths, 0U) << ellipsoids;
        EXPECT_EQ(otherColours, 0U) << ellipsoids;
    }
}

// As the iso-surface has it: 0.51 spacings, see IsoSurface.ASheetIsFlatAndADropIsASmallBall; wherever in the picture it is.
TEST_F(LookSurface, theReferenceOfADropIsAnExactSphere) {
    add = addReference;
    for (const vec3& centre : {vec3(0.0F), vec3(0.9F, 0.5F, 0.2F), vec3(-1.0F, -0.4F, -0.3F)}) {
        TestParticles drop;
        drop.spacing = 0.2F;
        drop.add(centre);
        draw(drop);
        int hit = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
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

// Spray is no part of the surface: the reference draws it as the others do, so that pictures differ by the surface alone.
TEST_F(LookSurface, theReferenceHasTheSameSpray) {
    TestParticles spray;
    spray.spacing = 0.05F;
    camera.position = vec3(0.0F, 0.0F, 0.6F);
    for (const vec3& at_ : {vec3(0.0F), vec3(0.1F, 0.05F, 0.0F), vec3(-0.1F, 0.02F, 0.1F)}) spray.add(at_, 0.3F);
    draw(spray);
    const std::vector<vec4> drawn = radiance;
    add = addReference;
    draw(spray);
    int covered = 0;
    for (size_t i = 0; i < radiance.size(); ++i) {
        EXPECT_EQ(depth[i], kNothing);
        EXPECT_LT(glm::length(vec3(radiance[i] - drawn[i])), 1e-3F);
        covered += glm::length(vec3(drawn[i]) - 0.5F) > 0.01F ? 1 : 0;
    }
    EXPECT_GT(covered, 60);
}

TEST_F(LookSurface, anEllipsoidIsExactAlsoAtThePicturesEdge) {
    filter = "none";
    for (const vec3& at_ : {vec3(0.0F), vec3(0.9F, 0.5F, 0.2F), vec3(-1.0F, -0.4F, -0.3F)}) {
        TestParticles one;
        one.spacing = 0.2F;
        one.add(at_);
        const vec3 off(0.06F, -0.05F, 0.03F);
        // Half axes 1.2, 0.8 and 0.3, turned.
        const mat3 turn = mat3(glm::rotate(glm::rotate(mat4(1.0F), 0.7F, vec3(0.0F, 1.0F, 0.0F)), 0.5F, vec3(1.0F, 0.0F, 0.0F)));
        const mat3 squares = turn * mat3(1.44F, 0.0F, 0.0F, 0.0F, 0.64F, 0.0F, 0.0F, 0.0F, 0.09F) * glm::transpose(turn);
        one.ellipsoids = {std::vector<vec4>{vec4(off, 1.0F)}, std::vector<vec4>{vec4(squares[0][0], squares[1][1], squares[2][2], 0.0F)},
                          std::vector<vec4>{vec4(squares[1][2], squares[2][0], squares[0][1], 0.0F)}};
        draw(one);
        const float radius = 1.35F * 0.6F * one.spacing;
        // To where it is a unit ball.
        const glm::dmat3 toBall = glm::inverse(glm::dmat3(turn) * (glm::dmat3(1.2, 0, 0, 0, 0.8, 0, 0, 0, 0.3)) * double{radius});
        // What shrinks the water is given back: 0.77 radii.
        const vec3 smoothed = off * (1.0F - 0.77F * 0.6F * one.spacing / glm::length(off));
        const glm::dvec3 centre = toBall * glm::dvec3(at_ + smoothed - camera.position);
        int hit = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const glm::dvec3 v = toBall * glm::dvec3(ray(static_cast<float>(x), static_cast<float>(y)));
                const double a = glm::dot(v, v), b = glm::dot(v, centre), disc = b * b - a * (glm::dot(centre, centre) - 1);
                const double wanted = (b - std::sqrt(std::max(disc, 0.0))) / a;
                if (disc < -2.0e-5 * b * b) {
                    EXPECT_EQ(at(x, y), kNothing) << x << " " << y;
                } else if (disc > 2.0e-5 * b * b) {
                    ++hit;
                    EXPECT_NEAR(at(x, y), wanted, 1e-3) << x << " " << y;
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
    const float found = at(width / 2, height / 2);
    EXPECT_NEAR(found, sphereDepth(width / 2, height / 2, centre, radius), 0.6F * ball.spacing);
    EXPECT_GT(normal(width / 2, height / 2).z, std::cos(6.0F * kPi / 180.0F));
    // Over the inner three quarters of the disc: no bump of a single particle is left in depth or normal.
    double worst = 0, angle = 0;
    int count = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
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
        for (int x = 1; x + 1 < width; ++x) {
            const vec3 p = point(x, height / 2) + camera.position;
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

TEST_F(LookSurface, theSunGlintsAndNoPixelOfItIsAFirefly) {
    TestParticles slab;
    slab.spacing = 0.03F;
    TestRandom random;
    for (float x = -0.6F; x <= 0.6F; x += slab.spacing)
        for (float z = -0.6F; z <= 0.6F; z += slab.spacing)
            for (int layer = 0; layer < 4; ++layer)
                slab.add(vec3(x, -static_cast<float>(layer) * slab.spacing, z) + 0.3F * slab.spacing * random.inCube());
    camera.position = vec3(0.0F, 0.8F, 1.5F);
    settings.light.direction = vec3(0.0F, 0.8F, -1.5F);  // where the middle of the slab mirrors it to the eye
    settings.light.colour = vec3(1.0F);
    settings.light.intensity = 3.0F;
    draw(slab);
    const std::vector<vec4> lit = radiance;
    settings.light.intensity = 0.0F;
    draw(slab);
    float brightest = 0;
    for (size_t i = 0; i < lit.size(); ++i) {
        ASSERT_TRUE(std::isfinite(lit[i].y));
        brightest = std::max(brightest, lit[i].y - radiance[i].y);
    }
    EXPECT_GT(brightest, 3.0F);                // as bright as the sun's own light
    EXPECT_LT(brightest, 8.0F * 3.0F + 3.0F);  // what the glint may be at most, and what the water throws back
}

// Of specks of one or a few pixels no neighbour has a depth near theirs, but others further off have; what they look like is a number all
// the same.
TEST_F(LookSurface, specksHaveFiniteLight) {
    for (const float spacing : {0.02F, 0.03F, 0.04F}) {
        TestParticles specks;
        specks.spacing = spacing;
        TestRandom random;
        for (int k = 0; k < 3000; ++k) {
            specks.add(vec3(0.9F, 0.5F, 0.001F) * random.inCube());
            specks.position.back().w = 0.58F + 0.08F * random.inCube().x;  // nearly all of it has become droplets
        }
        draw(specks);
        size_t shown = 0;
        for (size_t i = 0; i < radiance.size(); ++i) {
            shown += depth[i] < kNothing ? 1 : 0;
            ASSERT_TRUE(std::isfinite(radiance[i].x + radiance[i].y + radiance[i].z)) << spacing << " " << i;
        }
        EXPECT_GT(shown, 100U) << spacing;
    }
}

// Water of 10 layers, jittered, within a distance function (m, negative inside).
template <class Distance>
TestParticles filled(const vec3& low, const vec3& high, float spacing, Distance distance) {
    TestParticles water;
    water.spacing = spacing;
    TestRandom random;
    for (float x = low.x; x <= high.x; x += spacing)
        for (float y = low.y; y <= high.y; y += spacing)
            for (float z = low.z; z <= high.z; z += spacing) {
                const vec3 p = vec3(x, y, z) + 0.2F * spacing * random.inCube();
                if (distance(vec3(x, y, z)) <= -0.5F * spacing) water.add(p);
            }
    return water;
}

// The box cuts the water: its wall is flat to within a spacing of the edge, and behind the edge the surface is level.
TEST_F(LookSurface, aWallIsFlatUpToItsEdge) {
    constexpr float kSpacing = 0.02F;
    bounds = Bounds{vec3(-0.2F), vec3(0.2F, 0.3F, 0.2F)};
    TestParticles water = filled(vec3(-0.19F), vec3(0.195F, 0.0F, 0.195F), kSpacing, [](const vec3& p) { return p.y - 1e-4F; });
    water.findEllipsoids();  // flatter at the wall than spheres, which would cover it
    camera.position = vec3(0.0F, 0.3F, 1.0F);
    camera.target = vec3(0.0F, -0.05F, 0.0F);
    draw(water);
    int wall = 0, level = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const vec3 way = mat3(frame.inverseView) * ray(static_cast<float>(x), static_cast<float>(y));
            const vec3 front = camera.position + (0.2F - camera.position.z) / way.z * way,
                       top = camera.position - camera.position.y / way.y * way;
            const vec3 p = camera.position + at(x, y) * way;
            if (std::abs(front.x) < 0.18F && front.y > -0.18F && front.y < -kSpacing) {
                ++wall;
                EXPECT_NEAR(p.z, 0.2F, 1e-4F) << x << " " << y;
            }
            if (way.y < 0 && std::abs(top.x) < 0.18F && top.z > -0.1F && top.z < 0.2F - kSpacing) {
                ++level;
                EXPECT_NEAR(p.y, 0.0F, 0.4F * kSpacing) << x << " " << y;
            }
        }
    EXPECT_GT(wall, 1000);
    EXPECT_GT(level, 1000);
}

// Three resolutions, three distances: the normals, by where on the surface they are, are the same, and right.
// The other filters are made for other ends, and smooth steep bumps less: their errors are larger, and steadier than they are small.
struct FilterBounds {
    const char* name;
    bool ellipsoids;
    double ball, slab, frame, apart;  // degrees
};
class LookFilters : public LookSurface, public ::testing::WithParamInterface<FilterBounds> {
  protected:
    struct Shot {
        double error = 0;                              // degrees, mean
        std::map<std::pair<int, int>, vec3> normalAt;  // by x, y on the surface in half spacings
    };
    // `exact(p)`: the normal at p (m, world), or 0 where it is not asked for.
    template <class Exact>
    Shot take(const TestParticles& water, int tall, float distance, Exact exact) {
        height = tall;
        width = 16 * tall / 9;
        camera.position = glm::normalize(from) * distance;
        draw(water);
        const mat3 toWorld = glm::transpose(mat3(camera.view()));
        Shot shot;
        std::map<std::pair<int, int>, std::pair<vec3, int>> sums;
        int count = 0;
        for (int y = 1; y + 1 < height; ++y)
            for (int x = 1; x + 1 < width; ++x) {
                if (at(x, y) >= kNothing) continue;
                const vec3 p = toWorld * point(x, y) + camera.position, wanted = exact(p);
                if (wanted == vec3(0.0F)) continue;
                const vec3 n = toWorld * normal(x, y);
                shot.error += std::acos(std::min(1.0F, glm::dot(n, wanted))) * 180.0 / double{kPi};
                ++count;
                const vec2 cell = glm::floor(vec2(p.x, p.y + p.z) * 2.0F / water.spacing);
                auto& [sum, many] = sums[{static_cast<int>(cell.x), static_cast<int>(cell.y)}];
                sum += n;
                ++many;
            }
        EXPECT_GT(count, 100);
        shot.error /= count;
        for (const auto& [cell, sum] : sums) shot.normalAt[cell] = glm::normalize(sum.first);
        return shot;
    }
    // Degrees between the normals of two pictures of one surface, mean over the places that both show.
    static double apart(const Shot& a, const Shot& b) {
        double sum = 0;
        int count = 0;
        for (const auto& [cell, n] : a.normalAt)
            if (const auto found = b.normalAt.find(cell); found != b.normalAt.end()) {
                sum += std::acos(std::min(1.0F, glm::dot(n, found->second))) * 180.0 / double{kPi};
                ++count;
            }
        EXPECT_GT(count, 50);
        return sum / std::max(count, 1);
    }
    template <class Exact>
    void compare(const char* what, TestParticles water, double mostError, Exact exact) {
        filter = GetParam().name;
        ellipsoids = GetParam().ellipsoids;
        if (ellipsoids) water.findEllipsoids();
        const double mostApart = GetParam().apart;
        const Shot middle = take(water, 360, 2.0F, exact);
        EXPECT_LT(middle.error, mostError) << what;
        RecordProperty(std::string(what) + "MeanNormalErrorDegrees", std::to_string(middle.error));
        for (const auto& [tall, distance] : {std::pair(180, 2.0F), std::pair(720, 2.0F), std::pair(360, 1.0F), std::pair(360, 4.0F)}) {
            const Shot other = take(water, tall, distance, exact);
            const double off = apart(middle, other);
            EXPECT_LT(other.error, mostError) << what << " " << tall << " " << distance;
            EXPECT_LT(off, mostApart) << what << " " << tall << " " << distance;
        }
    }
    vec3 from{0.0F, 0.0F, 1.0F};
    bool ellipsoids = false;
};

TEST_P(LookFilters, aBallHasTheSameNormalsAtAnyResolutionAndDistance) {
    const float radius = 0.3F;
    bounds = Bounds{vec3(-0.5F), vec3(0.5F)};
    const TestParticles ball = filled(vec3(-radius), vec3(radius), 0.02F, [&](const vec3& p) { return glm::length(p) - radius; });
    compare("ball", ball, GetParam().ball,
            [&](const vec3& p) { return glm::length(vec2(p)) < 0.7F * radius ? glm::normalize(p) : vec3(0.0F); });
}

TEST_P(LookFilters, aSlabSeenAtASlantHasTheSameNormalsAtAnyResolutionAndDistance) {
    from = vec3(0.0F, 0.5F, 1.0F);
    bounds = Bounds{vec3(-0.5F), vec3(0.5F)};
    const TestParticles slab = filled(vec3(-0.4F, -0.14F, -0.4F), vec3(0.4F, 0.0F, 0.4F), 0.02F, [](const vec3& p) { return p.y; });
    compare("slab", slab, GetParam().slab, [](const vec3& p) {
        return std::abs(p.x) < 0.3F && std::abs(p.z) < 0.25F && p.y > -0.03F ? vec3(0.0F, 1.0F, 0.0F) : vec3(0.0F);
    });
}

TEST_P(LookFilters, aFrameKeepsItsHole) {
    // A slab with a square hole of 8 spacings: smoothing must not close it, nor pull what is behind to its rim.
    bounds = Bounds{vec3(-0.6F), vec3(0.6F)};
    const auto ring = [](const vec3& p) {
        return std::max(
            {std::abs(p.x) - 0.3F, std::abs(p.y) - 0.3F, 0.08F - std::max(std::abs(p.x), std::abs(p.y)), std::abs(p.z) - 0.06F});
    };
    const TestParticles water = filled(vec3(-0.3F), vec3(0.3F), 0.02F, ring);
    compare("frame", water, GetParam().frame, [](const vec3& p) {
        const float out = std::max(std::abs(p.x), std::abs(p.y));
        return out > 0.13F && out < 0.25F && p.z > 0.03F ? vec3(0.0F, 0.0F, 1.0F) : vec3(0.0F);
    });
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (at(x, y) >= kNothing) continue;
            const vec3 p = point(x, y) + camera.position;
            EXPECT_GT(std::max(std::abs(p.x), std::abs(p.y)), 0.06F) << "water in the hole at " << x << " " << y;
        }
}

INSTANTIATE_TEST_SUITE_P(Rows, LookFilters,
                         ::testing::Values(FilterBounds{"narrow_range", false, 4.2, 1.4, 2.5, 1.3},
                                           FilterBounds{"narrow_range", true, 3.2, 1.3, 2.5, 1.3},
                                           FilterBounds{"bilateral", false, 6.0, 4.5, 2.5, 2.0},
                                           FilterBounds{"curvature_flow", false, 6.0, 5.0, 2.8, 2.6}),
                         [](const auto& row) { return std::string(row.param.name) + (row.param.ellipsoids ? "_ellipsoids" : ""); });

}  // namespace
}  // namespace rivulet::look_surface_test
