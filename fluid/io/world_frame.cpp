#include "fluid/io/world_frame.h"

#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

// Reads `count` items and keeps those whose index `kept` has, which are in order.
template <class T>
void readChosen(Device& device, const Buffer* from, size_t count, const std::vector<uint32_t>& kept, std::vector<T>& to) {
    to.clear();
    if (from == nullptr) return;
    to.resize(count);
    device.read(*from, std::as_writable_bytes(std::span(to)));
    for (size_t k = 0; k < kept.size(); ++k) to[k] = to[kept[k]];
    to.resize(kept.size());
}

}  // namespace

void frameOf(const FluidWorld& world, RecordedFrame& frame) {
    Device& device = world.device();
    const ParticleView particles = world.particles();
    frame.time = world.time();
    frame.spacing = particles.spacing;
    frame.halves = device.backend() != Backend::gl && !device.glShare().by;  // as FluidUpload brings them over
    frame.box = {world.params().box.min, world.params().box.max};
    frame.dry = world.dry();
    // Free slots and samples on bodies are not drawn.
    std::vector<uint32_t> kept;
    const auto choose = [&](const Buffer& from, size_t count, const auto& drawn) {
        kept.clear();
        kept.reserve(count);
        frame.position.resize(count);
        device.read(from, std::as_writable_bytes(std::span(frame.position)));
        for (uint32_t i = 0; i < count; ++i)
            if (drawn(frame.position[i])) kept.push_back(i);
    };
    const size_t foam = particles.foam != nullptr ? particles.foamSlots : 0;
    if (foam > 0) choose(*particles.foamDrawn, foam, [](const vec4& p) { return p.w > 0; });
    readChosen(device, foam > 0 ? particles.foamDrawn : nullptr, foam, kept, frame.foam);
    readChosen(device, foam > 0 ? particles.foamVelocity : nullptr, foam, kept, frame.foamVelocity);
    const size_t slots = particles.count > 0 ? particles.slots : 0;
    kept.clear();
    if (slots > 0) choose(*particles.drawn, slots, [](const vec4& p) { return !(p.w < 0); });
    const auto read = [&](const Buffer* from, auto& to) { readChosen(device, slots > 0 ? from : nullptr, slots, kept, to); };
    read(particles.drawn, frame.position);
    read(particles.velocity, frame.velocity);
    read(particles.id, frame.id);
    read(particles.normal, frame.normal);
    read(particles.absorption, frame.absorption);
    for (size_t k = 0; k < kMostAttributes; ++k) read(particles.attributes[k], frame.attributes[k]);
    for (size_t k = 0; k < frame.ellipsoids.size(); ++k) read(particles.ellipsoids[k], frame.ellipsoids[k]);
}

}  // namespace rivulet
