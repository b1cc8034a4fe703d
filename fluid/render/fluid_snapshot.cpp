#include "fluid/render/fluid_snapshot.h"

#include <cstring>
#include <tuple>
#include <utility>

#include "fluid/io/world_frame.h"
#include "fluid/sim/sources/dry.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

void FluidSnapshot::begin(const FluidWorld& world, std::span<const vec4> drops, std::span<const vec4> pendants) {
    taken_ = false;
    coming_ = nullptr;
    revision_ = std::make_shared<const char>();
    drops_.assign(drops.begin(), drops.end());
    pendants_.assign(pendants.begin(), pendants.end());
    onGpu_ = world.device().backend() == Backend::gl;
    viscosity_ = world.particles().viscosity;
    const WetnessView wet = world.wetness();
    wetSurface_ = wet.surface && !wet.surface->points.empty() ? wet.surface : nullptr;
}

Status FluidSnapshot::take(const FluidWorld& world, std::span<const vec4> drops, std::span<const vec4> pendants) {
    begin(world, drops, pendants);
    if (onGpu_) {
        if (Status copied = takeOnGpu(world); !copied) return copied;
    } else {
        frameOf(world, frame_);
        wetness_.resize(wetSurface_ ? wetSurface_->points.size() : 0);
        if (wetSurface_) world.device().read(*world.wetness().values, std::as_writable_bytes(std::span(wetness_)));
    }
    taken_ = true;
    return ok();
}

Status FluidSnapshot::takeLater(const FluidWorld& world, std::span<const vec4> drops, std::span<const vec4> pendants) {
    if (world.device().backend() != Backend::cl) return take(world, drops, pendants);
    begin(world, drops, pendants);
    coming_ = std::make_shared<Coming>();
    coming_->frame = std::move(frame_);  // its memory is used again
    coming_->wetness.resize(wetSurface_ ? wetSurface_->points.size() : 0);
    if (wetSurface_)
        world.device().readLater(
            *world.wetness().values, coming_->wetness.size() * sizeof(float),
            [to = coming_](std::span<const std::byte> bytes) { std::memcpy(to->wetness.data(), bytes.data(), bytes.size()); });
    frameLater(world, {coming_, &coming_->frame}, [to = std::weak_ptr(coming_)] {
        if (const auto coming = to.lock()) coming->complete = true;
    });
    return ok();
}

bool FluidSnapshot::arrived() {
    if (!coming_ || !coming_->complete) return taken_;
    frame_ = std::move(coming_->frame);
    wetness_ = std::move(coming_->wetness);
    coming_ = nullptr;
    return taken_ = true;
}

void FluidSnapshot::take(RecordedFrame frame, float viscosity) {
    coming_ = nullptr;
    frame_ = std::move(frame);
    revision_ = std::make_shared<const char>();
    drops_.clear();
    pendants_.clear();
    viscosity_ = viscosity;
    wetSurface_ = nullptr;
    onGpu_ = false;
    taken_ = true;
}

Status FluidSnapshot::takeOnGpu(const FluidWorld& world) {
    const ParticleView particles = world.particles();
    frame_.time = world.time();
    frame_.spacing = particles.spacing;
    frame_.box = {world.params().box.min, world.params().box.max};
    frame_.dry = placedDry(world.ownDry(), world.expectedBodies());
    count_ = particles.count > 0 ? particles.slots : 0;
    foamCount_ = particles.foam != nullptr ? particles.foamSlots : 0;
    Device& device = world.device();
    const auto copy = [&device](Copy& to, const Buffer* from, size_t bytes) -> Status {
        to.used = from != nullptr && bytes > 0;
        if (!to.used) return ok();
        if (to.memory.bytes() < bytes) {
            Result<Buffer> made = device.allocate(bytes);
            if (!made) return made.error();
            to.memory = std::move(*made);
        }
        device.copy(*from, to.memory, bytes);
        return ok();
    };
    const size_t vectors = count_ * sizeof(vec4), foam = foamCount_ * sizeof(vec4);
    for (const auto& [to, from, bytes] : {std::tuple(&position_, particles.drawn, vectors),
                                          {&velocity_, particles.velocity, vectors},
                                          {&normal_, particles.normal, vectors},
                                          {&id_, particles.id, count_ * sizeof(uint32_t)},
                                          {&absorption_, particles.absorption, vectors},
                                          {&ellipsoids_[0], particles.ellipsoids[0], vectors},
                                          {&ellipsoids_[1], particles.ellipsoids[1], vectors},
                                          {&ellipsoids_[2], particles.ellipsoids[2], vectors},
                                          {&foam_[0], particles.foamDrawn, foam},
                                          {&foam_[1], particles.foamVelocity, foam},
                                          {&wet_, world.wetness().values, wetSurface_ ? wetSurface_->points.size() * sizeof(float) : 0}})
        if (Status done = copy(*to, from, bytes); !done) return done;
    for (size_t k = 0; k < kMostAttributes; ++k)
        if (Status done = copy(attributes_[k], particles.attributes[k], vectors); !done) return done;
    return ok();
}

}  // namespace rivulet
