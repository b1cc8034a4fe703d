#include "fluid/sim/world/contradictions.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace rivulet {

namespace {

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
bool inside(const vec3& p, const BoxParams& box) { return glm::clamp(p, box.min, box.max) == p; }

// How many blocks may hold the same water: each neighbour of a particle costs time, and water so dense explodes.
constexpr size_t kMostOverlapping = 8;
constexpr size_t kMostWork = 20'000'000;  // comparisons to find that out: some ten milliseconds

// The first place that more than `most` blocks hold, in the order of their first coordinates; nothing: there is none. Such a place begins
// where a block begins along x, one of those there along y, and one of those there along z. Gives up after `work` comparisons.
std::optional<vec3> crowdedPlace(const std::vector<BlockParams>& blocks, size_t most, size_t work) {
    std::vector<size_t> all(blocks.size());
    std::iota(all.begin(), all.end(), size_t{0});
    // Those of `from` that hold a coordinate of an axis. Empty blocks hold none.
    const auto holding = [&](const std::vector<size_t>& from, int axis, float at) {
        work -= std::min(work, from.size());
        std::vector<size_t> held;
        for (const size_t k : from)
            if (blocks[k].min[axis] <= at && at < blocks[k].max[axis]) held.push_back(k);
        return held;
    };
    const auto begins = [&](const std::vector<size_t>& of, int axis) {
        std::vector<float> places;
        places.reserve(of.size());
        for (const size_t k : of) places.push_back(blocks[k].min[axis]);
        std::ranges::sort(places);
        places.erase(std::unique(places.begin(), places.end()), places.end());
        return places;
    };
    for (const float x : begins(all, 0)) {
        const std::vector<size_t> there = holding(all, 0, x);
        if (there.size() <= most) continue;
        for (const float y : begins(there, 1)) {
            const std::vector<size_t> column = holding(there, 1, y);
            if (column.size() <= most) continue;
            for (const float z : begins(column, 2)) {
                if (holding(column, 2, z).size() > most) return vec3(x, y, z);
                if (work == 0) return std::nullopt;
            }
        }
    }
    return std::nullopt;
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
    if (const std::optional<vec3> place = crowdedPlace(fluid.blocks, kMostOverlapping, kMostWork))
        return fmt::format(
            "fluid.blocks: more than {} of them overlap at {}, which makes the water too dense to be simulated: let fewer overlap",
            kMostOverlapping, shown(*place));
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
