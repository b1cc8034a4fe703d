// The passes that draw a scene without water: free functions that add to a frame graph, handles in, handles out.
// In their order: shadow, depth, occlusion, opaque, (a fluid's passes), box edges, tonemap.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "engine/compute/kernel_source.h"
#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "engine/render/frame_params.h"
#include "engine/render/gpu_images.h"
#include "engine/render/gpu_mesh.h"

namespace rivulet {

// The programs of all passes.
struct RenderPrograms {
    gpu::Program shadow, shadowHoles, shadowFirst, shadowHalve, shadowBlur, depth, floorDepth, occlusion, occlusionBlur, sky, floor, mesh,
        glass, box, boxOverWater, tonemap, antialias;
    static Result<RenderPrograms> create(const ShaderFiles& files);
    std::vector<gpu::Program*> all();  // and the parts' that were made so far

    // The program for parts of this material, with or without a layer on it, with or without water in the light's way: made when first
    // asked for. Error: as create.
    Result<gpu::Program*> part(const Material& material, bool layered, bool water);

  private:
    ShaderFiles files_;
    std::map<unsigned, gpu::Program> parts_;
};

struct DrawnMesh {
    const GpuMesh* mesh = nullptr;  // lives until the graph has executed
    mat4 toWorld{1.0F};
    Material material;
    gpu::Program* part = nullptr;  // RenderPrograms::part(), and then `textures` too; null: the material's three numbers say all
    MaterialTextures textures;
    gpu::Program* wetPart = nullptr;  // the same with a layer; and then the layer, whose texels are there
    const Layer* layer = nullptr;
};

// Whether a material needs more than its three numbers.
bool isPart(const Material& material);

// What the light's way to a surface is looked up in. Without meshes or without water, any texture stands in: FrameParams::shadow says so.
struct LightMaps {
    gpu::TextureHandle sharp, soft, water;
    vec3 absorption{0.0F};  // 1/m, of the water
};

// The moments of the meshes' depth as the light sees it, blurred narrowly into `sharp` and widely into `soft`, which are of
// shadowMapDesc(). They change only with the meshes and the light, so whoever keeps them saves the pass; for who cannot, since a mesh
// deforms in each frame, there are `quick` ones of half the width.
gpu::TextureDesc shadowMapDesc(bool soft, bool quick);
void addShadow(gpu::FrameGraph& graph, RenderPrograms& programs, std::vector<DrawnMesh> meshes, const mat4& projection,
               gpu::TextureHandle sharp, gpu::TextureHandle soft, bool quick);
// Window depth of meshes and floor, without what is blended or has holes. `frame`: the buffer of a FrameParams.
gpu::TextureHandle addDepth(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                            std::vector<DrawnMesh> meshes);
// How open each point is to the environment, at half resolution; `reach` in m.
gpu::TextureHandle addOcclusion(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                                gpu::TextureHandle depth, float reach);
// Linear radiance (rgba16f) of background, floor and meshes; what is blended comes last, the farthest first.
gpu::TextureHandle addOpaque(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                             std::vector<DrawnMesh> meshes, gpu::TextureHandle depth, gpu::TextureHandle occlusion, const LightMaps& light,
                             bool floor = true);
// What is clear among the meshes, drawn into `colour`: each face mirrors and dims what is behind it. `side`: of the water, whose depth is
// `fluidDepth` (m, r32f; 1e6 where there is none, and there all is behind); all: there is no water, and fluidDepth may be empty.
enum class GlassSide { all, behind, before };
void addGlass(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, std::vector<DrawnMesh> meshes,
              gpu::TextureHandle colour, gpu::TextureHandle depth, const LightMaps& light, GlassSide side,
              gpu::TextureHandle fluidDepth = {});
// Window depth of the nearest face of what is clear, 1 where there is none; empty: nothing is.
gpu::TextureHandle addGlassDepth(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                                 std::vector<DrawnMesh> meshes);
// The edges of a box, drawn into `colour`. With `fluidDepth` (m, r32f): only those in front of the water.
void addBox(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const Bounds& box, gpu::TextureHandle colour,
            gpu::TextureHandle depth, gpu::TextureHandle fluidDepth = {});
// Linear radiance to sRGB, edges smoothed, dithered, into `picture` (rgba8, view's size).
void addTonemap(gpu::FrameGraph& graph, RenderPrograms& programs, gpu::BufferHandle frame, const FrameView& view, gpu::TextureHandle colour,
                gpu::TextureHandle picture);

}  // namespace rivulet
