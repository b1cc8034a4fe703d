// A skin's state, saved in host memory and restored on any device.
#include "fluid/scene/flow_component.h"

namespace rivulet {

struct FlowComponent::Snapshot {
    double time = 0;
    dmat4 toWorld{1.0};
    std::vector<Source> sources;
    std::vector<std::string> noticed;
    uint64_t emitted = 0;
    double acted = 0;
    std::array<float, 2> lidsFull{};
    std::shared_ptr<const SurfaceFlow::Snapshot> flow;
};

std::shared_ptr<const FlowComponent::Snapshot> FlowComponent::save() const {
    return std::make_shared<const Snapshot>(
        Snapshot{placed_->time(), placed_->toWorld(), sources_, noticed_, emitted_, acted_, *lidsFull_, flow_->save()});
}

Status FlowComponent::restore(const Snapshot& snapshot) {
    placed_->restore(snapshot.time, snapshot.toWorld);
    sources_ = snapshot.sources;
    noticed_ = snapshot.noticed;
    emitted_ = snapshot.emitted;
    around_ = {};
    acted_ = snapshot.acted;
    *lidsFull_ = snapshot.lidsFull;
    bend(acted_);
    return flow_->restore(*snapshot.flow);
}

}  // namespace rivulet
