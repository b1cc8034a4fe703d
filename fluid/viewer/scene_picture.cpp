#include "fluid/viewer/scene_picture.h"

#include <optional>
#include <utility>

#include "fluid/session/cooperation.h"

namespace rivulet {

void ScenePicture::adopt(std::unique_ptr<SceneRenderer> renderer, Timeline& timeline) {
    renderer_ = std::move(renderer);
    renderer_->onSpan(timeline.lane(kDrawingLane));
    renderer_->hurry(adaptiveQuality_.fast());
}

void ScenePicture::begin(bool software) {
    adaptiveQuality_.begin(software);
    renderer_->hurry(adaptiveQuality_.fast());
}

Status ScenePicture::draw(Session& session, int width, int height, Timeline& timeline, const std::function<void()>& uploaded) {
    const SceneFile& scene = session.scene();
    std::optional<TimedSpan> span(std::in_place, &timeline, "main", "upload");
    LateView::Shown shown{{}, &session.solids(), session.time()};
    if (LateView::suits(session)) {
        Result<LateView::Shown> late = late_.show(upload_, session);
        if (!late) return late.error();
        shown = *late;
    } else {
        const Result<FluidView> fluid = viewOf(upload_, session);
        if (!fluid) return fluid.error();
        shown.fluid = *fluid;
    }
    if (Status wet = session.flows().draw(); !wet) return wet;
    Camera camera = cameraOf(scene.camera, session.bounds());
    FrameView view = frameViewOf(camera, scene.light, width, height, shown.time);
    span.reset();
    uploaded();
    const TimedSpan drawing(&timeline, "main", "draw");
    return renderer_->draw(view, shown.fluid, *shown.solids, scene);
}

ScenePicture::Quality ScenePicture::quality(const FluidLookParams& look) const {
    if (look.quality == "auto") return {adaptiveQuality_.fast() ? "fast" : "fine", adaptiveQuality_.reason()};
    return {look.quality == "fast" ? "fast" : "fine", "chosen in look.quality"};
}

void ScenePicture::adaptQuality(const FluidLookParams& look) {
    if (!look.split.empty() || look.quality != "auto") return;  // a half that is ray-marched says nothing of the other
    double ms = 0;
    for (const PassTime& pass : renderer_->times()) ms += pass.ms;
    adaptiveQuality_.frame(ms);
    renderer_->hurry(adaptiveQuality_.fast());
}

}  // namespace rivulet
