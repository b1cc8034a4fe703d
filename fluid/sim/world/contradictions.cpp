#include "fluid/sim/world/contradictions.h"

#include <fmt/format.h>

#include <tuple>

namespace rivulet {

namespace {

std::string shown(const vec3& v) { return fmt::format("({}, {}, {})", v.x, v.y, v.z); }
bool inside(const vec3& p, const BoxParams& box) { return glm::clamp(p, box.min, box.max) == p; }

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
