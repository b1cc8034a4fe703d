// Renderers: the ways to draw a fluid, as passes added to a frame graph after the scene's opaque pass.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "engine/core/table.h"
#include "engine/gpu/frame_graph.h"
#include "engine/render/frame_view.h"
#include "fluid/render/fluid_look.h"
#include "fluid/render/fluid_programs.h"
#include "fluid/render/fluid_view.h"

namespace rivulet {

// The input of a renderer: the frame, the water, and the scene as drawn so far.
struct FluidDraw {
    FrameView view;
    FluidView fluid;
    FluidLook look;
    gpu::BufferHandle frame;   // a FrameParams (shaders/render/frame.h)
    gpu::BufferHandle coarse;  // the same for half the width and height, rounded up; empty: the surface is found at full resolution
    gpu::BufferHandle position, velocity, id, absorption;  // of `fluid`, imported
    std::vector<gpu::BufferHandle> ellipsoids;             // of `fluid`, imported; empty: spheres
    gpu::TextureHandle colour;                             // rgba16f, linear radiance
    gpu::TextureHandle depth;                              // window depth
    gpu::TextureHandle glassDepth;                         // window depth of the nearest clear face; empty: nothing is clear
    gpu::TextureHandle shadowSharp, shadowSoft;            // as engine/render/passes.h's LightMaps
    uint32_t shadowVersion = 0;                            // another number whenever they were drawn anew
    std::array<float, 3> receivers{};                      // what else light meets: 1 for meshes, 1 for a floor; its height, m
    gpu::TextureHandle caustics;                           // addCaustics's; empty: none
    // Draws transparent objects behind the water into `colour`; called before the water is drawn. `fluidDepth`: of FluidLayers.
    std::function<void(gpu::TextureHandle colour, gpu::TextureHandle fluidDepth)> behind = [](gpu::TextureHandle, gpu::TextureHandle) {};
    void* user = nullptr;  // RendererRow::user
    // Called by a slow renderer with the finished share, 0 to 1; false: it may stop.
    std::function<bool(double)> progress = [](double) { return true; };
};

struct FluidLayers {
    gpu::TextureHandle colour;      // the picture with the fluid in it
    gpu::TextureHandle fluidDepth;  // r32f, m, 1e6 where there is none; empty if the renderer is opaque
};

struct RendererRow {
    const char* name;
    const char* doc;
    bool opaque;  // draws into the scene's colour and depth
    FluidLayers (*add)(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);
    std::span<const ProgramRow> programs = {};  // that add() draws with; of the table's rows FluidPrograms::create makes them
    bool ellipsoids = false;                    // reads FluidDraw::ellipsoids, which the world then computes
    void* user = nullptr;                       // of a host's row: anything that its add() needs
};
const Table<RendererRow>& renderers();

// A map of the water along the light: x thickness (m), y thickness times depth (0..1), z thickness with twice the blur;
// with look.caustics all with twice the blur, and z the share that is covered.
// `projection`: world -> the light's clip space, orthographic and of one scale.
gpu::TextureHandle addWaterLight(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const mat4& projection);
// The light that the water of that map refracts onto what it reaches first (meshes in shadowSharp, the floor), as a share of the key light
// for each colour: rgb, in the same projection. FrameParams::shadow.y must be 2 for what is lit by it.
gpu::TextureHandle addCaustics(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, gpu::TextureHandle water,
                               const mat4& projection);

// The particles' buffers, as a pass that draws splats reads them.
std::vector<gpu::Read> splatReads(const FluidDraw& draw);
// Pixels, for particle.glsl; 0: every particle is drawn.
float detailOf(const FluidDraw& draw);
// How large the particles of a draw are in a picture of 1 / `scale` of its resolution; `radius` m.
Splats splatsOf(const FluidDraw& draw, float radius, int scale);

// Copies a texture to one of the same size and format, and then calls `done` where there is one.
void copyTexels(gpu::FrameGraph& graph, const char* name, gpu::TextureHandle from, gpu::TextureHandle to,
                const std::function<void()>& done = {});

// Marks the tiles of the picture that particles touch; later passes run only there.
gpu::TextureDesc tilesOf(const FrameView& view);
gpu::TextureHandle addTiles(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);

// The input of the shade pass.
struct WaterSurface {
    gpu::TextureHandle tiles;      // of addTiles
    gpu::TextureHandle depth;      // r32f, m, 1e6 where there is none
    gpu::TextureHandle thickness;  // m
    gpu::TextureHandle sharp;      // m, the same before its blur; not read if there are normals
    gpu::TextureHandle normals;    // xyz view space, w m of water instead of thickness.x; empty: they come from the depth
    gpu::TextureHandle fades;      // absorption of red, green and blue; empty: particles are alike
};
// `depth` without the surface inside FluidView::dry; `tiles` as of addTiles.
gpu::TextureHandle addDryCut(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, gpu::TextureHandle tiles,
                             gpu::TextureHandle depth);
// Sets tiles, thickness and fades: of the spheres, blurred. `kept`: of this view, or null.
WaterSurface addThickness(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, gpu::TextureHandle tiles,
                          const std::shared_ptr<KeptPicture>& kept = {});
FluidLayers addShade(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const WaterSurface& water);

FluidLayers addScreenSpace(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);
// Reads the particles back, ray-marches their iso-surface on the CPU, and shades it. Takes seconds when the input has changed.
FluidLayers addReference(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);

// Draws spray, foam and bubbles into layers.colour. `side`: `glazed` are those behind a transparent object outside the water, to be drawn
// before that object; `rest` are the others, to be drawn after the water. `all` where layers.fluidDepth is empty.
enum class FoamSide { all, glazed, rest };
void addFoam(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers, FoamSide side);

// Draws particles that have left the body of the water into layers.colour, as droplets.
void addSpray(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers);

// Draws the drops in the air, and those that hang, into layers.colour. The result is the scene's depth with theirs in it.
gpu::TextureHandle addDrops(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers);

// The depth of the scene with the water's surface in it, to test against: window depth.
gpu::TextureHandle addSceneAndWaterDepth(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers);

// The volume of a particle divided by that of its drawn sphere: turns lengths within spheres into lengths within water.
float volumeScale(const FluidView& fluid);

}  // namespace rivulet
