// The water's surface is cut where a volume stays dry.
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <span>
#include <vector>

#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/sources/dry.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {

namespace {
constexpr unsigned kBodyUnit = 24;  // as dry_cut.frag
}  // namespace

gpu::TextureHandle addDryCut(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, gpu::TextureHandle tiles,
                             gpu::TextureHandle depth) {
    std::vector<vec4> volumes;
    static_assert(sizeof(DeviceBody) % sizeof(vec4) == 0);
    volumes.reserve(3 * d.fluid.dry.size());
    for (const DryVolume& v : std::span(d.fluid.dry).first(std::min(d.fluid.dry.size(), kMostDry)))
        volumes.insert(volumes.end(), {v.centre, v.reach, v.turn});
    const unsigned rows = d.fluid.hasNewPoses() ? d.fluid.bodies : 0;
    return addTiled(graph, "dry cut", programs, d, programs["dry cut"], tiles, depth, graph.desc(depth), kNoDepth,
                    [volumes, rows, &programs](gpu::Program& p, const gpu::PassContext&) {
                        // A texture without a buffer is read as zeros.
                        const unsigned texture = programs.rowTextures[0].name();
                        if (rows != 0 || programs.rowsThere[0]) glTextureBuffer(texture, GL_RGBA32F, rows);
                        programs.rowsThere[0] = rows != 0;
                        glBindTextureUnit(kBodyUnit, texture);
                        p.set("bodyTexels", static_cast<int>(sizeof(DeviceBody) / sizeof(vec4)));
                        p.set("volumes", static_cast<int>(volumes.size() / 3));
                        p.set("dry", std::span<const vec4>(volumes));
                    });
}

}  // namespace rivulet
