#include "fluid/sim/world/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace rivulet {

namespace {

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
bool inside(const vec3& p, const BoxParams& box) { return glm::clamp(p, box.min, box.max) == p; }

// How many blocks may hold the same water: each neighbour of a particle costs time, and water so dense explodes.
constexpr size_t kMostOverlapping = 8;

// The block of which the first corner lies in the most others, and the number of blocks there. By their extent along x, sorted.
std::pair<size_t, size_t> deepestOverlap(const std::vector<BlockParams>& blocks) {
    std::vector<size_t> order(blocks.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, {}, [&](size_t k) { return blocks[k].min.x; });
    std::vector<size_t> open;
    std::pair<size_t, size_t> deepest{0, 0};
    for (const size_t k : order) {
        const vec3 corner = blocks[k].min;
        std::erase_if(open, [&](size_t other) { return blocks[other].max.x <= corner.x; });
        open.push_back(k);
        const auto holds = [&](size_t other) {
            const BlockParams& b = blocks[other];
            return b.min.y <= corner.y && corner.y < b.max.y && b.min.z <= corner.z && corner.z < b.max.z;
        };
        if (const auto depth = static_cast<size_t>(std::ranges::count_if(open, holds)); depth > deepest.second) deepest = {k, depth};
    }
    return deepest;
}

}  // namespace

std::string outside(std::string_view what, const vec3& place, const BoxParams& box) {
    if (inside(place, box)) return "";
    return fmt::format("{} {} must lie in fluid.box from {} to {}", what, shown(place), shown(box.min), shown(box.max));
}

std::string contradiction(const FluidParams& fluid) {
    const BoxParams& box = fluid.box;
    if (!glm::all(glm::lessThan(box.min, box.max)))
        return fmt::format("fluid.box.min {} must lie below fluid.box.max {} on every axis", shown(box.min), shown(box.max));
    for (size_t i = 0; i < fluid.blocks.size(); ++i) {
        const BlockParams& block = fluid.blocks[i];
        if (!glm::all(glm::lessThanEqual(block.min, block.max)))
            return fmt::format("fluid.blocks[{}].min {} must not lie above its max {}", i, shown(block.min), shown(block.max));
        if (!inside(block.min, box) || !inside(block.max, box))
            return fmt::format("fluid.blocks[{}] from {} to {} reaches outside fluid.box from {} to {}", i, shown(block.min),
                               shown(block.max), shown(box.min), shown(box.max));
    }
    if (const auto [block, depth] = deepestOverlap(fluid.blocks); depth > kMostOverlapping)
        return fmt::format(
            "fluid.blocks: {} of them overlap at the first corner of fluid.blocks[{}], where water would be {} times too dense: "
            "let at most {} overlap",
            depth, block, depth, kMostOverlapping);
    const FoamParams& foam = fluid.foam;
    for (const auto& [name, from, to] : {std::tuple("air", foam.airFrom, foam.airTo), std::tuple("crest", foam.crestFrom, foam.crestTo),
                                         std::tuple("speed", foam.speedFrom, foam.speedTo)})
        if (!(from < to)) return fmt::format("fluid.foam.{0}From is {1}: it must lie below {0}To, which is {2}", name, from, to);
    return "";
}

std::string contradiction(const EmitterParams& emitter, size_t index, const BoxParams& box) {
    if (const std::string wrong = contradiction(emitter); !wrong.empty()) return fmt::format("emitters[{}].{}", index, wrong);
    if (emitter.shape == "mesh" || inside(emitter.position, box)) return "";
    return fmt::format("emitters[{}].position {} is outside fluid.box from {} to {}", index, shown(emitter.position), shown(box.min),
                       shown(box.max));
}

}  // namespace rivulet
