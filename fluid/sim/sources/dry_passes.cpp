#include "fluid/sim/sources/dry_passes.h"

#include <algorithm>
#include <utility>

#include "shaders/fluid/sources/dry_params.h"

namespace rivulet {

namespace {
bool isCarried(const DryParams& d) { return d.body >= 0; }
}  // namespace

Status DryPasses::prepare(Device& device, std::span<const DryParams> volumes) {
    if (!dryOfRows_ && device.backend() != Backend::cpu && std::ranges::any_of(volumes, isCarried)) {
        const Define bodies{"BODIES", "1"};
        Result<Kernel> made = device.kernel("fluid/sources/dry", std::span(&bodies, 1));
        if (!made) return made.error();
        dryOfRows_ = *made;
    }
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
    place(bodies);
}

bool DryPasses::anyCarried() const { return std::ranges::any_of(params_, isCarried); }

std::vector<DryVolume> DryPasses::own() const { return ownDry(params_, {ids_, starts_, {}}); }

void DryPasses::place(std::span<const BodyState> bodies) { volumes_ = placedDry(params_, DryBodies{ids_, starts_, bodies}); }

void DryPasses::bodiesChanged(std::vector<uint32_t> ids, std::vector<Pose> starts) {
    ids_ = std::move(ids);
    starts_ = std::move(starts);
}

void DryPasses::run(const StepParams& step, const Buffer& cellStart, Particles& particles, std::span<const BodyState> bodies,
                    const BodyRows& rows, std::span<const NamedBuffer> remembered) {
    if (!any()) return;
    place(bodies);
    const bool byRows = rows.current && anyCarried();
    device_->writeAll<DryVolume>(places_, byRows ? own() : volumes_);
    DryParamsBlock block{};
    block.step = step;
    block.volumes = static_cast<uint32_t>(volumes_.size());
    if (byRows)
        device_->run(*dryOfRows_, block, {&cellStart, &places_, &particles.positionNext, &particles.velocityNext, &counter_, rows.rows},
                     step.awakeSlots);
    else
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
    place(bodies);
    removed_ = std::make_shared<uint32_t>(0);
    if (device_ != nullptr) device_->fill(counter_, 0);
}

}  // namespace rivulet
