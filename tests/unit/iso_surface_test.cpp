// The iso-surface of particles against half spaces, balls and differences of its own value.
#include "fluid/sim/surface/iso_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rivulet::iso_surface_test {
namespace {

constexpr float kSpacing = 0.02F;  // m

struct Random {
    std::mt19937 bits{7};
    double operator()(double low, double high) { return low + (high - low) * (bits() / 4294967296.0); }
};

// A cubic lattice, jittered by `jitter` spacings along each axis, where `inside` (in spacings) is true.
template <class Inside>
std::vector<vec4> lattice(int reach, double jitter, const Inside& inside) {
    Random random;
    std::vector<vec4> all;
    for (int z = -reach; z < reach; ++z)
        for (int y = -reach; y < reach; ++y)
            for (int x = -reach; x < reach; ++x) {
                const dvec3 p = dvec3(x, y, z) + 0.5 + jitter * dvec3(random(-1, 1), random(-1, 1), random(-1, 1));
                if (inside(p)) all.emplace_back(kSpacing * vec3(p), 1.0F);
            }
    return all;
}

IsoSurface surfaceOf(std::span<const vec4> particles) {
    Result<IsoSurface> made = IsoSurface::create(particles, kSpacing);
    EXPECT_TRUE(made);
    return std::move(*made);
}

// Spacings along a ray to where the value falls through the level.
double crossing(const IsoSurface& s, const dvec3& from, const dvec3& along, double low, double high) {
    for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        (s.value(double{kSpacing} * (from + middle * along)) > IsoSurface::kLevel ? low : high) = middle;
    }
    return low;
}

TEST(IsoSurface, OfAHalfSpaceIsHalfASpacingBeyondTheOutermostCentres) {
    for (const double jitter : {0.0, 0.1, 0.25}) {
        const IsoSurface s = surfaceOf(lattice(12, jitter, [](const dvec3&) { return true; }));
        double sum = 0, worst = 0;
        int n = 0;
        Random random;
        for (; n < 400; ++n) {
            const double level = crossing(s, {random(-5, 5), 0, random(-5, 5)}, {0, 1, 0}, 10, 14);
            sum += level;
            worst = std::max(worst, std::abs(level - 12));
        }
        EXPECT_NEAR(sum / n, 12, 0.03) << jitter;
        EXPECT_LT(worst, 0.03 + 1.2 * jitter) << jitter;
    }
}

TEST(IsoSurface, OfABallHasTheVolumeOfItsParticles) {
    const std::vector<vec4> ball = lattice(14, 0.1, [](const dvec3& p) { return glm::length(p) < 12; });
    const IsoSurface s = surfaceOf(ball);
    double volume = 0;  // by rays from the centre: the mean of r^3
    const int n = 4000;
    for (int k = 0; k < n; ++k) {
        const double y = (2 * k + 1.0) / n - 1, turn = 2.399963 * k, r = std::sqrt(1 - y * y);
        volume += std::pow(crossing(s, dvec3(0), {r * std::cos(turn), y, r * std::sin(turn)}, 8, 14), 3) / n;
    }
    volume *= 4.0 / 3 * glm::pi<double>();
    EXPECT_NEAR(volume / static_cast<double>(ball.size()), 1, 0.03);
}

TEST(IsoSurface, GradientIsThatOfTheValue) {
    const std::vector<vec4> some = lattice(6, 0.3, [](const dvec3& p) { return glm::length(p) < 4 || p.x > 5; });
    const IsoSurface s = surfaceOf(some);
    Random random;
    const double e = 1e-5 * double{kSpacing};
    for (int k = 0; k < 500; ++k) {
        const dvec3 p = double{kSpacing} * dvec3(random(-6, 6), random(-6, 6), random(-6, 6));
        dvec3 slope;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 d(0.0);
            d[axis] = e;
            slope[axis] = (s.value(p + d) - s.value(p - d)) / (2 * e);
        }
        EXPECT_LT(glm::length(s.gradient(p) - slope), 1e-3 + 1e-5 * glm::length(slope));
        EXPECT_NEAR(s.sample(p).value, s.value(p), 1e-12);
    }
}

// Particles all over, turned and moved: the surface turns and moves with them.
TEST(IsoSurface, TurnsAndMovesWithItsParticles) {
    const std::vector<vec4> some = lattice(5, 0.3, [](const dvec3& p) { return glm::length(p) < 4 || std::abs(p.y) < 0.7; });
    const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(dvec3(1, 2, -0.5)));
    const dvec3 move = double{kSpacing} * dvec3(3.3, -7.1, 2.2);
    std::vector<vec4> turned;
    turned.reserve(some.size());
    for (const vec4& p : some) turned.emplace_back(vec3(turn * dvec3(p) + move), p.w);
    std::reverse(turned.begin(), turned.end());
    const IsoSurface a = surfaceOf(some), b = surfaceOf(turned);
    Random random;
    for (int k = 0; k < 500; ++k) {
        const dvec3 p = double{kSpacing} * dvec3(random(-5, 5), random(-5, 5), random(-5, 5));
        EXPECT_NEAR(a.value(p), b.value(turn * p + move), 2e-5);  // the particles are floats
    }
}

TEST(IsoSurface, ASheetIsFlatAndADropIsASmallBall) {
    std::vector<vec4> sheet;
    for (int z = -10; z < 10; ++z)
        for (int x = -10; x < 10; ++x) sheet.emplace_back(kSpacing * vec3(x, 0, z), 1.0F);
    const IsoSurface s = surfaceOf(sheet);
    double thin = 1, thick = 0;
    for (double x = 0; x < 1; x += 0.1) {
        const double half = crossing(s, {x, 0, 0.3}, {0, 1, 0}, 0, 2);
        thin = std::min(thin, half);
        thick = std::max(thick, half);
    }
    EXPECT_GT(thin, 0.25);  // without anisotropy its level would hang on where the particles are
    EXPECT_LT(thick - thin, 0.02);
    EXPECT_LT(thick, 0.5);

    const std::vector<vec4> one = {vec4(0, 0, 0, 1)};
    const IsoSurface drop = surfaceOf(one);
    // Where 21 / (2 pi R^3) (1 - q)^4 (4 q + 1) = 0.5, R = 1.375 spacings.
    EXPECT_NEAR(crossing(drop, dvec3(0), {1, 0, 0}, 0, 2), 0.510, 0.001);
    EXPECT_NEAR(crossing(drop, dvec3(0), glm::normalize(dvec3(1, 1, 1)), 0, 2), 0.510, 0.001);
}

TEST(IsoSurface, IgnoresFreeSlotsAndInvalidPositions) {
    const float nan = std::nanf("");
    const std::vector<vec4> odd = {vec4(0, 0, 0, -1), vec4(nan, 0, 0, 1), vec4(1e30F, 0, 0, 1), vec4(0.1F, 0, 0, 1)};
    EXPECT_EQ(surfaceOf(odd).count(), 1U);
    const IsoSurface none = surfaceOf({});
    EXPECT_EQ(none.value(dvec3(0)), 0);
    EXPECT_TRUE(none.cells().cells().empty());
    EXPECT_FALSE(IsoSurface::create({}, 0));
    EXPECT_FALSE(IsoSurface::create({}, kSpacing, {.support = -1}));
}

}  // namespace
}  // namespace rivulet::iso_surface_test
