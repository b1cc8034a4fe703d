// FLIP against values in the paper, and colours whose difference can be computed by hand.
#include "fluid/validate/image_flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rivulet::image_flip_test {
namespace {

constexpr int kSize = 64;  // pixels

using Colour = std::array<uint8_t, 3>;

template <class At>
std::vector<uint8_t> picture(const At& at) {
    std::vector<uint8_t> rgba;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const Colour c = at(x, y);
            rgba.insert(rgba.end(), {c[0], c[1], c[2], 255});
        }
    return rgba;
}
std::vector<uint8_t> plain(const Colour& c) {
    return picture([&](int, int) { return c; });
}
std::vector<uint8_t> disc(int centre) {
    return picture([&](int x, int y) {
        const bool in = std::hypot(x - centre, y - 32) < 12;
        return in ? Colour{220, 180, 60} : Colour{40, 60, 90};
    });
}
double mean(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) { return flipMean(a, b, kSize, kSize); }

TEST(Flip, EqualPicturesDoNotDiffer) { EXPECT_EQ(mean(disc(30), disc(30)), 0); }

// |dL| = 100: beyond the knee at 0.4 cmax, cmax = HyAB(green, blue) of Hunt's colours, 41.28 after the exponent of 0.7.
TEST(Flip, BlackAgainstWhiteMatchesTheFormula) {
    const double cmax = 41.28, d = std::pow(100.0, 0.7);
    EXPECT_NEAR(mean(plain({0, 0, 0}), plain({255, 255, 255})), 0.95 + (d - 0.4 * cmax) / (0.6 * cmax) * 0.05, 1e-3);
    EXPECT_NEAR(mean(plain({0, 255, 0}), plain({0, 0, 255})), 1, 1e-6);
}

// A grey step of dL: below the knee the value is 0.95 dL^0.7 / (0.4 cmax).
TEST(Flip, SmallStepsAreSpread) {
    const auto lightness = [](double byte) {
        const double c = byte / 255, y = std::pow((c + 0.055) / 1.055, 2.4);
        return 116 * std::cbrt(y) - 16;
    };
    const double d = lightness(140) - lightness(128);
    EXPECT_NEAR(mean(plain({128, 128, 128}), plain({140, 140, 140})), 0.95 * std::pow(d, 0.7) / (0.4 * 41.28), 2e-3);
}

TEST(Flip, IsSymmetric) { EXPECT_NEAR(mean(disc(28), disc(34)), mean(disc(34), disc(28)), 1e-9); }

TEST(Flip, GrowsWithAShift) {
    double before = 0;
    for (const int shift : {1, 2, 4, 8}) {
        const double now = mean(disc(28), disc(28 + shift));
        EXPECT_GT(now, before * 1.2) << shift;
        before = now;
    }
}

// Details too fine to be seen at a distance do not count: a chequerboard of pixels and its mean, from near and from far.
TEST(Flip, FineDetailFadesWithDistance) {
    const auto board = picture([](int x, int y) { return (x + y) % 2 == 0 ? Colour{150, 150, 150} : Colour{100, 100, 100}; });
    const auto grey = plain({128, 128, 128});
    const double near = flipMean(grey, board, kSize, kSize, 15), far = flipMean(grey, board, kSize, kSize, 120);
    EXPECT_GT(near, 3 * far);
}

// An edge that is missing shows more than the same difference of colour without one.
TEST(Flip, EdgesCount) {
    const auto base = plain({90, 90, 90}), other = plain({120, 120, 120});
    const auto half = picture([](int x, int) { return x < kSize / 2 ? Colour{90, 90, 90} : Colour{120, 120, 120}; });
    const std::vector<float> map = flipMap(base, half, kSize, kSize);
    const float most = *std::max_element(map.begin(), map.end());
    EXPECT_GT(double{most}, 1.2 * mean(base, other));
}

}  // namespace
}  // namespace rivulet::image_flip_test
