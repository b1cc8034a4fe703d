// Filters: smooth the particles' depth into a surface. Their lengths are in metres, so that the surface depends neither on the resolution
// nor on the distance.
#pragma once

#include <rivulet_glad/gl.h>

#include <utility>
#include <vector>

#include "fluid/render/renderers.h"

namespace rivulet {

struct FilterRow {
    const char* name;
    const char* doc;
    const char* shader;  // of its passes, under shaders/; includes filter.glsl and is compiled with LAST defined for the last pass
    bool smooths;        // false: one pass, which leaves the depth as it is
    // `own`: this row. `spheres`: r32f, their depth, m. Returns the depth of the surface: r32f, m, 1e6 where there is none.
    gpu::TextureHandle (*add)(const FilterRow& own, gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw,
                              gpu::TextureHandle tiles, gpu::TextureHandle spheres);
    bool knowsBox = false;  // all of its passes read the box of the water, not only the last one
};
const Table<FilterRow>& filters();
const FilterRow& unfiltered();  // the row that does not smooth

// The lengths of the look, m; one that is 0 follows from the spacing.
struct FilterReach {
    float reach, range, bend;
};
FilterReach filterReach(const FluidLook& look, float spacing);

// A pass over the tiles from one texture to another of `desc`, `empty` elsewhere. `setup(program, context)` sets the uniforms;
// texture unit 0 holds the source, unit 1 the tiles.
template <class Setup>
gpu::TextureHandle addTiled(gpu::FrameGraph& graph, const char* name, FluidPrograms& programs, const FluidDraw& d, gpu::Program& program,
                            gpu::TextureHandle tiles, gpu::TextureHandle from, const gpu::TextureDesc& desc, float empty, Setup setup) {
    const gpu::TextureHandle to = graph.texture(name, desc);
    graph.pass(name, {{d.frame, gpu::Usage::uniform}, tiles, from}, {to}, [=, &programs, &program](gpu::PassContext& c) {
        c.state({});
        c.drawTo({to}).clearColour(vec4(empty));
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        program.use();
        program.texture("source", 0, c.texture(from));
        setup(program, c);
        programs.drawTiles(program, c.texture(tiles), 1);
    });
    return to;
}

}  // namespace rivulet
