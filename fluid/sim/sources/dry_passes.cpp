#include "fluid/sim/sources/dry_passes.h"

#include <utility>

#include "shaders/fluid/sources/dry_params.h"

namespace rivulet {

Status DryPasses::prepare(Device& device) {
    if (device_ != nullptr) return ok();
    Result<Kernel> dry = device.kernel("fluid/sources/dry"), forget = device.kernel("fluid/sources/forget");
    Result<Buffer> places = device.allocate(kMostDry * sizeof(DryVolume)), counter = device.allocate(sizeof(uint32_t));
    for (const Result<Kernel>* k : {&dry, &forget})
        if (!*k) return k->error();
    for (const Result<Buffer>* b : {&places, &counter})
        if (!*b) return b->error();
    dry_ = *dry;
    forget_ = *forget;
    places_ = std::move(*places);
    counter_ = std::move(*counter);
    device_ = &device;
    return ok();
}

void DryPasses::set(std::span<const DryParams> volumes, std::vector<uint32_t> ids, std::vector<Pose> starts,
                    std::span<const BodyState> bodies) {
    params_.assign(volumes.begin(), volumes.end());
    bodiesChanged(std::move(ids), std::move(starts));
    volumes_ = placedDry(params_, {ids_, starts_, bodies});
}

void DryPasses::bodiesChanged(std::vector<uint32_t> ids, std::vector<Pose> starts) {
    ids_ = std::move(ids);
    starts_ = std::move(starts);
}

void DryPasses::run(const StepParams& step, const Buffer& cellStart, Particles& particles, std::span<const BodyState> bodies,
                    std::span<const NamedBuffer> remembered) {
    if (!any()) return;
    volumes_ = placedDry(params_, {ids_, starts_, bodies});
    device_->write(places_, std::as_bytes(std::span(volumes_)));
    DryParamsBlock block{};
    block.step = step;
    block.volumes = static_cast<uint32_t>(volumes_.size());
    device_->run(dry_, block, {&cellStart, &places_, &particles.positionNext, &particles.velocityNext, &counter_}, step.awakeSlots);
    for (const NamedBuffer& b : remembered)
        if (b.byId) device_->run(forget_, step, {&cellStart, &particles.positionNext, &particles.id, b.buffer}, step.awakeSlots);
}

void DryPasses::report() {
    if (!any()) return;
    device_->readLater(counter_, sizeof(uint32_t),
                       [into = removed_](std::span<const std::byte> bytes) { *into = *reinterpret_cast<const uint32_t*>(bytes.data()); });
}

uint64_t DryPasses::removed() const { return *removed_; }

void DryPasses::reset(std::span<const BodyState> bodies) {
    volumes_ = placedDry(params_, {ids_, starts_, bodies});
    removed_ = std::make_shared<uint32_t>(0);
    if (device_ != nullptr) device_->fill(counter_, 0);
}

}  // namespace rivulet
