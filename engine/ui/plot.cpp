#include "engine/ui/plot.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

uint32_t plotColour(size_t index) {
    // Sky blue, orange, bluish green, yellow, vermilion, reddish purple, and white in the place of black.
    constexpr uint32_t kColours[kPlotColours] = {IM_COL32(86, 180, 233, 255), IM_COL32(230, 159, 0, 255),  IM_COL32(0, 184, 136, 255),
                                                 IM_COL32(240, 228, 66, 255), IM_COL32(226, 100, 20, 255), IM_COL32(214, 136, 180, 255),
                                                 IM_COL32(232, 236, 240, 255)};
    return kColours[index % kPlotColours];
}

double roundStep(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least * (1 - 1e-9)) return factor * power;
    return 10 * power;
}

double PlotAxis::share(double value) const {
    if (decades && value <= 0) return 0;
    const double at = decades ? std::log10(value) : value;
    return high > low ? std::max((at - low) / (high - low), decades ? 0.0 : -1.0e6) : 0;
}

std::vector<double> PlotAxis::ticks(int most) const {
    std::vector<double> all;
    if (!(high > low)) return all;
    constexpr double kSlack = 1e-6;  // for rounding
    if (decades) {
        for (auto power = static_cast<int>(std::floor(low)); power <= high + kSlack; ++power)
            for (const double factor : {1.0, 2.0, 5.0}) {
                const double at = power + std::log10(factor);
                if (at >= low - kSlack && at <= high + kSlack) all.push_back(factor * std::pow(10.0, power));
            }
        if (static_cast<int>(all.size()) <= most) return all;
        // The powers of ten and, where those are few, both ends.
        const double ends[2] = {all.front(), all.back()};
        all.clear();
        const double step = std::max(1.0, std::ceil((high - low) / most));
        for (double at = std::ceil(low / step - kSlack) * step; at <= high + kSlack; at += step) all.push_back(std::pow(10.0, at));
        const bool few = all.size() < 3;
        const double apart = (high - low) / (most + 1);
        if (few && (all.empty() || std::log10(all.front() / ends[0]) > apart)) all.insert(all.begin(), ends[0]);
        if (few && std::log10(ends[1] / all.back()) > apart) all.push_back(ends[1]);
        return all;
    }
    const double step = roundStep((high - low) / most);
    for (auto k = static_cast<int64_t>(std::ceil(low / step - kSlack)); static_cast<double>(k) * step <= high + kSlack * step; ++k)
        all.push_back(static_cast<double>(k) * step);
    return all;
}

PlotAxis axisOf(double least, double largest, bool decades) {
    if (decades) {
        constexpr double kMost = 6;
        PlotAxis axis{.low = -std::log10(roundStep(1 / least)), .high = std::log10(roundStep(largest)), .decades = true};
        axis.low = std::max(axis.low, axis.high - kMost);
        if (axis.high - axis.low < 0.5) axis.low = axis.high - 1;
        return axis;
    }
    double low = std::min(least, 0.0), high = std::max(largest, 0.0);
    if (!(high > low)) high = 1;
    const double step = roundStep((high - low) / 4);
    low = std::floor(low / step + 1e-9) * step;
    high = std::ceil(high / step - 1e-9) * step;
    return {.low = low, .high = high};
}

std::string readableFigure(double value, std::string_view unit) {
    if (!std::isfinite(value)) return "-";
    struct Prefix {
        double factor;
        const char* name;
    };
    constexpr Prefix kPrefixes[] = {{1e9, "G"}, {1e6, "M"}, {1e3, "k"}, {1, ""}, {1e-3, "m"}, {1e-6, "\u00b5"}, {1e-9, "n"}, {1e-12, "p"}};
    const bool bare = unit.empty(), takes = bare || unit == "J" || unit == "s" || unit == "l" || unit == "W";
    const Prefix* prefix = &kPrefixes[3];
    if (takes && value != 0) {
        const Prefix* const end = bare ? prefix + 1 : std::end(kPrefixes);
        // What rounds to a thousand takes the next prefix.
        const Prefix* const found =
            std::find_if(std::begin(kPrefixes), end, [&](const Prefix& p) { return std::abs(value) >= 0.9995 * p.factor; });
        prefix = found != end ? found : end - 1;
    }
    const double shown = value / prefix->factor;
    if (bare && prefix->factor == 1e3 && std::abs(value) < 1e4) return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}{}{}{}", shown, unit.empty() ? "" : " ", prefix->name, unit);
}

}  // namespace rivulet
