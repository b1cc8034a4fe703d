#include "fluid/session/late_view.h"

#include <utility>

#include "fluid/session/session.h"

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

Result<LateView::Shown> LateView::show(FluidUpload& upload, const Session& session) {
    constexpr size_t kOnTheirWay = 3;
    Device& device = session.world().device();
    const double now = session.time();
    if (device_ != &device || (!frames_.empty() && now < frames_.back().time)) frames_.clear();  // another device, or a restart
    device_ = &device;
    Frame& frame = frames_.emplace_back(std::move(spare_));
    frame.solids = session.solids();
    frame.time = now;
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
    Result<FluidView> fluid = upload.view(frames_.front().snapshot, session.scene().look);
    if (!fluid) return fluid.error();
    return Shown{*fluid, &frames_.front().solids, frames_.front().time};
}

}  // namespace rivulet
