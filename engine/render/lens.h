// The camera's lens: glare and depth of field, between the drawn scene and its tone mapping. Each is a pass of its own and costs nothing
// when it is off.
#pragma once

#include <array>

#include "engine/gpu/frame_graph.h"
#include "engine/gpu/program.h"
#include "engine/render/frame_view.h"

namespace rivulet {

struct Lens {
    float exposure = 0.0F;   // stops more light than by default
    float bloom = 0.0F;      // 0..1: share of the light that the lens scatters around bright things
    float aperture = 0.0F;   // f-number of a lens before a sensor 24 mm high; 0: everything is sharp
    float focus = 1.0F;      // m, > 0: distance along the view axis that is sharp
    bool automatic = false;  // instead that of what is in the middle of the picture; `focus` where only background is
};

struct LensPrograms {
    gpu::Program bloomDown, bloomUp, blur;
    static Result<LensPrograms> create(const ShaderFiles& files);
    std::array<gpu::Program*, 3> all() { return {&bloomDown, &bloomUp, &blur}; }
};

// Diameter of the blur of a point at `depth` m, as a share of the picture's height, negative before the focus: a thin lens (Potmesil and
// Chakravarty 1981) of the focal length that gives `view`'s angle of view. At most 0.03, which is what the samples fill.
float blurDiameter(const Lens& lens, const FrameView& view, float depth);

// `colour` (rgba16f) with the lens's blur of what is not in focus. `depth`: window depth; `fluidDepth`: m, or empty.
gpu::TextureHandle addDepthOfField(gpu::FrameGraph& graph, LensPrograms& programs, gpu::BufferHandle frame, const FrameView& view,
                                   const Lens& lens, gpu::TextureHandle colour, gpu::TextureHandle depth, gpu::TextureHandle fluidDepth);
// `colour` (rgba16f) with glare: a share of all light is spread over the picture by a pyramid of blurs (Jimenez 2014).
gpu::TextureHandle addBloom(gpu::FrameGraph& graph, LensPrograms& programs, const Lens& lens, gpu::TextureHandle colour);

}  // namespace rivulet
