#include "fluid/session/late_view.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "fluid/scene/collider_motion.h"
#include "fluid/session/session.h"
#include "fluid/sim/sources/dry.h"

namespace rivulet {

bool LateView::suits(const Session& session) {
    const Device& device = session.world().device();
    return device.backend() == Backend::cl && session.replaying() == nullptr && !device.glShare().by;
}

void LateView::dropOlder() {
    while (frames_.size() > 1 && frames_[1].snapshot.arrived()) {
        spare_ = std::move(frames_.front());
        frames_.pop_front();
    }
}

// To where they were: their states have arrived before the particles. A body that has no state, since the world is another one with fewer
// bodies by now, stays.
void LateView::moveBodies(Frame& frame, const FluidWorld& world) {
    if (!std::exchange(frame.moved, false)) return;
    const std::optional<std::vector<BodyState>> states = world.bodiesAt(frame.time);
    if (!states) return;
    for (size_t n = 0; n < frame.solids.nodes().size(); ++n)
        if (const int body = frame.solids.nodes()[n].body; body >= 0 && static_cast<size_t>(body) < states->size())
            frame.solids.moveBody(n, matrixOf((*states)[static_cast<size_t>(body)].pose));
    frame.snapshot.cutAt(placedDry(frame.dry, *states));
}

void LateView::readMeshes(Scene& solids) {
    std::vector<std::shared_ptr<const DeformedVertices>> read;
    for (Node& node : solids.nodes()) {
        if (!node.deformer) continue;
        const auto isOfNode = [&](const auto& vertices) { return vertices->of.lock() == node.deformer; };
        const auto before = std::ranges::find_if(meshes_, isOfNode);
        node.deformed = before != meshes_.end() && (*before)->version == node.deformer->version() ? *before : readLater(node.deformer);
        node.deformer = nullptr;
        read.push_back(node.deformed);
    }
    meshes_ = std::move(read);
}

Result<LateView::Shown> LateView::show(FluidUpload& upload, const Session& session) {
    constexpr size_t kOnTheirWay = 3;
    Device& device = session.world().device();
    const double now = session.time();
    if (device_ != &device || (!frames_.empty() && now < frames_.back().time)) frames_.clear();  // another device, or a restart
    device_ = &device;
    Frame& frame = frames_.emplace_back(std::move(spare_));
    frame.solids = session.solids();
    frame.time = now;
    frame.moved = session.world().bodyRows().current;
    frame.dry = session.world().ownDry();
    readMeshes(frame.solids);
    if (Status asked = frame.snapshot.takeLater(session.world(), session.flows().airDrops(), session.flows().pendants()); !asked) {
        frames_.pop_back();
        return asked.error();
    }
    device.poll();
    dropOlder();
    if (!frames_.front().snapshot.arrived() || frames_.size() > 1 + kOnTheirWay) {
        device.finish();
        device.poll();
        dropOlder();
    }
    if (!frames_.front().snapshot.arrived()) return failed("the device does not answer any more");
    moveBodies(frames_.front(), session.world());
    Result<FluidView> fluid = upload.view(frames_.front().snapshot, session.scene().look);
    if (!fluid) return fluid.error();
    return Shown{*fluid, &frames_.front().solids, frames_.front().time};
}

}  // namespace rivulet
