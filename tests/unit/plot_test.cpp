// Shared by graphs: round axis limits that contain the data, three-digit numbers, distinct colours.
#include "engine/ui/plot.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rivulet::plot_test {
namespace {

TEST(Plot, AxesHoldTheirValuesAndEndAtRoundNumbers) {
    for (const auto& [least, largest] : {std::pair(0.0, 4160.0), std::pair(0.013, 0.4), std::pair(-7.0, 3.0), std::pair(2.0, 2.0),
                                         std::pair(-5.0, -1.0), std::pair(1e-9, 3e-9), std::pair(0.0, 0.0)}) {
        const PlotAxis axis = axisOf(least, largest, false);
        EXPECT_LE(axis.low, std::min(least, 0.0));
        EXPECT_GE(axis.high, std::max(largest, 0.0));
        EXPECT_GE(axis.share(least), 0);
        EXPECT_LE(axis.share(largest), 1);
        EXPECT_LT(axis.high - axis.low,
                  2.6 * std::max(largest, 0.0) - 2.6 * std::min(least, 0.0) + (largest == least && least == 0 ? 2 : 0))
            << least << " to " << largest << ": no more room than rounding needs";
        const std::vector<double> ticks = axis.ticks(4);
        ASSERT_GE(ticks.size(), 2U);
        EXPECT_LE(ticks.size(), 5U);
        for (const double tick : ticks) EXPECT_NEAR(tick / (ticks[1] - ticks[0]), std::round(tick / (ticks[1] - ticks[0])), 1e-9);
    }
}

TEST(Plot, AxesOfDecadesHoldTheirValues) {
    for (const auto& [least, largest] : {std::pair(0.00028, 0.0093), std::pair(1.29, 14.2), std::pair(1e-5, 1.0), std::pair(3.0, 3.1)}) {
        const PlotAxis axis = axisOf(least, largest, true);
        EXPECT_GE(axis.share(least), 0);
        EXPECT_LE(axis.share(largest), 1);
        EXPECT_NEAR(axis.share(std::sqrt(least * largest)), (axis.share(least) + axis.share(largest)) / 2, 1e-9);
        for (const int most : {2, 4, 8}) {
            const std::vector<double> ticks = axis.ticks(most);
            EXPECT_GE(ticks.size(), 2U) << least << " to " << largest;
            for (size_t k = 1; k < ticks.size(); ++k) EXPECT_GT(ticks[k], ticks[k - 1]);
            EXPECT_GE(axis.share(ticks.front()), -1e-6);
            EXPECT_LE(axis.share(ticks.back()), 1 + 1e-6);
        }
    }
    EXPECT_EQ(axisOf(1e-30, 1, true).low, -6) << "no more than six decades";
    EXPECT_EQ(axisOf(0.01, 1, true).share(0), 0) << "what has no logarithm lies at the bottom";
}

TEST(Plot, FiguresReadWell) {
    EXPECT_EQ(readableFigure(0.0123, "J"), "12.3 mJ");
    EXPECT_EQ(readableFigure(999.9, "J"), "1 kJ");
    EXPECT_EQ(readableFigure(0, "l"), "0 l");
    EXPECT_EQ(readableFigure(-0.00417, "s"), "-4.17 ms");
    EXPECT_EQ(readableFigure(4160, ""), "4160");
    EXPECT_EQ(readableFigure(123456, ""), "123k");
    EXPECT_EQ(readableFigure(2.5, ""), "2.5");
    EXPECT_EQ(readableFigure(0.5, ""), "0.5") << "a count takes no milli";
    EXPECT_EQ(readableFigure(0.126, "%"), "0.126 %");
    EXPECT_EQ(readableFigure(std::nan(""), "J"), "-");
    EXPECT_EQ(roundStep(0.3), 0.5);
    EXPECT_EQ(roundStep(2), 2);
    EXPECT_NEAR(roundStep(0.006), 0.01, 1e-12);
}

// Relative luminance (WCAG 2): three times that of the panel at least.
TEST(Plot, ColoursAreSeenOnThePanel) {
    const auto luminance = [](uint32_t colour) {
        double sum = 0;
        const double weights[] = {0.2126, 0.7152, 0.0722};
        for (int k = 0; k < 3; ++k) {
            const double s = static_cast<double>((colour >> (8 * k)) & 255U) / 255;
            sum += weights[k] * (s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
        }
        return sum;
    };
    constexpr double kBackground = 0.02;
    for (size_t a = 0; a < kPlotColours; ++a) {
        EXPECT_GT((luminance(plotColour(a)) + 0.05) / (kBackground + 0.05), 3.0) << a << " is seen on the panel";
        for (size_t b = 0; b < a; ++b) EXPECT_NE(plotColour(a), plotColour(b));
    }
}

}  // namespace
}  // namespace rivulet::plot_test
