#include "engine/core/table.h"

#include <numeric>

namespace rivulet {

namespace {

constexpr size_t kLongestName = 64;  // longer input matches no name; this also bounds the time

std::string folded(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

// Insertions, deletions and substitutions that turn a into b (Levenshtein 1966), one row of the table at a time.
size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < a.size(); ++i) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < b.size(); ++j) {
            size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row[b.size()];
}

}  // namespace

std::string nearestName(std::string_view typed, std::span<const std::string> names) {
    if (typed.size() > kLongestName) return "";
    const std::string wanted = folded(typed);
    std::string nearest;
    size_t least = kLongestName;
    for (const std::string& name : names) {
        const std::string candidate = folded(name);
        size_t distance = editDistance(wanted, candidate);
        if (wanted.size() >= 3 && candidate.starts_with(wanted)) distance = std::min(distance, size_t{1});  // "visc": viscosity
        const size_t tolerated = (std::max(wanted.size(), candidate.size()) + 1) / 3;
        if (distance <= tolerated && distance < least) {
            least = distance;
            nearest = name;
        }
    }
    return nearest;
}

}  // namespace rivulet
