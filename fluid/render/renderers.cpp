#include "fluid/render/renderers.h"

#include <fmt/format.h>

#include <cmath>

namespace rivulet {

namespace {
constexpr RendererRow kRows[] = {
    {"points", "every particle as a lit sphere, coloured by speed, density, id, dye, normal or surface", true, addPoints},
    {"screen_space", "a water surface from the particles' smoothed depth: refraction, absorption, reflection", false, addScreenSpace},
    {"reference", "the same shading of the particles' iso-surface, ray-marched at full precision: seconds a frame", false, addReference},
};
constexpr Table<RendererRow> kRenderers{kRows};
constexpr ViewRow kViewRows[] = {
    {"water", "the water", WaterView::water},
    {"normals", "the surface's normals: their parts along x, y, z as red, green, blue", WaterView::normals},
    {"depth", "the surface's depth, as the filter leaves it: white is near", WaterView::depth},
    {"spheres", "the particles' depth, before the filter", WaterView::spheres},
    {"thickness", "how much water there is along the line of sight", WaterView::thickness},
};
constexpr Table<ViewRow> kViews{kViewRows};
constexpr int kTile = 32;             // pixels
constexpr GLuint kRowUnit = 24;       // as quads.glsl
constexpr uint32_t kQuadRows = 4096;  // as quads.glsl: their indices fit 16 bits
}  // namespace

const Table<RendererRow>& renderers() { return kRenderers; }
const Table<ViewRow>& waterViews() { return kViews; }

std::vector<gpu::Program*> FluidPrograms::all() {
    std::vector<gpu::Program*> programs = {&waterBlocks, &waterTiles,     &refine,          &points,          &pointsShade, &blur,
                                           &shade,       &lightWater,     &lightWaterFirst, &lightWaterLast,  &shadeInk,    &showView,
                                           &drops,       &dropsOverWater, &shadeNormals,    &shadeNormalsInk, &foam,        &foamOverWater};
    for (SplatPrograms* splat : {&spheres, &ellipsoids})
        for (gpu::Program* program : {&splat->occluder, &splat->markTiles, &splat->depth, &splat->thickness, &splat->thicknessInk})
            programs.push_back(program);
    for (FilterPrograms* filter : {&narrowRange, &bilateral, &curvatureFlow, &unfiltered})
        for (gpu::Program* program : {&filter->step, &filter->last})
            if (*program) programs.push_back(program);
    return programs;
}

Result<FluidPrograms> FluidPrograms::create(const ShaderFiles& files) {
    using gpu::Program;
    const std::string folder = "shaders/screen_space/", full = "shaders/render/fullscreen.vert", tile = folder + "tile.vert",
                      sphere = folder + "sphere.vert";
    FluidPrograms p;
    std::vector<std::pair<Program*, Result<Program>>> made;
    for (SplatPrograms* splat : {&p.spheres, &p.ellipsoids}) {
        std::vector<Define> shape, ink = {{"INK", "1"}};
        if (splat == &p.ellipsoids) {
            shape = {{"ELLIPSOIDS", "1"}};
            ink.push_back(shape.front());
        }
        made.emplace_back(&splat->occluder, Program::create(files, {folder + "occluder.vert", "shaders/render/depth.frag"}, shape));
        made.emplace_back(&splat->markTiles, Program::create(files, {folder + "mark_tiles.vert", folder + "mark_tiles.frag"}, shape));
        made.emplace_back(&splat->depth, Program::create(files, {sphere, folder + "depth.frag"}, shape));
        made.emplace_back(&splat->thickness, Program::create(files, {sphere, folder + "thickness.frag"}, shape));
        made.emplace_back(&splat->thicknessInk, Program::create(files, {sphere, folder + "thickness.frag"}, ink));
    }
    std::pair<Program*, Result<Program>> others[] = {
        {&p.waterBlocks, Program::create(files, {full, folder + "water_blocks.frag"})},
        {&p.waterTiles, Program::create(files, {full, folder + "water_tiles.frag"})},
        {&p.refine, Program::create(files, {tile, folder + "refine.frag"})},
        {&p.showView, Program::create(files, {tile, folder + "show_view.frag"})},
        {&p.points, Program::create(files, {folder + "points.vert", folder + "points.frag"})},
        {&p.pointsShade, Program::create(files, {tile, folder + "points_shade.frag"})},
        {&p.narrowRange.step, Program::create(files, {tile, folder + "narrow_range.frag"})},
        {&p.narrowRange.last, Program::create(files, {tile, folder + "narrow_range.frag"}, {{"LAST", "1"}})},
        {&p.bilateral.step, Program::create(files, {tile, folder + "bilateral.frag"})},
        {&p.bilateral.last, Program::create(files, {tile, folder + "bilateral.frag"}, {{"LAST", "1"}})},
        {&p.curvatureFlow.step, Program::create(files, {tile, folder + "curvature_flow.frag"})},
        {&p.curvatureFlow.last, Program::create(files, {tile, folder + "curvature_flow.frag"}, {{"LAST", "1"}})},
        {&p.unfiltered.last, Program::create(files, {tile, folder + "unfiltered.frag"}, {{"LAST", "1"}})},
        {&p.blur, Program::create(files, {tile, folder + "blur.frag"})},
        {&p.shade, Program::create(files, {tile, folder + "shade.frag"})},
        {&p.lightWater, Program::create(files, {folder + "light_water.vert", folder + "light_water.frag"})},
        {&p.lightWaterFirst, Program::create(files, {full, folder + "light_water_blur.frag"})},
        {&p.lightWaterLast, Program::create(files, {full, folder + "light_water_blur.frag"}, {{"LAST", "1"}})},
        {&p.shadeInk, Program::create(files, {tile, folder + "shade.frag"}, {{"INK", "1"}})},
        {&p.shadeNormals, Program::create(files, {tile, folder + "shade.frag"}, {{"NORMALS", "1"}})},
        {&p.shadeNormalsInk, Program::create(files, {tile, folder + "shade.frag"}, {{"NORMALS", "1"}, {"INK", "1"}})},
        {&p.drops, Program::create(files, {folder + "drop.vert", folder + "drop.frag"})},
        {&p.dropsOverWater, Program::create(files, {folder + "drop.vert", folder + "drop.frag"}, {{"OVER_WATER", "1"}})},
        {&p.foam, Program::create(files, {folder + "foam.vert", folder + "foam.frag"})},
        {&p.foamOverWater, Program::create(files, {folder + "foam.vert", folder + "foam.frag"}, {{"OVER_WATER", "1"}})},
    };
    for (auto& other : others) made.push_back(std::move(other));
    for (auto& [into, program] : made) {
        if (!program) return program.error();
        *into = std::move(*program);
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
    return p;
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
                             Rows{fluid.dropCount, 2, "drops in the air", "fewer drops on skins"}})
        if (rows.count > mostTexels / rows.texelsEach)
            return failed(fmt::format("{} {} are more than the {} that this GPU can draw: ask for {}, or run without pictures", rows.count,
                                      rows.what, mostTexels / rows.texelsEach, rows.fewer));
    return ok();
}

void FluidPrograms::drawQuads(gpu::Program& program, uint32_t count, std::span<const QuadRows> rows) {
    if (count == 0) return;
    for (GLuint k = 0; k < rows.size(); ++k) {
        if (rows[k].buffer == 0) continue;
        glTextureBuffer(rowTextures[k].name(), rows[k].format, rows[k].buffer);
        glBindTextureUnit(kRowUnit + k, rowTextures[k].name());
    }
    program.set("rows", count);
    quads.bind();
    const uint32_t instances = (count + kQuadRows - 1) / kQuadRows, quadsEach = instances > 1 ? kQuadRows : count;
    glDrawElementsInstanced(GL_TRIANGLES, static_cast<GLsizei>(6 * quadsEach), GL_UNSIGNED_SHORT, nullptr, static_cast<GLsizei>(instances));
    for (GLuint k = 0; k < rows.size(); ++k) glBindTextureUnit(kRowUnit + k, 0);
}

void FluidPrograms::drawParticles(gpu::Program& program, const FluidView& fluid, uint32_t count) {
    const QuadRows rows[] = {{fluid.position},      {fluid.velocity},      {fluid.id, GL_R32UI}, {fluid.absorption},
                             {fluid.ellipsoids[0]}, {fluid.ellipsoids[1]}, {fluid.ellipsoids[2]}};
    drawQuads(program, count, rows);
}

std::vector<gpu::Read> splatReads(const FluidDraw& d) {
    std::vector<gpu::Read> reads = {{d.frame, gpu::Usage::uniform}, {d.position, gpu::Usage::sampled}};
    for (const gpu::BufferHandle ellipsoids : d.ellipsoids) reads.emplace_back(ellipsoids, gpu::Usage::sampled);
    return reads;
}

gpu::TextureDesc tilesOf(const FrameView& view) {
    return {.width = (view.width + kTile - 1) / kTile, .height = (view.height + kTile - 1) / kTile, .format = gpu::Format::r8};
}

gpu::TextureHandle addTiles(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    const gpu::TextureDesc size = tilesOf(d.view);
    const gpu::TextureHandle tiles = graph.texture("water tiles", size);
    graph.pass("tiles", splatReads(d), {tiles}, [=, &programs](gpu::PassContext& c) {
        c.drawTo({tiles}).clearColour(vec4(0.0F));
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        gpu::Program& mark = programs.splats(d.fluid).markTiles;
        mark.use();
        mark.set("radius", d.fluid.radius);
        mark.set("tiles", vec2(size.width, size.height));
        programs.drawParticles(mark, d.fluid, d.fluid.count);
    });
    return tiles;
}

void FluidPrograms::drawTiles(gpu::Program& program, const gpu::Texture& tiles, int unit) {
    program.texture("tileMask", unit, tiles);
    none.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, tiles.width() * tiles.height());
}

float volumeScale(const FluidView& fluid) {
    const float ratio = fluid.spacing / fluid.radius;
    return ratio * ratio * ratio / (4.0F / 3.0F * kPi);
}

}  // namespace rivulet
