// A host's own renderer, given in C, as a row for WaterRenderer::draw.
#pragma once

#include <string>

#include "engine/core/result.h"
#include "fluid/capi/rivulet.h"
#include "fluid/render/renderers.h"

namespace rivulet::capi {

class HostRenderer {
  public:
    // `ours`: the row of the world's look. Error (badInput): a stage that does not exist; no function.
    static Result<HostRenderer> of(const rivulet_renderer& host, const RendererRow& ours);
    // Points to this object.
    RendererRow row();
    // Error (failed): the function threw an exception.
    Status outcome() const;

  private:
    static FluidLayers add(gpu::FrameGraph& graph, FluidPrograms& programs, const FluidDraw& draw);
    void call(const FluidDraw& draw, unsigned framebuffer);

    rivulet_renderer host_{};
    const RendererRow* ours_ = nullptr;
    std::string thrown_;
};

}  // namespace rivulet::capi
