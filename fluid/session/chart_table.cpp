#include "fluid/session/chart_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace rivulet {

namespace {

constexpr ChartSetting kSettings[] = {
    {"pbf 1", "1 correction per substep", "pbf", "fluid.pbf.iterations=1", false},
    {"pbf 2", "2 corrections per substep", "pbf", "fluid.pbf.iterations=2", true},
    {"pbf", "3 corrections per substep, the default", "pbf", "", true},
    {"pbf, sleep", "3 corrections, calm water falls asleep", "pbf", "fluid.sleep.on=true", true, false},
    {"pbf 6", "6 corrections per substep", "pbf", "fluid.pbf.iterations=6", true},
    {"pbf 3, short steps", "3 corrections, substeps half as long", "pbf", "fluid.pbf.reach=0.3; fluid.pbf.minSubsteps=8", true},
    {"pbf 10, short steps", "10 corrections, substeps half as long", "pbf",
     "fluid.pbf.iterations=10; fluid.pbf.reach=0.3; fluid.pbf.minSubsteps=8", false},
    {"dfsph 1e-2, long steps", "tolerance 1 %, substeps twice as long", "dfsph",
     "fluid.dfsph.tolerance=1e-2; fluid.dfsph.reach=0.6; fluid.dfsph.minSubsteps=4", true},
    {"dfsph 3e-3, long steps", "tolerance 0.3 %, substeps twice as long", "dfsph",
     "fluid.dfsph.tolerance=3e-3; fluid.dfsph.reach=0.6; fluid.dfsph.minSubsteps=4", true},
    {"dfsph 1e-3", "tolerance 0.1 %", "dfsph", "fluid.dfsph.tolerance=1e-3", true},
    {"dfsph", "tolerance 0.03 %, the default", "dfsph", "", true},
    {"dfsph, sleep", "tolerance 0.03 %, calm water falls asleep", "dfsph", "fluid.sleep.on=true", true, false},
    {"dfsph 1e-4", "tolerance 0.01 %", "dfsph", "fluid.dfsph.tolerance=1e-4", true},
    {"dfsph 1e-4, short steps", "tolerance 0.01 %, substeps half as long", "dfsph",
     "fluid.dfsph.tolerance=1e-4; fluid.dfsph.reach=0.15; fluid.dfsph.minSubsteps=16", false},
    {"wcsph", "weakly compressible, sound ten times as fast as the flow", "wcsph", "", true},
    {"wcsph, sleep", "calm water falls asleep", "wcsph", "fluid.sleep.on=true", true, false},
    {"wcsph, short steps", "substeps half as long", "wcsph", "fluid.cfl=0.2", false},
    {"wcsph_thesis", "the thesis's pressure", "wcsph_thesis", "", true},
};

}  // namespace

std::vector<std::string> assignmentsOf(std::string_view joined) {
    std::vector<std::string> each;
    for (size_t at = 0; at < joined.size();) {
        const size_t end = std::min(joined.find("; ", at), joined.size());
        each.emplace_back(joined.substr(at, end - at));
        at = end + 2;
    }
    return each;
}

Table<ChartSetting> chartSettings() { return {kSettings}; }

std::string percentText(double fraction) {
    const double p = 100 * fraction;
    return p < 99.5 ? fmt::format("{:.2g} %", p) : fmt::format("{:.0f} %", p);
}

std::vector<ChartRow> readChart(std::string_view csv) {
    std::vector<ChartRow> rows;
    for (size_t at = 0; at < csv.size();) {
        const size_t end = std::min(csv.find('\n', at), csv.size());
        std::vector<std::string> cells(1);
        for (const char c : csv.substr(at, end - at))
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        at = end + 1;
        if (cells.size() != 12 || cells[0].starts_with('#') || cells[0] == "case") continue;
        std::replace(cells[2].begin(), cells[2].end(), ';', ',');
        const auto number = [&](size_t k) {
            double x = 0;
            std::from_chars(cells[k].data(), cells[k].data() + cells[k].size(), x);
            return x;
        };
        if (chartSettings().find(cells[2]) == nullptr) continue;  // of an older table
        rows.push_back({cells[0], cells[1], cells[2], number(3), static_cast<uint32_t>(number(4)), number(5), number(6), number(7),
                        number(8), number(9), number(10), cells[11] == "1"});
    }
    return rows;
}

}  // namespace rivulet
