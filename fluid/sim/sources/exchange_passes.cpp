#include "fluid/sim/sources/exchange_passes.h"

#include <algorithm>

#include "engine/core/assert.h"

namespace rivulet {

Result<ExchangePasses> ExchangePasses::create(Device& device) {
    ExchangePasses e;
    e.device_ = &device;
    for (auto [kernel, path] : {std::pair(&e.within_, "fluid/sources/within"), std::pair(&e.take_, "fluid/sources/take"),
                                std::pair(&e.forget_, "fluid/sources/forget")}) {
        Result<Kernel> found = device.kernel(path);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (auto [buffer, bytes] : {std::pair(&e.counter_, sizeof(uint32_t)), std::pair(&e.found_, 2 * kMost * sizeof(vec4)),
                                 std::pair(&e.slots_, kMost * sizeof(uint32_t))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return e;
}

std::vector<WorldParticle> ExchangePasses::within(const StepParams& step, const Particles& particles, const Bounds& box, float faster,
                                                  float looser) {
    if (box.empty()) return {};
    ExchangeParams block{};
    block.step = step;
    block.step.count = particles.count;
    block.low = vec4(box.min, 0.0F);
    block.high = vec4(box.max, 0.0F);
    block.most = kMost;
    block.faster = faster;
    block.looser = looser;
    device_->fill(counter_, 0);
    device_->run(within_, block, {&particles.positionNext, &particles.velocityNext, &counter_, &found_, &slots_}, particles.count);
    const uint32_t count = std::min(device_->readAll<uint32_t>(counter_, 1)[0], static_cast<uint32_t>(kMost));
    if (count == 0) return {};
    const std::vector<vec4> found = device_->readAll<vec4>(found_, kMost + count);
    const std::vector<uint32_t> slots = device_->readAll<uint32_t>(slots_, count);
    std::vector<WorldParticle> all;
    for (uint32_t k = 0; k < count; ++k) all.push_back({vec3(found[k]), vec3(found[kMost + k]), found[k].w, slots[k]});
    // The atomic has them in any order.
    std::sort(all.begin(), all.end(), [](const WorldParticle& a, const WorldParticle& b) { return a.slot < b.slot; });
    return all;
}

void ExchangePasses::take(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
                          std::span<const uint32_t> slots, bool sorted) {
    if (slots.empty()) return;
    ASSERT(slots.size() <= kMost, "the slots must be those of within()");
    device_->write(slots_, std::as_bytes(slots));
    ExchangeParams block{};
    block.step = step;
    block.count = static_cast<uint32_t>(slots.size());
    device_->run(take_, block, {&slots_, &particles.positionNext, &particles.velocityNext, &found_}, block.count);
    // Before the first sort no method has stored anything per particle.
    for (const NamedBuffer& b : remembered)
        if (b.byId && sorted)
            device_->run(forget_, step, {&grid.cellStart(), &particles.positionNext, &particles.id, b.buffer}, particles.count);
}

Bounds ExchangePasses::taken(size_t count) {
    Bounds box;
    for (const vec4& place : device_->readAll<vec4>(found_, count)) box.add(vec3(place));
    return box;
}

}  // namespace rivulet
