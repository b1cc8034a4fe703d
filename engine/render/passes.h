// The passes that draw a scene without water: functions that add a pass to a frame graph and return handles of its results.
// Their order: shadow, depth, occlusion, opaque, (passes of the fluid), box edges, tonemap.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/kernel_source.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "engine/material/wetness.h"
#include "engine/render/frame_params.h"
#include "engine/render/gpu_images.h"
#include "engine/render/gpu_mesh.h"

namespace rivulet {

struct DrawnMesh;

// The shader programs of all passes.
struct RenderPrograms {
    // Of meshes with a plain material (see isPart).
    struct Plain {
        gpu::Program shadow, depth, mesh, meshWet;
    };
    Plain plain;
    std::optional<Plain> posed;  // of those that move with a body on the device; empty until preparePosed()
    gpu::Program shadowHoles, shadowFirst, shadowHalve, shadowBlur, floorDepth, occlusion, occlusionBlur, sky, floor, glass, box,
        boxOverWater, tonemap, antialias;
    static Result<RenderPrograms> create(const ShaderFiles& files);
    Status preparePosed();             // Error: as create
    std::vector<gpu::Program*> all();  // also those of part() and preparePosed() created so far
    Plain& of(const DrawnMesh& mesh);

    // The program for meshes of this material, with or without a layer, with or without water between it and the light, and dry or wet
    // (see canBeWet). It is created on first use. Error: as create.
    Result<gpu::Program*> part(const Material& material, bool layered, bool water, bool wet = false);

  private:
    static Result<Plain> makePlain(const ShaderFiles& files, std::vector<Define> defines);
    ShaderFiles files_;
    std::map<unsigned, gpu::Program> parts_;
};

// The pose of a body, where a kernel has written it: see shaders/material/posed.glsl.
struct DevicePose {
    unsigned rows = 0;  // GL name of a buffer texture
    int texel = 0;      // the first of the body's row
    mat4 toBody{1.0F};  // the mesh -> the body's frame
};

struct DrawnMesh {
    const GpuMesh* mesh = nullptr;   // must exist until the graph has executed
    mat4 toWorld{1.0F};              // with `pose`: about
    std::optional<DevicePose> pose;  // only with a plain material, after preparePosed(); `wet` is then of the body's frame
    Material material;
    gpu::Program* part = nullptr;  // RenderPrograms::part(), which also needs `textures`; null: the simple program (see isPart)
    MaterialTextures textures;
    gpu::Program* wetPart = nullptr;  // part() with a layer; then `layer` is set and has texels
    const Layer* layer = nullptr;
    std::optional<WetGrid> wet;  // where it is wet, if addOpaque gets WetBuffers; `part` is then wet
};

// Whether a material needs the full program (textures, skin, eye, ...) instead of colour, roughness and metallic alone. Else it is plain,
// unless it is clear.
bool isPart(const Material& material);

// Whether wetness changes the look of a material: not that of skin and eyes, which have layers, nor of what is seen through.
bool canBeWet(const Material& material);

// The wetness of all meshes: buffers as shaders/material/wet.glsl declares them; empty: all is dry.
struct WetBuffers {
    gpu::BufferHandle cells, values;
};

// The maps of the light's visibility. Without meshes or water the handles may be any texture; FrameParams::shadow marks them as unused.
struct LightMaps {
    gpu::TextureHandle sharp, soft, water;
    vec3 absorption{0.0F};  // 1/m, of the water
};

// Exponential variance shadow maps (Lauritzen and McCool 2008): moments of the depth from the light, with a small blur in `sharp` and a
// wide one in `soft`, both of shadowMapDesc(). They depend on meshes and light only, so a caller may keep them and skip the pass. `quick`:
// half the width, for meshes that deform in every frame.
gpu::TextureDesc shadowMapDesc(bool soft, bool quick);
void addShadow(gpu::FrameGraph& graph, RenderPrograms& programs, std::vector<DrawnMesh> meshes, const mat4& projection,
               gpu::TextureHandle sharp, gpu::TextureHandle soft, bool quick);
// Window depth of meshes and floor, without blended and cut-out meshes. `frame`: the buffer of a FrameParams.
gpu::TextureHandle addDepth(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                            std::vector<DrawnMesh> meshes);
// Ambient occlusion at half resolution; `reach`: radius, m.
gpu::TextureHandle addOcclusion(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                                gpu::TextureHandle depth, float reach);
// Linear radiance (rgba16f) of background, floor and meshes; blended meshes come last, the farthest first.
gpu::TextureHandle addOpaque(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                             std::vector<DrawnMesh> meshes, gpu::TextureHandle depth, gpu::TextureHandle occlusion, const LightMaps& light,
                             bool floor = true, const WetBuffers& wet = {});
// Draws meshes of clear materials into `colour`: each face reflects, and attenuates what is behind it. `side`: behind or in front of the
// water, whose depth is `fluidDepth` (m, r32f; 1e6 where there is no water, which counts as behind); all: no water, fluidDepth may be
// empty.
enum class GlassSide { all, behind, before };
void addGlass(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, std::vector<DrawnMesh> meshes,
              gpu::TextureHandle colour, gpu::TextureHandle depth, const LightMaps& light, GlassSide side,
              gpu::TextureHandle fluidDepth = {});
// Window depth of the nearest clear face, 1 where there is none; an empty handle: no mesh is clear.
gpu::TextureHandle addGlassDepth(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                                 std::vector<DrawnMesh> meshes);
// Draws the edges of a box into `colour`; with `fluidDepth` (m, r32f) only those in front of the water.
void addBox(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const Bounds& box, gpu::TextureHandle colour,
            gpu::TextureHandle depth, gpu::TextureHandle fluidDepth = {});
// Converts linear radiance to sRGB with antialiasing and dithering, into `picture` (rgba8, the view's size). `exposure`: stops more light.
void addTonemap(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view, gpu::TextureHandle colour,
                gpu::TextureHandle picture, float exposure = 0.0F);

}  // namespace rivulet
