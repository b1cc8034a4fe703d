// The water's surface is cut where a volume stays dry.
#include <algorithm>
#include <span>
#include <vector>

#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/sources/dry.h"

namespace rivulet {

gpu::TextureHandle addDryCut(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, gpu::TextureHandle tiles,
                             gpu::TextureHandle depth) {
    std::vector<vec4> volumes;
    volumes.reserve(3 * d.fluid.dry.size());
    for (const DryVolume& v : std::span(d.fluid.dry).first(std::min(d.fluid.dry.size(), kMostDry)))
        volumes.insert(volumes.end(), {v.centre, v.reach, v.turn});
    return addTiled(graph, "dry cut", programs, d, programs["dry cut"], tiles, depth, graph.desc(depth), kNoDepth,
                    [volumes](gpu::Program& p, const gpu::PassContext&) {
                        p.set("volumes", static_cast<int>(volumes.size() / 3));
                        p.set("dry", std::span<const vec4>(volumes));
                    });
}

}  // namespace rivulet
