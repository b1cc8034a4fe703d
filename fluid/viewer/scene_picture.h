// ScenePicture: draws a session: uploads its particles to OpenGL and draws them in the quality that the frame rate allows.
#pragma once

#include <functional>
#include <memory>

#include "engine/core/timeline.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/adaptive_quality.h"
#include "fluid/session/late_view.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"

namespace rivulet {

class ScenePicture {
  public:
    // Continues with this renderer; its passes are recorded in `timeline`.
    void adopt(std::unique_ptr<SceneRenderer> renderer, Timeline& timeline);
    void begin(bool software);  // with a software renderer, quality auto starts as fast
    SceneRenderer& renderer() const { return *renderer_; }
    const TransferFacts& facts() const { return upload_.facts(); }
    // `uploaded` is called when the world is no longer read. Error (failed): out of GPU memory; (badInput): as SceneRenderer::draw.
    Status draw(Session& session, int width, int height, Timeline& timeline, const std::function<void()>& uploaded);
    // The quality in use, fast or fine, and why; the reason is "" where auto chose fine.
    struct Quality {
        const char *name = "", *why = "";
    };
    Quality quality(const FluidLookParams& look) const;
    // Quality auto follows the times of the last pictures.
    void adaptQuality(const FluidLookParams& look);

  private:
    std::unique_ptr<SceneRenderer> renderer_;
    FluidUpload upload_;
    LateView late_;
    AdaptiveQuality adaptiveQuality_;
};

}  // namespace rivulet
