// A water surface in screen space: sphere depths (van der Laan et al. 2009), smoothed by a row of filters().
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>

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
constexpr float kThicknessBlur = 1.1F;                       // spacings either side: hides single particles
constexpr int kMostThicknessBlur = 8;                        // texels
constexpr int kLightMap = 256;                               // texels
constexpr int kLightMapFast = 128;
constexpr int kShaftSteps = 24, kShaftStepsFast = 8;
constexpr float kLeastDisc = 1.75F;  // texels, radius
constexpr float kManyShare = 2.5F;   // times that larger than a particle's, discs are so many that each second one will do

constexpr ProgramRow kScreenSpacePrograms[] = {
    {"occluder", "screen_space/occluder.vert", "render/depth.frag"},
    {"occluder, ellipsoids", "screen_space/occluder.vert", "render/depth.frag", {"ELLIPSOIDS"}},
    {"depth", "screen_space/sphere.vert", "screen_space/depth.frag"},
    {"depth, ellipsoids", "screen_space/sphere.vert", "screen_space/depth.frag", {"ELLIPSOIDS"}},
    {"thickness", "screen_space/sphere.vert", "screen_space/thickness.frag"},
    {"thickness, ellipsoids", "screen_space/sphere.vert", "screen_space/thickness.frag", {"ELLIPSOIDS"}},
    {"thickness, ink", "screen_space/sphere.vert", "screen_space/thickness.frag", {"INK"}},
    {"thickness, ink, ellipsoids", "screen_space/sphere.vert", "screen_space/thickness.frag", {"INK", "ELLIPSOIDS"}},
    {"scene at", "render/fullscreen.vert", "screen_space/scene_at.frag"},
    {"scene at, changed", "screen_space/tile.vert", "screen_space/scene_at.frag", {"CHANGED"}},
    {"water blocks", "render/fullscreen.vert", "screen_space/water_blocks.frag"},
    {"water tiles", "render/fullscreen.vert", "screen_space/water_tiles.frag"},
    {"refine", "screen_space/tile.vert", "screen_space/refine.frag"},
    {"dry cut", "screen_space/tile.vert", "screen_space/dry_cut.frag"},
    {"show view", "screen_space/tile.vert", "screen_space/show_view.frag"},
    {"blur", "screen_space/tile.vert", "screen_space/blur.frag"},
    {"light water", "screen_space/light_water.vert", "screen_space/light_water.frag"},
    {"light water blur, first", "render/fullscreen.vert", "screen_space/light_water_blur.frag", {"FIRST"}},
    {"light water blur, last", "render/fullscreen.vert", "screen_space/light_water_blur.frag"},
    {"light water blur, wide, first", "render/fullscreen.vert", "screen_space/light_water_blur.frag", {"FIRST", "WIDE"}},
    {"light water blur, wide, last", "render/fullscreen.vert", "screen_space/light_water_blur.frag", {"WIDE"}},
    {"shade", "screen_space/tile.vert", "screen_space/shade.frag"},
    {"shade, ink", "screen_space/tile.vert", "screen_space/shade.frag", {"INK"}},
    {"shade, normals", "screen_space/tile.vert", "screen_space/shade.frag", {"NORMALS"}},
    {"shade, normals, ink", "screen_space/tile.vert", "screen_space/shade.frag", {"NORMALS", "INK"}},
};

// The rows of particles that are drawn. With look.quality fast, half of them represent all, with twice the volume.
struct Drawn {
    RowRange awake, asleep;
    float standsFor = 1, larger = 1;
};
Drawn allOf(const FluidView& f) {
    if (f.asleep == 0) return {.awake = {0, f.count}, .asleep = {}};
    return {.awake = {0, f.awake}, .asleep = {f.count - f.asleep, f.asleep}};
}
// Texels of 1 / `scale` of the resolution that the blur of thickness reaches, where the middle of the water is.
int thicknessReach(const FluidDraw& d, int scale) {
    const vec3 middle = d.fluid.bounds.empty() ? vec3(0.0F) : d.fluid.bounds.centre();
    const float depth = std::max(-(d.view.view * vec4(middle, 1.0F)).z, d.view.nearPlane);
    const float texel =
        2.0F * static_cast<float>(scale) * d.view.spreadAt(depth) / (d.view.projection[1][1] * static_cast<float>(d.view.height));
    // At least four pixels, or from afar texels of one size and of another would show.
    return std::clamp(static_cast<int>(std::lround(kThicknessBlur * d.fluid.spacing / texel)), std::max(4 / scale, 1), kMostThicknessBlur);
}
Drawn drawnOf(const FluidDraw& d) {
    Drawn drawn = allOf(d.fluid);
    if (!d.look.fast || d.fluid.half + d.fluid.asleepHalf == 0) return drawn;
    drawn.awake.count = std::min(drawn.awake.count, d.fluid.half);
    drawn.asleep.count = d.fluid.asleepHalf;
    drawn.standsFor = 2.0F;
    drawn.larger = std::cbrt(2.0F);
    return drawn;
}

void useFrame(const PassContext& c, const FluidDraw& d) { glBindBufferBase(GL_UNIFORM_BUFFER, 0, c.buffer(d.frame)); }

using Kept = std::shared_ptr<KeptPicture>;
TextureHandle importKept(FrameGraph& graph, const Kept& kept, KeptPicture::Part part) {
    return graph.importTexture("kept", kept->textures[part]);
}

// A texture of the particles in `rows`, those that sleep first in any case, so that sums are rounded alike, drawn by `draw(into, rows,
// clears, done)`: those that sleep once, into what is kept, and those that are awake over a copy of it.
template <class Draw>
TextureHandle addKept(FrameGraph& graph, const char* name, const TextureDesc& desc, const Drawn& rows, const Kept& kept,
                      KeptPicture::Part part, const Draw& draw) {
    if (!kept) {
        const TextureHandle all = graph.texture(name, desc);
        draw(all, std::array{rows.asleep, rows.awake}, true, std::function<void()>());
        return all;
    }
    const TextureHandle asleep = importKept(graph, kept, part);
    if (!kept->drawn[part]) draw(asleep, std::array{rows.asleep, RowRange()}, true, [=] { kept->drawn[part] = true; });
    if (rows.awake.count == 0) return asleep;
    const TextureHandle all = graph.texture(name, desc);
    copyTexels(graph, name, asleep, all);
    draw(all, std::array{rows.awake, RowRange()}, false, std::function<void()>());
    return all;
}

TextureDesc sphereDepthDesc(const FluidDraw& d) { return {.width = d.view.width, .height = d.view.height, .format = Format::r32f}; }

// Depth of the spheres, m. `prepare`: first draws occluders for spheres deep in the water; this pays off if spheres cover
// many pixels.
TextureHandle addSphereDepth(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, bool prepare, const Kept& kept) {
    TextureDesc size = sphereDepthDesc(d);
    size.format = Format::depth32f;
    const auto draw = [&](TextureHandle depth, const std::array<RowRange, 2>& rows, bool clears, const std::function<void()>& done) {
        const TextureHandle hidden = graph.texture("fluid occluders", size);
        graph.pass("fluid depth", splatReads(d), {depth, hidden}, [=, &programs](PassContext& c) {
            const gpu::Framebuffer& target = c.drawTo({depth}, hidden);
            useFrame(c, d);
            if (clears) target.clearColour(vec4(kNoDepth));
            target.clearDepth();
            const Splats splats = splatsOf(d, d.fluid.radius, 1);
            gpu::PassState state;
            if (prepare) {
                state = {.depthTest = true, .colourWrites = false};
                c.state(state);
                Program& occluder = programs.splat("occluder", d.fluid);
                occluder.use();
                occluder.set("radius", d.fluid.radius);
                occluder.set("detail", detailOf(d));
                for (const RowRange& range : rows) programs.drawSplats(occluder, d.fluid, splats, range);
                state.depthWrites = false;
                state.colourWrites = true;
            }
            state.blendEquation = GL_MIN;
            c.state(state);
            Program& p = programs.splat("depth", d.fluid);
            p.use();
            p.set("radius", d.fluid.radius);
            p.set("detail", detailOf(d));
            for (const RowRange& range : rows) programs.drawSplats(p, d.fluid, splats, range);
            if (done) done();
        });
    };
    return addKept(graph, "sphere depth", sphereDepthDesc(d), allOf(d.fluid), kept, KeptPicture::spheres, draw);
}

// Finds the tiles that contain water from the spheres' depth, which costs less than drawing all particles again.
TextureHandle addTilesOf(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle spheres) {
    const TextureDesc from = graph.desc(spheres), size = tilesOf(d.view);
    const TextureHandle blocks =
        graph.texture("water blocks", {.width = (from.width + 7) / 8, .height = (from.height + 7) / 8, .format = Format::r8});
    const TextureHandle tiles = graph.texture("water tiles", size);
    graph.pass("tiles", {spheres}, {blocks}, [=, &programs](PassContext& c) {
        c.state({});
        c.drawTo({blocks});
        Program& p = programs["water blocks"];
        p.use();
        p.texture("depths", 0, c.texture(spheres));
        c.drawFullscreen();
    });
    graph.pass("tiles", {blocks}, {tiles}, [=, &programs](PassContext& c) {
        c.state({});
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
                   c.state({});
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

namespace {

struct ThicknessSize {
    int scale;
    TextureDesc thickness, ink;
};
ThicknessSize thicknessSize(const FluidDraw& d) {
    const int scale = d.look.fast ? kThicknessScaleFast : kThicknessScale;
    TextureDesc size{.width = (d.view.width + scale - 1) / scale, .height = (d.view.height + scale - 1) / scale, .format = Format::r16f};
    TextureDesc ink = size;
    ink.format = Format::rgba16f;
    if (d.fluid.absorption != 0) size.format = Format::rg16f;
    return {scale, size, ink};
}

using Condition = std::shared_ptr<gpu::QueryName>;

// Whether the scene has moved, within the tiles of the water, since the thickness that is kept was cut at it; the GPU alone finds out.
Condition addSceneChanged(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles, const Kept& kept,
                          TextureHandle scene, TextureHandle changed) {
    if (!kept->changed) {
        GLuint name = 0;
        glGenQueries(1, &name);
        kept->changed = gpu::QueryName(name);
    }
    const Condition query(kept, &kept->changed);
    graph.pass("thickness", {{d.frame, Usage::uniform}, d.depth, scene, tiles}, {changed}, [=, &programs](PassContext& c) {
        c.state({});
        c.drawTo({changed});
        useFrame(c, d);
        Program& p = programs["scene at, changed"];
        p.use();
        p.texture("sceneDepth", 0, c.texture(d.depth));
        p.texture("kept", 1, c.texture(scene));
        p.set("scale", thicknessSize(d).scale);
        glBeginQuery(GL_ANY_SAMPLES_PASSED, query->name());
        programs.drawTiles(p, c.texture(tiles), 2);
        glEndQuery(GL_ANY_SAMPLES_PASSED);
    });
    return query;
}

// Draws `rows` into `thickness` and, with ink, `depths`. `condition`: only if it holds; the GPU reads `changed` first.
struct ThicknessInto {
    TextureHandle thickness, depths;
    std::array<RowRange, 2> rows;
    bool clears = true;
    TextureHandle changed = {};
    Condition condition = {};
};
void addThicknessOf(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const ThicknessInto& to) {
    const bool ink = d.fluid.absorption != 0;
    std::vector<gpu::Read> reads = splatReads(d);
    reads.emplace_back(d.depth);
    std::vector<gpu::Write> writes = {to.thickness};
    if (ink) {
        reads.emplace_back(d.absorption, Usage::sampled);
        writes.emplace_back(to.depths);
    }
    if (to.changed) reads.emplace_back(to.changed);
    graph.pass("thickness", reads, writes, [=, &programs](PassContext& c) {
        const gpu::Framebuffer& target = ink ? c.drawTo({to.thickness, to.depths}) : c.drawTo({to.thickness});
        if (to.condition) glBeginConditionalRender(to.condition->name(), GL_QUERY_WAIT);
        if (to.clears) target.clearColour(vec4(0.0F), 0);
        if (to.clears && ink) target.clearColour(vec4(0.0F), 1);
        useFrame(c, d);
        c.state({.blendTarget = GL_ONE});
        Program& p = programs.splat(ink ? "thickness, ink" : "thickness", d.fluid);
        p.use();
        if (ink) p.set("ownAbsorption", vec4(d.look.absorption, d.look.scattering.y));
        const Drawn some = drawnOf(d);
        p.set("radius", d.fluid.radius * some.larger);
        p.set("detail", detailOf(d) * static_cast<float>(thicknessSize(d).scale));  // of its own pixels
        p.set("standsFor", some.standsFor);
        p.set("spacing", d.fluid.spacing);
        p.set("scale", thicknessSize(d).scale);
        p.texture("sceneDepth", 0, c.texture(d.depth));
        const Splats splats = splatsOf(d, d.fluid.radius * some.larger, thicknessSize(d).scale);
        for (const RowRange& range : to.rows) programs.drawSplats(p, d.fluid, splats, range);
        if (to.condition) glEndConditionalRender();
    });
}

// The same of particles that sleep, into what is kept, and the scene that cuts it.
ThicknessInto addKeptThickness(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles, const Kept& kept) {
    const ThicknessSize size = thicknessSize(d);
    ThicknessInto to{.thickness = importKept(graph, kept, KeptPicture::thickness), .depths = {}, .rows = {drawnOf(d).asleep, RowRange()}};
    if (d.fluid.absorption != 0) to.depths = importKept(graph, kept, KeptPicture::ink);
    const TextureHandle scene = importKept(graph, kept, KeptPicture::scene);
    if (kept->drawn[KeptPicture::thickness]) {
        TextureDesc flags = size.thickness;
        flags.format = Format::r8;
        to.changed = graph.texture("scene changed", flags);
        to.condition = addSceneChanged(graph, programs, d, tiles, kept, scene, to.changed);
    }
    addThicknessOf(graph, programs, d, to);
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, d.depth};
    if (to.changed) reads.emplace_back(to.changed);
    graph.pass("thickness", reads, {scene}, [=, &programs, condition = to.condition](PassContext& c) {
        c.state({});
        c.drawTo({scene});
        useFrame(c, d);
        if (condition) glBeginConditionalRender(condition->name(), GL_QUERY_WAIT);
        Program& p = programs["scene at"];
        p.use();
        p.texture("sceneDepth", 0, c.texture(d.depth));
        p.set("scale", size.scale);
        c.drawFullscreen();
        if (condition) glEndConditionalRender();
        kept->drawn[KeptPicture::thickness] = true;
    });
    graph.output(scene);
    return to;
}

// What is kept of particles that sleep, for this view; null: nothing.
Kept keptOf(FluidPrograms& programs, const FluidDraw& d) {
    programs.kept.next();
    const FluidView& f = d.fluid;
    if (!f.sleepers || f.asleep == 0) return nullptr;
    KeptPictures::Key key{f.sleepers, d.look.filter, {}};
    for (const mat4& m : {d.view.view, d.view.projection})
        for (int k = 0; k < 16; ++k) key.values.push_back(m[k / 4][k % 4]);
    const FluidLook& look = d.look;
    key.values.insert(key.values.end(), {static_cast<float>(d.view.width),
                                         static_cast<float>(d.view.height),
                                         d.view.nearPlane,
                                         d.view.farPlane,
                                         f.radius,
                                         f.spacing,
                                         f.viscosity,
                                         f.bounds.min.x,
                                         f.bounds.min.y,
                                         f.bounds.min.z,
                                         f.bounds.max.x,
                                         f.bounds.max.y,
                                         f.bounds.max.z,
                                         look.smoothing,
                                         look.smoothingRange,
                                         look.absorption.x,
                                         look.absorption.y,
                                         look.absorption.z,
                                         look.scattering.y,
                                         look.detail,
                                         static_cast<float>(look.view)});
    for (const bool is : {look.fast, static_cast<bool>(d.coarse), f.half + f.asleepHalf > 0, f.ellipsoids[0] != 0, f.absorption != 0})
        key.values.push_back(is ? 1.0F : 0.0F);
    TextureDesc spheres = sphereDepthDesc(d), surface = spheres;
    if (look.fast && d.coarse) {
        spheres.width = d.view.half().width;
        spheres.height = d.view.half().height;
    }
    surface.format = Format::r32f;
    const ThicknessSize size = thicknessSize(d);
    TextureDesc scene = size.thickness;
    scene.format = Format::r32f;
    std::vector<KeptPictures::Wanted> wanted = {
        {KeptPicture::spheres, spheres}, {KeptPicture::thickness, size.thickness}, {KeptPicture::scene, scene}};
    if (f.absorption != 0) wanted.emplace_back(KeptPicture::ink, size.ink);
    if (f.awake == 0) {
        wanted.emplace_back(KeptPicture::surface, surface);
        wanted.emplace_back(KeptPicture::tiles, tilesOf(d.view));
    }
    return programs.kept.find(key, wanted);
}

}  // namespace

WaterSurface addThickness(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, TextureHandle tiles,
                          const std::shared_ptr<KeptPicture>& kept) {
    const auto [scale, size, inkSize] = thicknessSize(d);
    const bool ink = d.fluid.absorption != 0;
    const Drawn some = drawnOf(d);
    TextureHandle thickness, depths;
    if (kept) {
        const ThicknessInto asleep = addKeptThickness(graph, programs, d, tiles, kept);
        thickness = asleep.thickness;
        depths = asleep.depths;
    }
    if (!kept || some.awake.count > 0) {
        const ThicknessInto to{.thickness = graph.texture("thickness", size),
                               .depths = ink ? graph.texture("ink depths", inkSize) : TextureHandle(),
                               .rows = {kept ? RowRange() : some.asleep, some.awake},
                               .clears = !kept};
        if (kept) copyTexels(graph, "thickness", thickness, to.thickness);
        if (kept && ink) copyTexels(graph, "thickness", depths, to.depths);
        addThicknessOf(graph, programs, d, to);
        thickness = to.thickness;
        depths = to.depths;
    }
    const TextureHandle sharp = thickness;
    const int reach = thicknessReach(d, scale);
    for (const ivec2 axis : {ivec2(1, 0), ivec2(0, 1)}) {
        const auto setup = [=](Program& p, const PassContext&) {
            p.set("axis", axis);
            p.set("reach", reach);
        };
        thickness = addTiled(graph, "thickness blur", programs, d, programs["blur"], tiles, thickness, size, 0.0F, setup);
        if (ink) depths = addTiled(graph, "ink blur", programs, d, programs["blur"], tiles, depths, inkSize, 0.0F, setup);
    }
    return {.tiles = tiles, .depth = {}, .thickness = thickness, .sharp = sharp, .normals = {}, .fades = depths};
}

TextureHandle addWaterLight(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const mat4& projection) {
    const int side = d.look.fast ? kLightMapFast : kLightMap;
    const TextureDesc raw{.width = side, .height = side, .format = Format::rg32f};  // for slopes of depths
    const TextureDesc map{.width = side, .height = side, .format = Format::rgba32f};
    const float clipRadius = d.fluid.radius * glm::length(vec3(projection[0][0], projection[1][0], projection[2][0]));
    // The blur hides the larger radius of half the particles, but refraction would show that their number varies from place to place,
    // unless each texel is covered by several for each layer of them.
    const float texelRadius = clipRadius * 0.5F * static_cast<float>(side);
    const Drawn some = d.look.caustics && texelRadius * kManyShare > kLeastDisc ? allOf(d.fluid) : drawnOf(d);
    Kept kept;
    if (d.fluid.sleepers && d.fluid.asleep > 0) {
        KeptPictures::Key key{d.fluid.sleepers, nullptr, {static_cast<float>(side), d.fluid.radius, d.fluid.spacing, some.standsFor}};
        for (int k = 0; k < 16; ++k) key.values.push_back(projection[k / 4][k % 4]);
        kept = programs.kept.find(key, std::array{KeptPictures::Wanted(KeptPicture::light, raw)});
    }
    // Of a disc of less texels, their centres would see too much or too little, depending on where it lies. The volume stays.
    const float wider = std::max(kLeastDisc / (some.larger * texelRadius), 1.0F);
    const auto draw = [&](TextureHandle into, const std::array<RowRange, 2>& rows, bool clears, const std::function<void()>& done) {
        graph.pass("water light", {{d.frame, Usage::uniform}, {d.position, Usage::sampled}}, {into}, [=, &programs](PassContext& c) {
            const gpu::Framebuffer& target = c.drawTo({into});
            if (clears) target.clearColour(vec4(0.0F));
            useFrame(c, d);
            c.state({.blendTarget = GL_ONE});
            Program& p = programs["light water"];
            p.use();
            const float radius = wider * some.larger * clipRadius;
            p.set("clipRadius", radius);
            p.set("radius", some.larger * d.fluid.radius / (wider * wider));
            p.set("volumeScale", volumeScale(d.fluid));
            const Splats splats{.target = vec2(side, side), .largest = radius * static_cast<float>(side)};
            for (const RowRange& range : rows) programs.drawSplats(p, d.fluid, splats, range);
            if (done) done();
        });
    };
    const TextureHandle drawn = addKept(graph, "water light, raw", raw, some, kept, KeptPicture::light, draw);
    // The narrow blur hides single particles: its reach is 1.5 spacings of the drawn particles.
    const float texels = 1.5F * some.larger * d.fluid.spacing / d.fluid.radius * clipRadius * 0.5F * static_cast<float>(side);
    const int reach = std::clamp(static_cast<int>(texels), 2, 6);
    TextureHandle from = drawn;
    for (const bool first : {true, false}) {
        const TextureHandle to = graph.texture("water light", map);
        Program& p = programs[fmt::format("light water blur{}, {}", d.look.caustics ? ", wide" : "", first ? "first" : "last")];
        graph.pass("water light blur", {from}, {to}, [=, &p](PassContext& c) {
            c.state({});
            c.drawTo({to});
            p.use();
            p.texture("source", 0, c.texture(from));
            p.set("axis", first ? ivec2(1, 0) : ivec2(0, 1));
            p.set("reach", reach);
            p.set("least", 0.5F * d.fluid.spacing);
            c.drawFullscreen();
        });
        from = to;
    }
    return from;
}

FluidLayers addShade(FrameGraph& graph, FluidPrograms& programs, const FluidDraw& d, const WaterSurface& whole) {
    WaterSurface water = whole;
    if (!d.fluid.dry.empty()) water.depth = addDryCut(graph, programs, d, water.tiles, water.depth);
    const bool ink = d.fluid.absorption != 0;
    d.behind(d.colour, water.depth);
    const TextureHandle colour = graph.texture("water colour", graph.desc(d.colour));
    copyTexels(graph, "copy scene", d.colour, colour);
    std::vector<gpu::Read> reads = {{d.frame, Usage::uniform}, water.tiles,   d.colour,    d.depth, water.depth,
                                    water.thickness,           d.shadowSharp, d.shadowSoft};
    if (ink) reads.emplace_back(water.fades);
    if (d.caustics) reads.emplace_back(d.caustics);
    reads.emplace_back(water.normals ? water.normals : water.sharp);
    if (d.look.view != WaterView::water) {
        addView(graph, programs, d, {water.tiles, water.depth, water.thickness, colour});
        return {colour, water.depth};
    }
    graph.pass("shade", reads, {colour}, [=, &programs](PassContext& c) {
        c.state({});
        c.drawTo({colour});
        useFrame(c, d);
        Program& p = programs[water.normals ? (ink ? "shade, normals, ink" : "shade, normals") : ink ? "shade, ink" : "shade"];
        p.use();
        p.texture("sceneColour", 0, c.texture(d.colour));
        p.texture("sceneDepth", 1, c.texture(d.depth));
        p.texture("fluidDepth", 2, c.texture(water.depth));
        p.texture("thickness", 3, c.texture(water.thickness));
        if (water.normals)
            p.texture("normals", 9, c.texture(water.normals));
        else
            p.texture("sharp", 9, c.texture(water.sharp));
        if (ink) p.texture("depths", 8, c.texture(water.fades));
        p.texture("shadowSharp", 4, c.texture(d.shadowSharp));
        p.texture("shadowSoft", 5, c.texture(d.shadowSoft));
        p.set("radius", d.fluid.radius);
        if (!water.normals) p.set("spacing", d.fluid.spacing);
        if (!ink) p.set("absorption", d.look.absorption);
        if (!ink) p.set("scattering", d.look.scattering);
        p.set("refractiveIndex", d.look.refractiveIndex);
        p.set("shaftSteps", d.caustics ? (d.look.fast ? kShaftStepsFast : kShaftSteps) : 0);
        if (d.caustics) p.texture("caustics", 10, c.texture(d.caustics));
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
    const Kept kept = keptOf(programs, d);
    const bool still = kept && d.fluid.awake == 0;
    TextureHandle depth, tiles;
    if (still && kept->drawn[KeptPicture::surface]) {
        depth = importKept(graph, kept, KeptPicture::surface);
        tiles = importKept(graph, kept, KeptPicture::tiles);
    } else {
        const TextureHandle spheres = addSphereDepth(graph, programs, s, !half, kept);
        tiles = addTilesOf(graph, programs, d, spheres);
        depth = filter.add(filter, graph, programs, s, tiles, spheres);
        if (half) {
            const TextureDesc size{.width = d.view.width, .height = d.view.height, .format = Format::r32f};
            depth = addTiled(graph, "refine", programs, d, programs["refine"], tiles, depth, size, kNoDepth,
                             [=](Program& p, const PassContext&) { p.set("range", filterReach(d.look, d.fluid.spacing).range); });
        }
    }
    if (still && !kept->drawn[KeptPicture::surface]) {
        const TextureHandle surface = importKept(graph, kept, KeptPicture::surface), marked = importKept(graph, kept, KeptPicture::tiles);
        copyTexels(graph, "keep surface", tiles, marked);
        copyTexels(graph, "keep surface", depth, surface, [=] { kept->drawn[KeptPicture::surface] = true; });
        graph.output(marked);
        graph.output(surface);
    }
    WaterSurface water = addThickness(graph, programs, d, tiles, kept);
    water.depth = depth;
    const FluidLayers layers = addShade(graph, programs, d, water);
    if (d.look.view == WaterView::water) addSpray(graph, programs, d, layers);
    return layers;
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
