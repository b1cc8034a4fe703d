// A water surface in screen space: sphere depths (van der Laan et al. 2009), smoothed by a row of filters().
#include <algorithm>
#include <cmath>

#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"

namespace rivulet {
namespace {

using gpu::Format;
using gpu::FrameGraph;
using gpu::PassContext;
using gpu::Program;
using gpu::TextureDesc;
using gpu::TextureHandle;
using gpu::Usage;

constexpr int kThicknessScale = 2, kThicknessScaleFast = 4;  // of the resolution
constexpr int kThicknessBlur = 4;                            // texels either side
constexpr int kLightMap = 256;                               // texels
constexpr int kLightMapFast = 128;

constexpr ProgramRow kScreenSpacePrograms[] = {
    {"occluder", "screen_space/occluder.vert", "render/depth.frag"},
    {"occluder, ellipsoids", "screen_space/occluder.vert", "render/depth.frag", {"ELLIPSOIDS"}},
    {"depth", "screen_space/sphere.vert", "screen_space/depth.frag"},
    {"depth, ellipsoids", "screen_space/sphere.vert", "screen_space/depth.frag", {"ELLIPSOIDS"}},
    {"thickness", "screen_space/sphere.vert", "screen_space/thickness.frag"},
    {"thickness, ellipsoids", "screen_space/sphere.vert", "screen_space/thickness.frag", {"ELLIPSOIDS"}},
    {"thickness, ink", "screen_space/sphere.vert", "screen_space/thickness.frag", {"INK"}},
    {"thickness, ink, ellipsoids", "screen_space/sphere.vert", "screen_space/thickness.frag", {"INK", "ELLIPSOIDS"}},
    {"water blocks", "render/fullscreen.vert", "screen_space/water_blocks.frag"},
    {"water tiles", "render/fullscreen.vert", "screen_space/water_tiles.frag"},
    {"refine", "screen_space/tile.vert", "screen_space/refine.frag"},
    {"show view", "screen_space/tile.vert", "screen_space/show_view.frag"},
    {"blur", "screen_space/tile.vert", "screen_space/blur.frag"},
    {"light water", "screen_space/light_water.vert", "screen_space/light_water.frag"},
    {"light water blur, first", "render/fullscreen.vert", "screen_space/light_water_blur.frag"},
    {"light water blur, last", "render/fullscreen.vert", "screen_space/light_water_blur.frag", {"LAST"}},
    {"shade", "screen_space/tile.vert", "screen_space/shade.frag"},
    {"shade, ink", "screen_space/tile.vert", "screen_space/shade.frag", {"INK"}},
    {"shade, normals", "screen_space/tile.vert", "screen_space/shade.frag", {"NORMALS"}},
    {"shade, normals, ink", "screen_space/tile.vert", "screen_space/shade.frag", {"NORMALS", "INK"}},
};

// With look.quality fast, half of the particles represent all of them, with twice the volume.
struct Drawn {
    uint32_t count;
    float standsFor, larger;
};
Drawn drawnOf(const FluidDraw& d) {
    if (d.look.fast && d.fluid.half > 0) return {d.fluid.half, 2.0F, std::cbrt(2.0F)};
    return {d.fluid.count, 1.0F, 1.0F};
}

void useFrame(const PassContext& c, const FluidDraw& d) { glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame)); }

// x: depth of the bulk, y: of the spray; m. `prepare`: first draws occluders for spheres deep in the water; this pays off if spheres cover
// many pixels.
TextureHandle addSphereDepth(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, bool prepare) {
    TextureDesc size{.width = d.view.width, .height = d.view.height, .format = Format::rg32f};
    const TextureHandle depth = graph.texture("sphere depth", size);
    size.format = Format::depth32f;
    const TextureHandle hidden = graph.texture("fluid occluders", size);
    graph.pass("fluid depth", splatReads(d), {depth, hidden}, [=, &programs](PassContext& c) {
        const gpu::Framebuffer& target = c.drawTo({depth}, hidden);
        useFrame(c, d);
        target.clearColour(vec4(kNoDepth));
        target.clearDepth();
        if (prepare) {
            glEnable(GL_DEPTH_TEST);
            glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
            Program& occluder = programs.splat("occluder", d.fluid);
            occluder.use();
            occluder.set("radius", d.fluid.radius);
            programs.drawParticles(occluder, d.fluid, d.fluid.count);
            glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
            glDepthMask(GL_FALSE);
        }
        glEnable(GL_BLEND);
        glBlendEquation(GL_MIN);
        Program& p = programs.splat("depth", d.fluid);
        p.use();
        p.set("radius", d.fluid.radius);
        programs.drawParticles(p, d.fluid, d.fluid.count);
    });
    return depth;
}

// Finds the tiles that contain water from the spheres' depth, which costs less than drawing all particles again.
TextureHandle addTilesOf(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle spheres) {
    const TextureDesc from = graph.desc(spheres), size = tilesOf(d.view);
    const TextureHandle blocks =
        graph.texture("water blocks", {.width = (from.width + 7) / 8, .height = (from.height + 7) / 8, .format = Format::r8});
    const TextureHandle tiles = graph.texture("water tiles", size);
    graph.pass("tiles", {spheres}, {blocks}, [=, &programs](PassContext& c) {
        c.drawTo({blocks});
        Program& p = programs["water blocks"];
        p.use();
        p.texture("depths", 0, c.texture(spheres));
        c.drawFullscreen();
    });
    graph.pass("tiles", {blocks}, {tiles}, [=, &programs](PassContext& c) {
        c.drawTo({tiles});
        Program& p = programs["water tiles"];
        p.use();
        p.texture("blocks", 0, c.texture(blocks));
        p.set("perTile", vec2(from.width, from.height) / vec2(size.width, size.height));
        c.drawFullscreen();
    });
    return tiles;
}

// Draws an intermediate result of the surface instead of the water.
struct Shown {
    TextureHandle tiles, depth, thickness, colour;
};
void addView(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const Shown& of) {
    vec2 depths(d.view.nearPlane, d.view.farPlane);
    float wide = d.view.farPlane;
    if (!d.fluid.bounds.empty()) {
        depths = vec2(d.view.farPlane, d.view.nearPlane);
        for (int k = 0; k < 8; ++k) {
            const Bounds& b = d.fluid.bounds;
            const vec3 corner((k & 1) != 0 ? b.max.x : b.min.x, (k & 2) != 0 ? b.max.y : b.min.y, (k & 4) != 0 ? b.max.z : b.min.z);
            const float depth = std::max(-(d.view.view * vec4(corner, 1.0F)).z, d.view.nearPlane);
            depths = vec2(std::min(depths.x, depth), std::max(depths.y, depth));
        }
        const vec3 size = d.fluid.bounds.size();
        wide = std::max({size.x, size.y, size.z});
    }
    graph.pass("view", {{d.frame, Usage::uniform}, of.tiles, of.depth, of.thickness, d.colour, d.depth}, {of.colour},
               [=, &programs](PassContext& c) {
                   c.drawTo({of.colour});
                   useFrame(c, d);
                   Program& p = programs["show view"];
                   p.use();
                   p.texture("sceneColour", 0, c.texture(d.colour));
                   p.texture("sceneDepth", 1, c.texture(d.depth));
                   p.texture("fluidDepth", 2, c.texture(of.depth));
                   p.texture("thickness", 3, c.texture(of.thickness));
                   p.set("what", static_cast<int>(d.look.view));
                   p.set("depths", depths);
                   p.set("fullThickness", wide);
                   programs.drawTiles(p, c.texture(of.tiles), 4);
               });
}

}  // namespace

WaterSurface addThickness(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles) {
    const int scale = d.look.fast ? kThicknessScaleFast : kThicknessScale;
    const TextureDesc size{
        .width = (d.view.width + scale - 1) / scale, .height = (d.view.height + scale - 1) / scale, .format = Format::rg16f};
    const bool ink = d.fluid.absorption != 0;
    TextureDesc inkSize = size;
    inkSize.format = Format::rgba16f;
    TextureHandle thickness = graph.texture("thickness", size), depths;
    std::vector<gpu::Read> reads = splatReads(d);
    reads.emplace_back(d.depth);
    std::vector<gpu::Write> writes = {thickness};
    if (ink) {
        depths = graph.texture("ink depths", inkSize);
        reads.emplace_back(d.absorption, Usage::sampled);
        writes.emplace_back(depths);
    }
    graph.pass("thickness", reads, writes, [=, &programs](PassContext& c) {
        const gpu::Framebuffer& target = ink ? c.drawTo({thickness, depths}) : c.drawTo({thickness});
        target.clearColour(vec4(0.0F), 0);
        if (ink) target.clearColour(vec4(0.0F), 1);
        useFrame(c, d);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        Program& p = programs.splat(ink ? "thickness, ink" : "thickness", d.fluid);
        p.use();
        if (ink) p.set("ownAbsorption", vec4(d.look.absorption, d.look.scattering.y));
        const Drawn some = drawnOf(d);
        p.set("radius", d.fluid.radius * some.larger);
        p.set("standsFor", some.standsFor);
        p.set("spacing", d.fluid.spacing);
        p.set("scale", scale);
        p.texture("sceneDepth", 0, c.texture(d.depth));
        programs.drawParticles(p, d.fluid, some.count);
    });
    for (const ivec2 axis : {ivec2(1, 0), ivec2(0, 1)}) {
        const auto setup = [=](Program& p, const PassContext&) {
            p.set("axis", axis);
            p.set("reach", kThicknessBlur * kThicknessScale / scale);
        };
        thickness = addTiled(graph, "thickness blur", programs, d, programs["blur"], tiles, thickness, size, 0.0F, setup);
        if (ink) depths = addTiled(graph, "ink blur", programs, d, programs["blur"], tiles, depths, inkSize, 0.0F, setup);
    }
    return {.tiles = tiles, .depth = {}, .thickness = thickness, .normals = {}, .fades = depths};
}

TextureHandle addWaterLight(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const mat4& projection) {
    const int side = d.look.fast ? kLightMapFast : kLightMap;
    const TextureDesc raw{.width = side, .height = side, .format = Format::rg16f};
    const TextureDesc map{.width = side, .height = side, .format = Format::rgba16f};
    const TextureHandle drawn = graph.texture("water light, raw", raw);
    const float clipRadius = d.fluid.radius * glm::length(vec3(projection[0][0], projection[1][0], projection[2][0]));
    const Drawn some = drawnOf(d);  // the blur hides the larger radius
    graph.pass("water light", {{d.frame, Usage::uniform}, {d.position, Usage::sampled}}, {drawn}, [=, &programs](PassContext& c) {
        c.drawTo({drawn}).clearColour(vec4(0.0F));
        useFrame(c, d);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        Program& p = programs["light water"];
        p.use();
        p.set("clipRadius", some.larger * clipRadius);
        p.set("radius", some.larger * d.fluid.radius);
        p.set("volumeScale", volumeScale(d.fluid));
        programs.drawParticles(p, d.fluid, some.count);
    });
    // The narrow blur hides single particles: its reach is 1.5 spacings of the drawn particles.
    const float texels = 1.5F * some.larger * d.fluid.spacing / d.fluid.radius * clipRadius * 0.5F * static_cast<float>(side);
    const int reach = std::clamp(static_cast<int>(texels), 2, 6);
    TextureHandle from = drawn;
    for (const bool first : {true, false}) {
        const TextureHandle to = graph.texture("water light", map);
        Program& p = programs[first ? "light water blur, first" : "light water blur, last"];
        graph.pass("water light blur", {from}, {to}, [=, &p](PassContext& c) {
            c.drawTo({to});
            p.use();
            p.texture("source", 0, c.texture(from));
            p.set("axis", first ? ivec2(1, 0) : ivec2(0, 1));
            p.set("reach", reach);
            c.drawFullscreen();
        });
        from = to;
    }
    return from;
}

FluidLayers addShade(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const WaterSurface& water) {
    const bool ink = d.fluid.absorption != 0;
    d.behind(d.colour, water.depth);
    const TextureHandle colour = graph.texture("water colour", graph.desc(d.colour));
    graph.pass("copy scene", {{d.colour, Usage::copy}}, {{colour, Usage::copy}}, [=](PassContext& c) {
        const gpu::Texture &from = c.texture(d.colour), &to = c.texture(colour);
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, 0, 0, 0, to.name(), GL_TEXTURE_2D, 0, 0, 0, 0, from.width(), from.height(), 1);
    });
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, water.tiles,   d.colour,     d.depth,     water.depth,
                                    water.thickness,           d.shadowSharp, d.shadowSoft, d.waterLight};
    if (ink) reads.emplace_back(water.fades);
    if (water.normals) reads.emplace_back(water.normals);
    if (d.look.view != WaterView::water) {
        addView(graph, programs, d, {water.tiles, water.depth, water.thickness, colour});
        return {colour, water.depth};
    }
    graph.pass("shade", reads, {colour}, [=, &programs](PassContext& c) {
        c.drawTo({colour});
        useFrame(c, d);
        Program& p = programs[water.normals ? (ink ? "shade, normals, ink" : "shade, normals") : ink ? "shade, ink" : "shade"];
        p.use();
        p.texture("sceneColour", 0, c.texture(d.colour));
        p.texture("sceneDepth", 1, c.texture(d.depth));
        p.texture("fluidDepth", 2, c.texture(water.depth));
        p.texture("thickness", 3, c.texture(water.thickness));
        if (water.normals) p.texture("normals", 9, c.texture(water.normals));
        if (ink) p.texture("depths", 8, c.texture(water.fades));
        p.texture("shadowSharp", 4, c.texture(d.shadowSharp));
        p.texture("shadowSoft", 5, c.texture(d.shadowSoft));
        p.texture("waterLight", 6, c.texture(d.waterLight));
        p.set("waterAbsorption", d.look.absorption + d.look.scattering);
        p.set("radius", d.fluid.radius);
        if (!ink) p.set("absorption", d.look.absorption);
        if (!ink) p.set("scattering", d.look.scattering);
        p.set("refractiveIndex", d.look.refractiveIndex);
        p.set("mirrorSteps", d.look.fast ? 0 : 10);
        programs.drawTiles(p, c.texture(water.tiles), 7);
    });
    return {colour, water.depth};
}

FluidLayers addScreenSpace(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d) {
    if (d.fluid.count == 0) return {d.colour, {}};
    const FilterRow& filter = d.look.view == WaterView::spheres ? unfiltered()
                              : d.look.filter != nullptr        ? *d.look.filter
                                                                : filters().rows.front();
    // With look.quality fast, the surface is computed at half the resolution and shaded at full resolution.
    const bool half = d.look.fast && static_cast<bool>(d.coarse);
    FluidDraw s = d;
    if (half) {
        s.frame = d.coarse;
        s.view = d.view.half();
    }
    const TextureHandle spheres = addSphereDepth(graph, programs, s, !half);
    const TextureHandle tiles = addTilesOf(graph, programs, d, spheres);
    TextureHandle depth = filter.add(filter, graph, programs, s, tiles, spheres);
    if (half) {
        const TextureDesc size{.width = d.view.width, .height = d.view.height, .format = Format::r32f};
        depth = addTiled(graph, "refine", programs, d, programs["refine"], tiles, depth, size, kNoDepth,
                         [=](Program& p, const PassContext&) { p.set("range", filterReach(d.look, d.fluid.spacing).range); });
    }
    WaterSurface water = addThickness(graph, programs, d, tiles);
    water.depth = depth;
    return addShade(graph, programs, d, water);
}

RendererRow screenSpaceRenderer() {
    return {.name = "screen_space",
            .doc = "a water surface from the particles' smoothed depth: refraction, absorption, reflection",
            .opaque = false,
            .add = addScreenSpace,
            .programs = kScreenSpacePrograms,
            .ellipsoids = true};
}

}  // namespace rivulet
