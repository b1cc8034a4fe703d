// Shared by graphs and charts: colours that are distinct with colour blindness, round numbers for axes, readable figures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

// Colours that differ in lightness as well as in hue (Okabe and Ito 2002), for a dark background; as ImU32. After kPlotColours again.
inline constexpr size_t kPlotColours = 7;
uint32_t plotColour(size_t index);

// 1, 2 or 5 times a power of ten, not below `least` > 0.
double roundStep(double least);

// The axis of a plot: from where to where, and whether by decades. `low` and `high` of decades are logarithms to base 10.
struct PlotAxis {
    double low = 0, high = 1;
    bool decades = false;
    // 0 at the low end, 1 at the high end. Values of 0 and less, which decades cannot show, are at the low end.
    double share(double value) const;
    // Round numbers within: `most` of them or, of decades, a few more.
    std::vector<double> ticks(int most) const;
    bool operator==(const PlotAxis&) const = default;
};
// One that holds values from `least` to `largest`, zero with them unless it is by decades: those that end at round numbers. Of decades
// `least` is the least above 0, and no more than six are shown.
PlotAxis axisOf(double least, double largest, bool decades);

// "12.3 mJ", "4.56 %", "1.2k": three digits. Units that may take a prefix do: J, s, l, W; a number without a unit takes k and M.
std::string readableFigure(double value, std::string_view unit);

}  // namespace rivulet
