#include "fluid/render/renderers.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rivulet {

// One a renderer, in the file that draws it.
RendererRow pointsRenderer();
RendererRow screenSpaceRenderer();
RendererRow referenceRenderer();

namespace {
constexpr float kMostLarger = 8.0F;  // times that one is larger which represents as many as it can
constexpr int kTilePixels = 32;      // pixels
constexpr float kLongest = 4.0F;     // radii, of what is drawn: kOverlap of particle.glsl, times an ellipsoid's longest half axis (2.6)
}  // namespace

const Table<RendererRow>& renderers() {
    static const RendererRow rows[] = {pointsRenderer(), screenSpaceRenderer(), referenceRenderer()};
    static const Table<RendererRow> table{rows};
    return table;
}

std::vector<gpu::Read> splatReads(const FluidDraw& d) {
    std::vector<gpu::Read> reads = {{d.frame, gpu::Usage::uniform}, {d.position, gpu::Usage::sampled}};
    if (d.id) reads.emplace_back(d.id, gpu::Usage::sampled);
    for (const gpu::BufferHandle ellipsoids : d.ellipsoids) reads.emplace_back(ellipsoids, gpu::Usage::sampled);
    return reads;
}

// Ids decide which particles represent others.
float detailOf(const FluidDraw& d) { return d.fluid.id != 0 ? d.look.detail : 0.0F; }

Splats splatsOf(const FluidDraw& d, float radius, int scale) {
    const vec2 target((d.view.width + scale - 1) / scale, (d.view.height + scale - 1) / scale);
    float nearest = std::numeric_limits<float>::infinity();
    const Bounds& b = d.fluid.bounds;
    for (int k = 0; k < 8 && !b.empty(); ++k) {
        const vec3 corner((k & 1) != 0 ? b.max.x : b.min.x, (k & 2) != 0 ? b.max.y : b.min.y, (k & 4) != 0 ? b.max.z : b.min.z);
        nearest = std::min(nearest, -(d.view.view * vec4(corner, 1.0F)).z);
    }
    nearest -= kLongest * radius;
    if (b.empty() || !(nearest > d.view.nearPlane)) return {target, std::numeric_limits<float>::infinity()};
    // Off the axis of the picture, a sphere's image is longer by the ray's length over its depth.
    const mat4& p = d.view.projection;
    const float wide = std::abs(p[0][0]), tall = std::abs(p[1][1]);
    const float x = (1.0F + std::abs(p[2][0])) / wide, y = (1.0F + std::abs(p[2][1])) / tall;
    const float pixels = std::max(wide * target.x, tall * target.y);  // of 2 m at a depth of 1 m
    const float slant = d.view.parallel() ? 1.0F : std::sqrt(1.0F + x * x + y * y);
    const float largest = kLongest * radius * slant * pixels / d.view.spreadAt(nearest);
    // From afar one represents others, and is larger: see representedBy().
    const float far = std::min(kMostLarger * largest, 2 * kLongest * kMostLarger * detailOf(d));
    return {target, detailOf(d) > 0 ? std::max(largest, far) : largest};
}

void copyTexels(gpu::FrameGraph& graph, const char* name, gpu::TextureHandle from, gpu::TextureHandle to,
                const std::function<void()>& done) {
    graph.pass(name, {{from, gpu::Usage::copy}}, {{to, gpu::Usage::copy}}, [=](gpu::PassContext& c) {
        c.state({});
        const gpu::Texture &a = c.texture(from), &b = c.texture(to);
        glCopyImageSubData(a.name(), GL_TEXTURE_2D, 0, 0, 0, 0, b.name(), GL_TEXTURE_2D, 0, 0, 0, 0, a.width(), a.height(), 1);
        if (done) done();
    });
}

gpu::TextureHandle addSceneAndWaterDepth(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const FluidLayers& layers) {
    if (!layers.fluidDepth) return d.depth;
    const gpu::TextureHandle depth = graph.texture("scene and water depth", graph.desc(d.depth));
    graph.pass("scene and water depth", {{d.frame, gpu::Usage::uniform}, d.depth, layers.fluidDepth}, {depth},
               [=, &programs](gpu::PassContext& c) {
                   c.drawTo({}, depth);
                   c.state({.depthTest = true, .depthFunction = GL_ALWAYS});
                   glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
                   gpu::Program& p = programs["scene and water depth"];
                   p.use();
                   p.texture("sceneDepth", 0, c.texture(d.depth));
                   p.texture("waterDepth", 1, c.texture(layers.fluidDepth));
                   c.drawFullscreen();
               });
    return depth;
}

gpu::TextureDesc tilesOf(const FrameView& view) {
    return {.width = (view.width + kTilePixels - 1) / kTilePixels,
            .height = (view.height + kTilePixels - 1) / kTilePixels,
            .format = gpu::Format::r8};
}

gpu::TextureHandle addTiles(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    const gpu::TextureDesc size = tilesOf(d.view);
    const gpu::TextureHandle tiles = graph.texture("water tiles", size);
    graph.pass("tiles", splatReads(d), {tiles}, [=, &programs](gpu::PassContext& c) {
        c.state({});
        c.drawTo({tiles}).clearColour(vec4(0.0F));
        glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame));
        gpu::Program& mark = programs.splat("mark tiles", d.fluid);
        mark.use();
        mark.set("radius", d.fluid.radius);
        mark.set("tiles", vec2(size.width, size.height));
        programs.drawParticles(mark, d.fluid, {0, d.fluid.count});
    });
    return tiles;
}

float volumeScale(const FluidView& fluid) {
    const float ratio = fluid.spacing / fluid.radius;
    return ratio * ratio * ratio / (4.0F / 3.0F * kPi);
}

}  // namespace rivulet
