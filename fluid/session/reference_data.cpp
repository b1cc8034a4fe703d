#include "fluid/session/reference_data.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "engine/core/assert.h"

namespace rivulet {

std::vector<glm::dvec2> referenceCurve(std::string_view name, size_t x, size_t y) {
    const std::span<const ReferenceTable> all = referenceTables();
    const auto found = std::find_if(all.begin(), all.end(), [&](const ReferenceTable& t) { return t.name == name; });
    ASSERT(found != all.end(), "the name of a file in assets/reference");
    std::vector<glm::dvec2> curve;
    bool named = false;
    for (std::string_view rest = found->text; !rest.empty();) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        if (line.empty() || line.front() == '#') continue;
        if (!std::exchange(named, true)) continue;
        std::vector<double> values;
        for (size_t at = 0; at <= line.size();) {
            const size_t end = std::min(line.find(',', at), line.size());
            values.push_back(0);
            std::from_chars(line.data() + at, line.data() + end, values.back());
            at = end + 1;
        }
        ASSERT(values.size() > std::max(x, y), "a row with fewer columns than asked for");
        curve.emplace_back(values[x], values[y]);
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
