// The reference as a renderer: the iso-surface of the particles (Yu & Turk 2013), ray-marched on the host, in the light of the others, and
// with their spray: pictures differ by the surface alone.
#include <rivulet_glad/gl.h>

#include <cstddef>
#include <cstring>

#include "engine/core/assert.h"
#include "fluid/render/raymarch.h"
#include "fluid/render/renderers.h"

namespace rivulet {

// The last picture and its input.
struct MarchedReference {
    std::vector<vec4> particles;
    std::vector<float> until;
    FrameView view;
    Bounds box;
    float spacing = 0, holds = 0;
    RaymarchPicture picture;
};

namespace {

using gpu::Format;
using gpu::PassContext;
using gpu::TextureHandle;
using gpu::Usage;

template <class T>
void upload(const gpu::Texture& to, const std::vector<T>& texels) {
    const gpu::FormatInfo& format = gpu::formatInfo(to.desc().format);
    glTextureSubImage2D(to.name(), 0, 0, 0, to.width(), to.height(), format.layout, format.type, texels.data());
}

// Along the view axis, m, from window depth: depthOfWindow() of frame.glsl.
std::vector<float> sceneDepths(const gpu::Texture& window, const FrameView& view) {
    std::vector<float> depths(static_cast<size_t>(window.width()) * static_cast<size_t>(window.height()));
    window.read(std::as_writable_bytes(std::span(depths)));
    const float a = view.projection[2][2], b = view.projection[3][2];
    for (float& z : depths) z = view.parallel() ? (b + 1 - 2 * z) / a : b / (2 * z - 1 + a);
    return depths;
}

template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// A window that shows water at rest marches it once.
const RaymarchPicture* march(std::shared_ptr<MarchedReference>& last, MarchedReference now, const std::function<bool(double)>& progress) {
    const bool same = last && sameBytes(last->particles, now.particles) && sameBytes(last->until, now.until) &&
                      last->view.view == now.view.view && last->view.projection == now.view.projection &&
                      last->view.width == now.view.width && last->view.height == now.view.height && last->box.min == now.box.min &&
                      last->box.max == now.box.max && last->spacing == now.spacing && last->holds == now.holds;
    if (same) return &last->picture;
    const Result<IsoSurface> surface = IsoSurface::create(bodyAtWalls(now.particles, now.spacing, now.box, now.holds), now.spacing);
    ASSERT(surface, "a FluidView has a spacing of more than 0");
    bool whole = true;
    const auto report = [&](double share) {
        const bool on = progress(share);
        whole = whole && on;
        return on;
    };
    now.picture = raymarch(*surface, now.view, {.box = now.box, .until = now.until, .progress = report});
    last = std::make_shared<MarchedReference>(std::move(now));
    if (!whole) last->particles.clear();  // marched anew the next time
    return &last->picture;
}

}  // namespace

FluidLayers addReference(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    if (d.fluid.count == 0) return {d.colour, {}};
    gpu::TextureDesc size{.width = d.view.width, .height = d.view.height, .format = Format::r32f};
    // Spray and dye are matters of particles, not of their surface.
    WaterSurface water = addThickness(graph, programs, d, addTiles(graph, programs, d));
    water.depth = graph.texture("reference depth", size);
    size.format = Format::rgba32f;
    water.normals = graph.texture("reference normals", size);
    water.tiles = graph.texture("all tiles", {.width = 1, .height = 1, .format = Format::r8});
    graph.pass("all tiles", {}, {water.tiles}, [=](PassContext& c) {
        c.state({});
        c.drawTo({water.tiles}).clearColour(vec4(1.0F));
    });
    graph.pass("reference", {{d.position, Usage::copy}, {d.depth, Usage::copy}}, {{water.depth, Usage::copy}, {water.normals, Usage::copy}},
               [=, &programs](PassContext& c) {
                   c.state({});
                   std::vector<vec4> particles(d.fluid.count);
                   glGetNamedBufferSubData(c.buffer(d.position), 0, static_cast<GLsizeiptr>(particles.size() * sizeof(vec4)),
                                           particles.data());
                   const RaymarchPicture* const picture = march(programs.marched,
                                                                {.particles = std::move(particles),
                                                                 .until = sceneDepths(c.texture(d.depth), d.view),
                                                                 .view = d.view,
                                                                 .box = d.fluid.bounds,
                                                                 .spacing = d.fluid.spacing,
                                                                 .holds = holdsTogether(d.fluid.viscosity, d.fluid.spacing),
                                                                 .picture = {}},
                                                                d.progress);
                   upload(c.texture(water.depth), picture->depth);
                   upload(c.texture(water.normals), picture->water);
               });
    const FluidLayers layers = addShade(graph, programs, d, water);
    if (d.look.view == WaterView::water) addSpray(graph, programs, d, layers);
    return layers;
}

RendererRow referenceRenderer() {
    return {.name = "reference",
            .doc = "the same shading of the particles' iso-surface, ray-marched at full precision: takes seconds per frame",
            .opaque = false,
            .add = addReference};
}

}  // namespace rivulet
