#include "fluid/validate/clusters.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

namespace rivulet {

namespace {

using Cell = std::tuple<int, int, int>;

}  // namespace

double largestCluster(std::span<const vec4> positions, double reach, double period) {
    std::vector<dvec3> places;
    for (const vec4& x : positions)
        if (!(x.w < 0)) places.emplace_back(x);
    if (places.empty()) return 0;
    // Cells at least `reach` wide; along z a whole number of them fills the period.
    const int layers = std::max(static_cast<int>(std::floor(period / reach)), 1);
    const dvec3 width(reach, reach, period / layers);
    const auto cellOf = [&](const dvec3& x) { return ivec3(glm::floor(x / width)); };
    const auto wrapped = [layers](int z) { return (z % layers + layers) % layers; };
    std::map<Cell, std::vector<size_t>> cells;
    for (size_t i = 0; i < places.size(); ++i) {
        const ivec3 c = cellOf(places[i]);
        cells[{c.x, c.y, wrapped(c.z)}].push_back(i);
    }
    std::vector<size_t> parent(places.size()), size(places.size(), 0);
    std::iota(parent.begin(), parent.end(), size_t{0});
    const auto rootOf = [&parent](size_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    for (size_t i = 0; i < places.size(); ++i) {
        const ivec3 c = cellOf(places[i]);
        for (int k = 0; k < 27; ++k) {
            const auto found = cells.find({c.x + k % 3 - 1, c.y + k / 3 % 3 - 1, wrapped(c.z + k / 9 - 1)});
            if (found == cells.end()) continue;
            for (const size_t j : found->second) {
                dvec3 d = places[j] - places[i];
                d.z -= period * std::round(d.z / period);
                if (j > i && glm::dot(d, d) < reach * reach) parent[rootOf(j)] = rootOf(i);
            }
        }
    }
    for (size_t i = 0; i < places.size(); ++i) ++size[rootOf(i)];
    return static_cast<double>(*std::max_element(size.begin(), size.end())) / static_cast<double>(places.size());
}

double coveredVolume(std::span<const vec4> positions, double radius, double cell, double period) {
    const int layers = std::max(static_cast<int>(std::round(period / cell)), 1);
    const dvec3 width(cell, cell, period / layers);
    std::set<Cell> covered;
    for (const vec4& at : positions) {
        if (at.w < 0) continue;
        const dvec3 x(at);
        const ivec3 low(glm::floor((x - radius) / width)), high(glm::floor((x + radius) / width));
        for (int k = low.z; k <= high.z; ++k)
            for (int j = low.y; j <= high.y; ++j)
                for (int i = low.x; i <= high.x; ++i) {
                    const dvec3 d = (dvec3(i, j, k) + 0.5) * width - x;
                    if (glm::dot(d, d) < radius * radius) covered.emplace(i, j, (k % layers + layers) % layers);
                }
    }
    return static_cast<double>(covered.size()) * width.x * width.y * width.z;
}

}  // namespace rivulet
