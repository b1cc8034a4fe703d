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

// What a renderer works with: the frame, the water, and the scene as drawn so far.
struct FluidDraw {
    FrameView view;
    FluidView fluid;
    FluidLook look;
    gpu::BufferHandle frame;                                 // a FrameParams (shaders/render/frame.h)
    gpu::BufferHandle coarse;                                // of a picture half as large each way, rounded up; empty: look.fast is finer
    gpu::BufferHandle position, velocity, id, absorption;    // fluid's, imported
    std::vector<gpu::BufferHandle> ellipsoids;               // likewise; empty: spheres
    gpu::TextureHandle colour;                               // rgba16f, linear radiance
    gpu::TextureHandle depth;                                // window depth
    gpu::TextureHandle glassDepth;                           // window depth of the nearest clear face; empty: nothing is clear
    gpu::TextureHandle shadowSharp, shadowSoft, waterLight;  // as engine/render/passes.h's LightMaps
    // Draws what is clear and lies behind the water into `colour`, before the water is; `fluidDepth` as FluidLayers has it.
    std::function<void(gpu::TextureHandle colour, gpu::TextureHandle fluidDepth)> behind = [](gpu::TextureHandle, gpu::TextureHandle) {};
    // Of a renderer that takes its time: the share that is done; false: it need not go on.
    std::function<bool(double)> progress = [](double) { return true; };
};

struct FluidLayers {
    gpu::TextureHandle colour;      // the picture with the fluid in it
    gpu::TextureHandle fluidDepth;  // r32f, m, 1e6 where there is none; empty if the fluid went into the scene's depth instead
};

struct RendererRow {
    const char* name;
    const char* doc;
    bool opaque;  // draws into the scene's colour and depth
    FluidLayers (*add)(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);
    std::span<const ProgramRow> programs = {};  // that add() draws with; of the table's rows FluidPrograms::create makes them
    bool ellipsoids = false;                    // reads FluidDraw::ellipsoids, which the world then computes
};
const Table<RendererRow>& renderers();

// What the light passes through on its way: x thickness (m), y that times its depth (0..1), z thickness relative to the surroundings (m).
// `projection`: world -> the light's clip space, orthographic and of one scale.
gpu::TextureHandle addWaterLight(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const mat4& projection);

// The particles' buffers, as a pass that draws splats reads them.
std::vector<gpu::Read> splatReads(const FluidDraw& draw);

// Marks the tiles of the picture that particles touch: what comes after runs only there.
gpu::TextureDesc tilesOf(const FrameView& view);
gpu::TextureHandle addTiles(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);

// A water surface as the shade pass takes it.
struct WaterSurface {
    gpu::TextureHandle tiles;      // as addTiles
    gpu::TextureHandle depth;      // r32f, m, 1e6 where there is none
    gpu::TextureHandle thickness;  // m: x of water, y of that as spray
    gpu::TextureHandle normals;    // xyz view space, w m of water instead of thickness.x; empty: they come from the depth
    gpu::TextureHandle fades;      // what red, green and blue fade by; empty: particles are alike
};
// Thickness and fades of the spheres, blurred: the rest of a surface is empty.
WaterSurface addThickness(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, gpu::TextureHandle tiles);
FluidLayers addShade(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const WaterSurface& water);

FluidLayers addScreenSpace(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);
// Reads the particles back, ray-marches their iso-surface on the host, and shades it. Takes seconds, where anything has changed.
FluidLayers addReference(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);

// Spray, foam and bubbles, into layers.colour. `side`: glazed is what something clear stands before where there is no water; it is to be
// drawn before the glass, and the rest after the water. All, where layers.fluidDepth is empty.
enum class FoamSide { all, glazed, rest };
void addFoam(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers, FoamSide side);

// The drops in the air, into layers.colour.
void addDrops(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw, const FluidLayers& layers);

// A particle's volume over its drawn sphere's: what turns lengths within spheres into lengths within water.
float volumeScale(const FluidView& fluid);

}  // namespace rivulet
