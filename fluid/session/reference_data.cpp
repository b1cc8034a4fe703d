#include "fluid/session/reference_data.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "engine/core/assert.h"

namespace rivulet {

size_t ReferenceRows::column(std::string_view name) const {
    const auto found = std::find(columns.begin(), columns.end(), name);
    ASSERT(found != columns.end(), "the name of a column");
    return static_cast<size_t>(found - columns.begin());
}

double numberIn(std::string_view cell) {
    double value = 0;
    std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return value;
}

ReferenceRows rowsOf(std::span<const ReferenceTable> tables, std::string_view name) {
    const auto found = std::find_if(tables.begin(), tables.end(), [&](const ReferenceTable& t) { return t.name == name; });
    ASSERT(found != tables.end(), "the name of a table's file");
    ReferenceRows all;
    for (std::string_view rest = found->text; !rest.empty();) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        if (line.empty() || line.front() == '#') continue;
        std::vector<std::string_view> cells;
        for (size_t at = 0; at <= line.size();) {
            const size_t end = std::min(line.find(',', at), line.size());
            cells.push_back(line.substr(at, end - at));
            at = end + 1;
        }
        if (all.columns.empty()) {
            all.columns = std::move(cells);
        } else {
            all.rows.push_back(std::move(cells));
        }
    }
    return all;
}

std::vector<glm::dvec2> referenceCurve(std::string_view name, size_t x, size_t y) {
    const ReferenceRows table = rowsOf(referenceTables(), name);
    std::vector<glm::dvec2> curve;
    curve.reserve(table.rows.size());
    for (const std::vector<std::string_view>& row : table.rows) {
        ASSERT(row.size() > std::max(x, y), "a row with fewer columns than asked for");
        curve.emplace_back(numberIn(row[x]), numberIn(row[y]));
    }
    return curve;
}

double valueAt(std::span<const glm::dvec2> curve, double x) {
    ASSERT(!curve.empty(), "a curve has a point");
    if (x <= curve.front().x) return curve.front().y;
    for (size_t k = 1; k < curve.size(); ++k) {
        const glm::dvec2 a = curve[k - 1], b = curve[k];
        if (x <= b.x) return b.x > a.x ? a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x) : b.y;
    }
    return curve.back().y;
}

}  // namespace rivulet
