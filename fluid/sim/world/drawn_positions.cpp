#include "fluid/sim/world/drawn_positions.h"

#include "shaders/fluid/world/blend_params.h"

namespace rivulet {

Status DrawnPositions::prepare(Device& device, uint32_t count) {
    if (prepared_) return ok();
    for (auto [kernel, path] : {std::pair(&remember_, "fluid/world/remember"), std::pair(&blend_, "fluid/world/blend")}) {
        Result<Kernel> found = device.kernel(path);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (Buffer* buffer : {&remembered_, &positions_}) {
        Result<Buffer> made = device.allocate(size_t{count} * sizeof(vec4));
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    prepared_ = true;
    return ok();
}

void DrawnPositions::remember(Device& device, const Particles& particles) {
    if (!prepared_) return;
    const BlendParams params{.share = 0, .reach2 = 0, .count = particles.count, .padding0 = 0};
    device.run(remember_, params, {&particles.id, &particles.positionNext, &remembered_}, particles.count);
    remembers_ = true;
}

void DrawnPositions::draw(Device& device, const Particles& particles, float share, float reach) {
    drawn_ = remembers_;
    if (!remembers_) return;
    const BlendParams params{.share = share, .reach2 = reach * reach, .count = particles.count, .padding0 = 0};
    device.run(blend_, params, {&particles.id, &particles.positionNext, &remembered_, &positions_}, particles.count);
}

}  // namespace rivulet
