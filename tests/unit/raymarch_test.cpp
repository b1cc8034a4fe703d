// The ray-marched reference against balls, slabs and the iso-surface itself.
#include "fluid/render/raymarch.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace rivulet::raymarch_test {
namespace {

constexpr float kSpacing = 0.02F;  // m

FrameView viewFrom(const vec3& from, const vec3& at, int width, int height) {
    FrameView view;
    view.width = width;
    view.height = height;
    view.view = glm::lookAt(from, at, vec3(0, 1, 0));
    view.projection = glm::perspective(0.8F, static_cast<float>(width) / static_cast<float>(height), 0.01F, 10.0F);
    view.cameraPosWorld = from;
    view.nearPlane = 0.01F;
    view.farPlane = 10.0F;
    return view;
}

IsoSurface block(const ivec3& low, const ivec3& high) {
    std::vector<vec4> all;
    for (int z = low.z; z < high.z; ++z)
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x) all.emplace_back(kSpacing * (vec3(x, y, z) + 0.5F), 1.0F);
    Result<IsoSurface> made = IsoSurface::create(all, kSpacing);
    EXPECT_TRUE(made);
    return std::move(*made);
}

struct Pixel {
    dvec3 way;  // world, a metre of depth
    size_t at;
};
// Of a few pixels all over the picture.
std::vector<Pixel> somePixels(const FrameView& view) {
    std::vector<Pixel> some;
    const dmat4 back = glm::inverse(dmat4(view.projection) * dmat4(view.view));
    for (int y = 3; y < view.height; y += 4)
        for (int x = 2; x < view.width; x += 3) {
            const dvec2 clip(2 * (x + 0.5) / view.width - 1, 2 * (y + 0.5) / view.height - 1);
            const glm::dvec4 far = back * glm::dvec4(clip, 1.0, 1.0);
            const dvec3 way = dvec3(far) / far.w - dvec3(view.cameraPosWorld);
            const dvec3 axis = -dvec3(glm::transpose(dmat3(view.view))[2]);
            some.push_back({way / glm::dot(way, axis), static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x)});
        }
    return some;
}

// A block in the corner of a box fills the edges and the corner: whichever ray enters the box through its three walls there meets water at
// the wall. Without mirrored particles the surface turns round before the edges.
TEST(Raymarch, WaterFillsTheEdgesOfItsBox) {
    std::vector<vec4> all;
    for (int z = 0; z < 10; ++z)
        for (int y = 0; y < 10; ++y)
            for (int x = 0; x < 10; ++x) all.emplace_back(kSpacing * (vec3(x, y, z) + 0.5F), 1.0F);
    all.emplace_back(vec3(-0.5F), 0.3F);  // spray, far off: no part of it
    Bounds box;
    box.add(vec3(0.0F));
    box.add(vec3(0.5F));
    const FrameView view = viewFrom(vec3(-0.3F), vec3(0.0F), 160, 120);
    const auto missed = [&](std::span<const vec4> particles) {
        const Result<IsoSurface> surface = IsoSurface::create(particles, kSpacing);
        EXPECT_TRUE(surface);
        const RaymarchPicture picture = raymarch(*surface, view, {.box = box, .until = {}});
        int without = 0, rays = 0;
        for (const Pixel& p : somePixels(view)) {
            const dvec3 t = -dvec3(view.cameraPosWorld) / p.way;  // to the three walls
            const double enters = std::max({t.x, t.y, t.z});
            const dvec3 at = dvec3(view.cameraPosWorld) + enters * p.way;
            if (p.way.x <= 0 || p.way.y <= 0 || p.way.z <= 0 || std::max({at.x, at.y, at.z}) > 0.15) continue;
            ++rays;
            without += std::abs(double{picture.depth[p.at]} - enters) > 1e-5 ? 1 : 0;
        }
        EXPECT_GT(rays, 100);
        return without;
    };
    EXPECT_EQ(missed(bodyAtWalls(all, kSpacing, box)), 0);
    EXPECT_GT(missed(all), 0);
    EXPECT_EQ(bodyAtWalls(all, kSpacing, {}).size(), 1000U);
}

// A drop by itself is a round ball: depth, normal and thickness are those of a sphere.
TEST(Raymarch, ADropIsASphere) {
    const std::vector<vec4> one = {vec4(0.1F, 0.2F, -0.3F, 1.0F)};
    const Result<IsoSurface> surface = IsoSurface::create(one, kSpacing);
    ASSERT_TRUE(surface);
    double radius = 0;
    for (double step = 0.5 * double{kSpacing}; step > 1e-12; step /= 2)
        if (surface->value(dvec3(one[0]) + dvec3(0, radius + step, 0)) > IsoSurface::kLevel) radius += step;
    const FrameView view = viewFrom({0.13F, 0.24F, -0.24F}, {0.1F, 0.2F, -0.3F}, 80, 60);
    const RaymarchPicture picture = raymarch(*surface, view);
    int hits = 0;
    for (const Pixel& p : somePixels(view)) {
        const dvec3 o = dvec3(view.cameraPosWorld) - dvec3(one[0]);
        const double a = glm::dot(p.way, p.way), b = glm::dot(o, p.way), c = glm::dot(o, o) - radius * radius, root = b * b - a * c;
        const bool seen = picture.depth[p.at] < kNoDepth;
        if (std::abs(root) > 1e-9) EXPECT_EQ(seen, root > 0);
        if (!seen || root <= 0) continue;
        ++hits;
        const double t = (-b - std::sqrt(root)) / a;
        const dvec3 n = glm::transpose(dmat3(view.view)) * dvec3(picture.water[p.at]);
        if (root < 1e-7) continue;  // there a hair of the radius is a long way of the ray
        EXPECT_NEAR(picture.depth[p.at], t, 2e-4 * double{kSpacing});
        EXPECT_NEAR(picture.water[p.at].w, 2 * std::sqrt(root) / std::sqrt(a), 1e-3 * double{kSpacing});
        EXPECT_GT(glm::dot(n, glm::normalize(o + t * p.way)), 0.99999);
    }
    EXPECT_GT(hits, 10);
}

// A hit is on the iso-surface, nothing of it is in front, and thickness is the sum of what is inside, by a blunt walk along the ray.
TEST(Raymarch, HitsAreOnTheSurfaceAndNothingIsInFront) {
    std::vector<vec4> all;
    uint32_t seed = 9;
    const auto random = [&] { return static_cast<float>((seed = seed * 1664525U + 1013904223U) >> 8U) / 16777216.0F; };
    for (int i = 0; i < 600; ++i) {
        const float x = random(), y = random(), z = random();
        all.emplace_back(0.3F * vec3(x, y * y, z), 1.0F);
    }
    const Result<IsoSurface> surface = IsoSurface::create(all, kSpacing);
    ASSERT_TRUE(surface);
    const FrameView view = viewFrom({0.5F, 0.4F, 0.6F}, {0.15F, 0.1F, 0.15F}, 96, 64);
    const RaymarchPicture picture = raymarch(*surface, view);
    int hits = 0;
    const double fine = 0.002 * double{kSpacing};
    for (const Pixel& p : somePixels(view)) {
        const double length = glm::length(p.way);
        double first = double{kNoDepth}, inside = 0;
        for (double t = 0.2; t < 1.2; t += fine) {
            if (surface->value(dvec3(view.cameraPosWorld) + t * p.way) <= IsoSurface::kLevel) continue;
            first = std::min(first, t);
            inside += fine * length;
        }
        if (inside < 0.05 * double{kSpacing}) continue;
        ++hits;
        EXPECT_NEAR(picture.depth[p.at], first, 1.5 * fine);
        EXPECT_NEAR(picture.water[p.at].w, inside, 0.05 * double{kSpacing});
        const dvec3 g = surface->gradient(dvec3(view.cameraPosWorld) + double{picture.depth[p.at]} * p.way);
        EXPECT_GT(glm::dot(glm::transpose(dmat3(view.view)) * dvec3(picture.water[p.at]), -glm::normalize(g)), 0.999);
    }
    EXPECT_GT(hits, 40);
}

TEST(Raymarch, TheBoxCutsWaterFlat) {
    const IsoSurface surface = block({-8, -8, -8}, {8, 8, 8});
    const Bounds box{vec3(-0.1F), vec3(0.1F)};
    const FrameView view = viewFrom({0, 0, 0.5F}, {0, 0, 0}, 40, 40);
    const RaymarchPicture picture = raymarch(surface, view, {.box = box, .until = {}});
    for (const Pixel& p : somePixels(view)) {
        const dvec3 at = dvec3(view.cameraPosWorld) + 0.4 * p.way;
        if (std::abs(at.x) > 0.099 || std::abs(at.y) > 0.099) continue;
        EXPECT_NEAR(picture.depth[p.at], 0.4, 1e-6);
        EXPECT_GT(picture.water[p.at].z, 0.99999F);
    }
    const std::vector<float> until(40 * 40, 0.45F);
    const RaymarchPicture shallow = raymarch(surface, view, {.box = box, .until = until});
    EXPECT_NEAR(shallow.water[20 * 40 + 20].w, 0.05, 1e-4);
    const std::vector<float> before(40 * 40, 0.35F);
    EXPECT_EQ(raymarch(surface, view, {.box = box, .until = before}).depth[20 * 40 + 20], kNoDepth);
}

TEST(Raymarch, TellsOfItsProgressAndStops) {
    const IsoSurface surface = block({-4, -4, -4}, {4, 4, 4});
    const FrameView view = viewFrom({0, 0, 0.5F}, {0, 0, 0}, 64, 64);
    double last = 0;
    int told = 0;
    raymarch(surface, view, {.box = {}, .until = {}, .progress = [&](double share) {
                                 EXPECT_GT(share, last);
                                 last = share;
                                 ++told;
                                 return true;
                             }});
    EXPECT_EQ(last, 1);
    EXPECT_EQ(told, 16);
    told = 0;
    raymarch(surface, view, {.box = {}, .until = {}, .progress = [&](double) { return ++told < 2; }});
    EXPECT_LT(told, 16);
    const Result<IsoSurface> none = IsoSurface::create({}, kSpacing);
    EXPECT_EQ(raymarch(*none, view).depth[0], kNoDepth);
}

}  // namespace
}  // namespace rivulet::raymarch_test
