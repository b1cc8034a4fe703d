#include "fluid/flow/footprint.h"

#include <algorithm>

namespace rivulet {

namespace {

// A fine skin has thousands of triangles under a drop: the nearest are enough.
constexpr size_t kMost = 64;

}  // namespace

Footprint footprintOf(const FlowMesh& m, float width) {
    const size_t triangles = m.triangleCount(), places = m.rest.size();
    std::vector<uint32_t> begin(places + 1, 0), at(m.corner.size());
    for (const uint32_t c : m.corner) ++begin[c + 1];
    for (size_t p = 0; p < places; ++p) begin[p + 1] += begin[p];
    std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
    for (uint32_t k = 0; k < m.corner.size(); ++k) at[next[m.corner[k]]++] = k / 3;

    const float radius = 0.5F * width;
    Footprint f;
    f.begin.push_back(0);
    std::vector<uint32_t> seen(triangles, UINT32_MAX), found;
    for (uint32_t p = 0; p < places; ++p) {
        found.clear();
        for (uint32_t k = begin[p]; k < begin[p + 1]; ++k) {
            if (seen[at[k]] == p) continue;
            seen[at[k]] = p;
            found.push_back(at[k]);
        }
        const size_t own = found.size();
        for (size_t k = 0; k < found.size() && found.size() < kMost; ++k)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = m.across[3 * size_t{found[k]} + edge];
                if (across == FlowMesh::kOpen || seen[across / 4] == p) continue;
                seen[across / 4] = p;
                if (glm::distance(positionOf(m, {across / 4, 1.0F / 3, 1.0F / 3}), m.rest[p]) < radius) found.push_back(across / 4);
            }
        for (size_t k = 0; k < found.size(); ++k) {
            const float far = glm::distance(positionOf(m, {found[k], 1.0F / 3, 1.0F / 3}), m.rest[p]);
            const float q = radius > 0 ? std::min(far / radius, 1.0F) : 1.0F;
            f.triangle.push_back(found[k]);
            // Its own triangles count even if they are wider than a drop.
            f.weight.push_back(std::max(1 - q * q, k < own ? 0.05F : 0.0F));
        }
        f.begin.push_back(static_cast<uint32_t>(f.triangle.size()));
    }
    return f;
}

}  // namespace rivulet
