// FluidPrograms: the shader programs of all renderers and filters, by name, and the ways to draw with them: a quad or a point for each row
// of a buffer, and the tiles of the picture that hold water.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/kernel_source.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/program.h"
#include "engine/gpu/vertex_array.h"
#include "fluid/render/fluid_view.h"
#include "fluid/render/kept_pictures.h"

namespace rivulet {

// A program that a renderer brings: two files under shaders/, and up to two defines, each set to 1.
struct ProgramRow {
    const char* name;  // unique among the programs of all renderers
    const char *vertex, *fragment;
    std::array<const char*, 2> defines = {};
};

// A buffer that the vertex shader of a quad reads, one element for each row.
struct QuadRows {
    unsigned buffer = 0;       // GL name; 0: none
    unsigned format = 0x8814;  // GL_RGBA32F
};

// Rows of a buffer, from `first` on.
struct RowRange {
    uint32_t first = 0, count = 0;
};

// How large particles are in the picture that they are drawn into.
struct Splats {
    vec2 target = vec2(0.0F);  // pixels of that picture
    float largest = 0;         // pixels, a bound on the diameter; infinite: none is known
};

struct FilterRow;  // fluid/render/filters.h
struct MarchedReference;

struct FluidPrograms {
    std::map<std::string, gpu::Program, std::less<>> programs;
    gpu::VertexArray quads, none;
    gpu::Buffer quadIndices;
    std::array<gpu::TextureName, 7> rowTextures;
    std::array<bool, 7> rowsThere = {};         // it has a buffer
    std::shared_ptr<MarchedReference> marched;  // the last picture of the row `reference`
    KeptPictures kept;                          // of sleeping particles
    uint32_t mostTexels = 0;                    // of a buffer that shaders read as a texture: the limit of this GPU
    float largestPoint = 0.0F;                  // pixels: the limit of this GPU

    // The programs of renderers() and filters(), and those that all share. Error (failed): a shader does not compile; out of memory.
    static Result<FluidPrograms> create(const ShaderFiles& files);
    gpu::Program& operator[](std::string_view name);  // of a ProgramRow; an unknown name is a mistake (ASSERT)
    // Of a program with a variant "NAME, ellipsoids": that variant where the fluid has ellipsoids, else the one for spheres.
    gpu::Program& splat(std::string_view name, const FluidView& fluid);
    gpu::Program& filter(const FilterRow& row, bool last);  // of its passes: the last one, or those before
    std::vector<gpu::Program*> all();
    // The programs were made in another context, which shares its objects with the one that is current now.
    void contextChanged();
    // Error (failed): there are more rows than this GPU can read.
    Status fits(const FluidView& fluid) const;
    // Draws a quad for each row in `range` with the program in use. Its vertex shader includes quads.glsl; rows[k] is its ROWS(k, ...).
    void drawQuads(gpu::Program& program, const RowRange& range, std::span<const QuadRows> rows);
    // The same for particles. The vertex shader includes particle.glsl.
    void drawParticles(gpu::Program& program, const FluidView& fluid, const RowRange& range);
    // The same as points, a quarter of the vertices, where none is larger than a point may be. The vertex shader uses splatQuad(), or sets
    // gl_PointSize if asPoint().
    void drawSplats(gpu::Program& program, const FluidView& fluid, const Splats& splats, const RowRange& range);
    // What both begin with: binds the buffers, says which rows are drawn.
    void bindRows(gpu::Program& program, const RowRange& range, std::span<const QuadRows> rows);
    // Draws the marked tiles with the program in use. Its vertex shader is tile.vert; the mask is bound to `unit`.
    void drawTiles(gpu::Program& program, const gpu::Texture& tiles, int unit);
};

}  // namespace rivulet
