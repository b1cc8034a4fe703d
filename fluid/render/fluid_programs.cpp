#include "fluid/render/fluid_programs.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include "engine/core/assert.h"
#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {

namespace {

constexpr GLuint kRowUnit = 24;       // as quads.glsl
constexpr uint32_t kQuadRows = 4096;  // as quads.glsl: their indices fit 16 bits

// Programs that all renderers share. The others are in the renderers' rows.
constexpr ProgramRow kShared[] = {
    {"mark tiles", "screen_space/mark_tiles.vert", "screen_space/mark_tiles.frag"},
    {"mark tiles, ellipsoids", "screen_space/mark_tiles.vert", "screen_space/mark_tiles.frag", {"ELLIPSOIDS"}},
    {"photons", "render/fullscreen.vert", "screen_space/photons.frag"},
    {"caustics, dry", "render/fullscreen.vert", "screen_space/caustics.frag", {"BASE"}},
    {"caustics", "screen_space/caustics.vert", "screen_space/caustics.frag"},
    {"spray", "screen_space/spray.vert", "screen_space/spray.frag"},
    {"spray, ink", "screen_space/spray.vert", "screen_space/spray.frag", {"INK"}},
    {"drops", "screen_space/drop.vert", "screen_space/drop.frag"},
    {"drops over water", "screen_space/drop.vert", "screen_space/drop.frag", {"OVER_WATER"}},
    {"pendants", "screen_space/pendant.vert", "screen_space/pendant.frag"},
    {"pendants over water", "screen_space/pendant.vert", "screen_space/pendant.frag", {"OVER_WATER"}},
    {"scene and water depth", "render/fullscreen.vert", "screen_space/scene_and_water_depth.frag"},
    {"foam", "screen_space/foam.vert", "screen_space/foam.frag"},
    {"foam over water", "screen_space/foam.vert", "screen_space/foam.frag", {"OVER_WATER"}},
};

std::string filterProgram(const FilterRow& row, bool last) { return fmt::format("filter {}{}", row.name, last ? ", last" : ""); }

Status addProgram(FluidPrograms& to, const ShaderFiles& files, const std::string& name, const ProgramRow& row) {
    std::vector<Define> defines;
    for (const char* define : row.defines)
        if (define != nullptr) defines.push_back({define, "1"});
    Result<gpu::Program> program =
        gpu::Program::create(files, {fmt::format("shaders/{}", row.vertex), fmt::format("shaders/{}", row.fragment)}, defines);
    if (!program) return program.error();
    const bool unique = to.programs.emplace(name, std::move(*program)).second;
    ASSERT(unique, "give each ProgramRow a name of its own");
    return ok();
}

Status addPrograms(FluidPrograms& to, const ShaderFiles& files, std::span<const ProgramRow> rows) {
    for (const ProgramRow& row : rows)
        if (Status added = addProgram(to, files, row.name, row); !added) return added;
    return ok();
}

}  // namespace

Result<FluidPrograms> FluidPrograms::create(const ShaderFiles& files) {
    FluidPrograms p;
    if (Status added = addPrograms(p, files, kShared); !added) return added.error();
    for (const RendererRow& row : renderers().rows)
        if (Status added = addPrograms(p, files, row.programs); !added) return added.error();
    for (const FilterRow& row : filters().rows) {
        for (const bool last : {false, true}) {
            if (!last && !row.smooths) continue;
            const ProgramRow pass{"", "screen_space/tile.vert", row.shader, {last ? "LAST" : nullptr}};
            if (Status added = addProgram(p, files, filterProgram(row, last), pass); !added) return added.error();
        }
    }
    std::vector<uint16_t> corners;
    for (uint32_t k = 0; k < kQuadRows; ++k)
        for (const uint32_t corner : {0U, 1U, 2U, 2U, 1U, 3U}) corners.push_back(static_cast<uint16_t>(4 * k + corner));
    Result<gpu::Buffer> indices = gpu::Buffer::from(corners);
    if (!indices) return indices.error();
    p.quadIndices = std::move(*indices);
    for (gpu::TextureName& texture : p.rowTextures) {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
        texture = gpu::TextureName(name);
    }
    p.contextChanged();
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    p.mostTexels = static_cast<uint32_t>(most);
    std::array<GLfloat, 2> sizes{};
    glGetFloatv(GL_POINT_SIZE_RANGE, sizes.data());
    p.largestPoint = sizes[1];
    return p;
}

gpu::Program& FluidPrograms::operator[](std::string_view name) {
    const auto at = programs.find(name);
    ASSERT(at != programs.end(), "name a ProgramRow of a renderer");
    return at->second;
}

gpu::Program& FluidPrograms::splat(std::string_view name, const FluidView& fluid) {
    return fluid.ellipsoids[0] != 0 ? (*this)[fmt::format("{}, ellipsoids", name)] : (*this)[name];
}

gpu::Program& FluidPrograms::filter(const FilterRow& row, bool last) { return (*this)[filterProgram(row, last)]; }

std::vector<gpu::Program*> FluidPrograms::all() {
    std::vector<gpu::Program*> all;
    for (auto& [name, program] : programs) all.push_back(&program);
    return all;
}

void FluidPrograms::contextChanged() {
    quads.release();
    none.release();
    quads = gpu::VertexArray::create();
    quads.elements(quadIndices.name());
    none = gpu::VertexArray::create();
}

Status FluidPrograms::fits(const FluidView& fluid) const {
    struct Rows {
        uint32_t count, texelsEach;
        const char *what, *fewer;
    };
    for (const Rows& rows : {Rows{fluid.count, 1, "particles", "a larger fluid.spacing or a smaller fluid.maxParticles"},
                             Rows{fluid.foamCount, 1, "flecks of foam", "a smaller fluid.foam.most"},
                             Rows{fluid.dropCount, 2, "drops in the air", "fewer drops on skins"},
                             Rows{fluid.bodyCount, sizeof(DeviceBody) / sizeof(vec4), "bodies", "fewer of them"},
                             Rows{fluid.pendantCount, 5, "drops that hang", "fewer drops on skins"}})
        if (rows.count > mostTexels / rows.texelsEach)
            return failed(fmt::format("{} {} are more than the {} that this GPU can draw: ask for {}, or run without pictures", rows.count,
                                      rows.what, mostTexels / rows.texelsEach, rows.fewer));
    return ok();
}

void FluidPrograms::bindRows(gpu::Program& program, const RowRange& range, std::span<const QuadRows> rows) {
    // A texture without a buffer is read as zeros.
    std::array<GLuint, std::tuple_size_v<decltype(rowTextures)>> names{};
    for (size_t k = 0; k < names.size(); ++k) {
        const QuadRows row = k < rows.size() ? rows[k] : QuadRows();
        names[k] = rowTextures[k].name();
        if (row.buffer != 0 || rowsThere[k]) glTextureBuffer(names[k], row.format, row.buffer);
        rowsThere[k] = row.buffer != 0;
    }
    glBindTextures(kRowUnit, static_cast<GLsizei>(names.size()), names.data());
    program.set("firstRow", range.first);
    program.set("rows", range.first + range.count);
}

void FluidPrograms::drawQuads(gpu::Program& program, const RowRange& range, std::span<const QuadRows> rows) {
    const uint32_t count = range.count;
    if (count == 0) return;
    bindRows(program, range, rows);
    program.set("pointTarget", vec2(0.0F));
    quads.bind();
    const uint32_t instances = (count + kQuadRows - 1) / kQuadRows, quadsEach = instances > 1 ? kQuadRows : count;
    glDrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(6 * quadsEach), GL_UNSIGNED_SHORT, nullptr, static_cast<GLsizei>(instances));
}

namespace {
std::array<QuadRows, 7> rowsOf(gpu::Program& program, const FluidView& fluid) {
    program.set("holds", holdsTogether(fluid.viscosity, fluid.spacing));
    return {QuadRows{fluid.position}, {fluid.velocity},      {fluid.id, GL_R32UI}, {fluid.absorption},
            {fluid.ellipsoids[0]},    {fluid.ellipsoids[1]}, {fluid.ellipsoids[2]}};
}
}  // namespace

void FluidPrograms::drawParticles(gpu::Program& program, const FluidView& fluid, const RowRange& range) {
    drawQuads(program, range, rowsOf(program, fluid));
}

void FluidPrograms::drawSplats(gpu::Program& program, const FluidView& fluid, const Splats& splats, const RowRange& range) {
    if (range.count == 0) return;
    if (!(splats.largest <= largestPoint)) {
        drawParticles(program, fluid, range);
        return;
    }
    const std::array<QuadRows, 7> rows = rowsOf(program, fluid);
    bindRows(program, range, rows);
    program.set("pointTarget", splats.target);
    none.bind();
    glEnable(GL_PROGRAM_POINT_SIZE);
    glDrawArrays(GL_POINTS, static_cast<GLint>(range.first), static_cast<GLsizei>(range.count));
    glDisable(GL_PROGRAM_POINT_SIZE);
}

void FluidPrograms::drawTiles(gpu::Program& program, const gpu::Texture& tiles, int unit) {
    program.texture("tileMask", unit, tiles);
    none.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, tiles.width() * tiles.height());
}

}  // namespace rivulet
