// The metrics of surfaces on surfaces whose errors are known.
#include "fluid/validate/surface_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace rivulet::surface_metrics_test {
namespace {

constexpr int kWidth = 160, kHeight = 90;

FrameView view() {
    FrameView v;
    v.width = kWidth;
    v.height = kHeight;
    v.projection = glm::perspective(0.7F, 16.0F / 9, 0.1F, 10.0F);
    return v;
}

// A plane through (0, 0, -2) with this normal, in view space; tan of the angle of view's half is 0.365.
SurfaceMap plane(const dvec3& n) {
    SurfaceMap map{kWidth, kHeight, {}, {}};
    const double tangent = std::tan(0.35);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const dvec3 way((2 * (x + 0.5) / kWidth - 1) * tangent * 16 / 9, (2 * (y + 0.5) / kHeight - 1) * tangent, -1);
            map.depth.push_back(static_cast<float>(-2 * n.z / glm::dot(way, n)));
            map.normal.emplace_back(n);
        }
    return map;
}
dvec3 tilted(double degrees) { return {std::sin(glm::radians(degrees)), 0, std::cos(glm::radians(degrees))}; }

TEST(SurfaceMetrics, NormalsOfAPlaneAreItsOwn) {
    for (const double degrees : {0.0, 20.0, -50.0}) {
        const SurfaceMap exact = plane(tilted(degrees));
        SurfaceMap found = exact;
        fillNormals(found, view(), 1.0F);
        for (int y = 0; y < kHeight; ++y)  // beyond the picture nothing is known
            for (const int x : {0, kWidth - 1}) found.depth[static_cast<size_t>(y * kWidth + x)] = 1.0e6F;
        for (int x = 0; x < kWidth; ++x)
            for (const int y : {0, kHeight - 1}) found.depth[static_cast<size_t>(y * kWidth + x)] = 1.0e6F;
        const SurfaceErrors e = compareSurfaces(found, exact, 0.01F);
        EXPECT_LT(e.normalMean, 0.01) << degrees;
        EXPECT_EQ(e.depthRms, 0);
        EXPECT_EQ(e.pixels, size_t{kWidth - 2} * (kHeight - 2));
    }
}

// A step of more than half a radius is an edge: normals next to it belong to their own side.
TEST(SurfaceMetrics, NormalsDoNotBendOverAnEdge) {
    SurfaceMap step = plane(tilted(0));
    for (int y = 0; y < kHeight; ++y)
        for (int x = kWidth / 2; x < kWidth; ++x) step.depth[static_cast<size_t>(y * kWidth + x)] += 0.1F;
    SurfaceMap found = step;
    fillNormals(found, view(), 0.1F);
    EXPECT_LT(compareSurfaces(found, step, 0.1F).normalMean, 0.01);
    fillNormals(found, view(), 0.5F);
    EXPECT_GT(compareSurfaces(found, step, 0.5F).normalMean, 0.5);
}

TEST(SurfaceMetrics, FiguresMatchTheKnownChange) {
    const SurfaceMap exact = plane(tilted(0));
    SurfaceMap off = plane(tilted(10));
    off.depth = exact.depth;
    for (size_t i = 0; i < off.depth.size(); ++i) off.depth[i] += i % 2 == 0 ? 0.03F : -0.03F;
    SurfaceErrors e = compareSurfaces(off, exact, 0.01F);
    EXPECT_NEAR(e.normalMean, 10, 1e-4);
    EXPECT_NEAR(e.normal95, 10, 1e-4);
    EXPECT_NEAR(e.normalMedian, 10, 1e-4);
    EXPECT_NEAR(e.depthRms, 3, 1e-4);
    EXPECT_NEAR(e.depthMedian, 3, 1e-4);

    // 6 % of the normals are right round: the 95th percentile is among them, the mean is 6 % of 180 more.
    const size_t wrong = off.normal.size() * 6 / 100;
    for (size_t i = 0; i < off.normal.size(); ++i) off.normal[i] = i < wrong ? vec3(0, 0, -1) : vec3(0, 0, 1);
    e = compareSurfaces(off, exact, 0.01F);
    EXPECT_NEAR(e.normal95, 180, 1e-4);
    EXPECT_NEAR(e.normalMean, 10.8, 1e-2);
    EXPECT_NEAR(e.normalMedian, 0, 1e-4);
    for (size_t i = 0; i < off.normal.size(); ++i)
        off.normal[i] = i % 5 == 0 ? vec3(0, 0, 1) : i % 5 == 1 ? vec3(0, 0, -1) : vec3(tilted(10));
    EXPECT_NEAR(compareSurfaces(off, exact, 0.01F).normalMedian, 10, 1e-4);

    // Two fifths are spray, 30 radii off, and behind; the rest is one radius off, and in front: the median ignores the spray.
    off.depth = exact.depth;
    for (size_t i = 0; i < off.depth.size(); ++i) off.depth[i] += i % 5 < 2 ? 0.3F : -0.01F;
    e = compareSurfaces(off, exact, 0.01F);
    EXPECT_NEAR(e.depthMedian, 1, 1e-4);
    EXPECT_NEAR(e.depthRms, std::sqrt(0.4 * 900 + 0.6), 1e-3);

    // A quarter is missing there, another quarter here: half of the whole is in both, and nothing is in neither.
    SurfaceMap left = exact, right = exact;
    for (size_t i = 0; i < exact.depth.size() / 4; ++i) left.depth[i] = right.depth[exact.depth.size() - 1 - i] = 1.0e6F;
    EXPECT_NEAR(compareSurfaces(left, right, 0.01F).overlap, 0.5, 1e-9);
    SurfaceMap none = exact;
    none.depth.assign(none.depth.size(), 1.0e6F);
    EXPECT_EQ(compareSurfaces(none, none, 0.01F).overlap, 1);
    EXPECT_EQ(compareSurfaces(none, exact, 0.01F).overlap, 0);
}

TEST(SurfaceMetrics, FlickerIsTheSpreadInTime) {
    Flicker flicker({true, false});
    EXPECT_EQ(flicker.rms(), 0);
    for (int f = 0; f < 40; ++f) {
        const auto v = static_cast<uint8_t>(100 + (f % 2 == 0 ? 3 : -3)), wild = static_cast<uint8_t>(f * 5);
        const uint8_t rgba[] = {v, v, v, static_cast<uint8_t>(f), wild, wild, wild, 255};  // alpha and what is masked do not count
        flicker.add(rgba);
    }
    EXPECT_NEAR(flicker.rms(), 3, 1e-9);
}

TEST(SurfaceMetrics, OverlapIsIntersectionOverUnion) {
    EXPECT_NEAR(overlapOf({true, true, true, false}, {false, true, true, true}), 0.5, 1e-12);
    EXPECT_EQ(overlapOf({true, false}, {false, true}), 0);
    EXPECT_EQ(overlapOf({false, false}, {false, false}), 1);
}

// A square of 4 pixels in a picture of 12: two pixels to either side of its outline, and neither its middle nor what is diagonal to it.
TEST(SurfaceMetrics, TheBandIsTwoPixelsToEitherSide) {
    constexpr int kSide = 12;
    std::vector<bool> covered(size_t{kSide} * kSide);
    for (int y = 3; y < 9; ++y)
        for (int x = 3; x < 9; ++x) covered[static_cast<size_t>(y * kSide + x)] = true;
    const std::vector<bool> band = silhouetteBand(covered, kSide, 2);
    const auto at = [&](int x, int y) { return band[static_cast<size_t>(y * kSide + x)]; };
    for (int x = 0; x < kSide; ++x) {
        EXPECT_EQ(at(x, 5), (x >= 1 && x <= 4) || (x >= 7 && x <= 10)) << x;
        EXPECT_EQ(at(5, x), (x >= 1 && x <= 4) || (x >= 7 && x <= 10)) << x;
    }
    EXPECT_FALSE(at(1, 1));
    // The edge of the picture is no silhouette.
    EXPECT_EQ(silhouetteBand(std::vector<bool>(16, true), 4, 2), std::vector<bool>(16, false));
}

// One row of pixels: water in the left 20 of 40. It brightens by 5 where the reference brightens by 3, and by 9 in the last two pixels
// before the silhouette; what the dry pixels do counts along the silhouette only.
TEST(SurfaceMetrics, ChangeIsWhatTheReferenceDoesNotDo) {
    constexpr int kPixels = 40, kWater = 20;
    std::vector<bool> covered(kPixels);
    for (int x = 0; x < kWater; ++x) covered[static_cast<size_t>(x)] = true;
    const auto frame = [&](int water, int edge, int dry) {
        std::vector<uint8_t> rgba;
        for (int x = 0; x < kPixels; ++x) {
            const auto v = static_cast<uint8_t>(100 + (x >= kWater ? dry : x >= kWater - 2 ? edge : water));
            rgba.insert(rgba.end(), {v, v, v, static_cast<uint8_t>(7 * x)});
        }
        return rgba;
    };
    UnexplainedChange change(kPixels, 1);
    change.add(frame(0, 0, 0), frame(0, 0, 0), covered);
    EXPECT_EQ(change.mean(), 0);
    change.add(frame(5, 9, 40), frame(3, 3, 30), covered);
    EXPECT_NEAR(change.mean(), (18 * 2 + 2 * 6) / 20.0, 1e-12);
    EXPECT_NEAR(change.edges(), (2 * 6 + 2 * 10) / 4.0, 1e-12);
    // As much as the reference, in either direction: nothing more. A slow one that the reference does not follow is not made up for by it.
    UnexplainedChange same(kPixels, 1);
    same.add(frame(0, 0, 0), frame(9, 9, 9), covered);
    same.add(frame(4, 4, 4), frame(5, 5, 5), covered);
    EXPECT_EQ(same.mean(), 0);
    EXPECT_EQ(same.edges(), 0);
}

}  // namespace
}  // namespace rivulet::surface_metrics_test
