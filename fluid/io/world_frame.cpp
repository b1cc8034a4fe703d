#include "fluid/io/world_frame.h"

#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "fluid/sim/sources/dry.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

namespace {

// An array of a world, and where a frame has it.
struct Part {
    const Buffer* from;
    size_t count;
    std::vector<vec4>* to;
    size_t bytes() const { return count * sizeof(vec4); }
};

// All but ids, of all slots. Sets what the host knows, and empties the others.
std::vector<Part> partsOf(const FluidWorld& world, RecordedFrame& frame) {
    const Device& device = world.device();
    const ParticleView particles = world.particles();
    frame.time = world.time();
    frame.spacing = particles.spacing;
    frame.halves = device.backend() != Backend::gl && !device.glShare().by;  // as FluidUpload brings them over
    frame.box = {world.params().box.min, world.params().box.max};
    frame.dry = placedDry(world.ownDry(), world.expectedBodies());
    const size_t foam = particles.foam != nullptr ? particles.foamSlots : 0, slots = particles.count > 0 ? particles.slots : 0;
    std::vector<Part> parts = {{particles.foamDrawn, foam, &frame.foam},  {particles.foamVelocity, foam, &frame.foamVelocity},
                               {particles.drawn, slots, &frame.position}, {particles.velocity, slots, &frame.velocity},
                               {particles.normal, slots, &frame.normal},  {particles.absorption, slots, &frame.absorption}};
    for (size_t k = 0; k < kMostAttributes; ++k) parts.push_back({particles.attributes[k], slots, &frame.attributes[k]});
    for (size_t k = 0; k < frame.ellipsoids.size(); ++k) parts.push_back({particles.ellipsoids[k], slots, &frame.ellipsoids[k]});
    for (const Part& p : parts) p.to->resize(p.from != nullptr ? p.count : 0);
    frame.id.resize(slots);
    std::erase_if(parts, [](const Part& p) { return p.from == nullptr || p.count == 0; });
    return parts;
}

// Removes all items but those at the indices in `kept`, which are sorted.
template <class T>
void keepChosen(const std::vector<uint32_t>& kept, std::vector<T>& of) {
    if (of.empty()) return;
    for (size_t k = 0; k < kept.size(); ++k) of[k] = of[kept[k]];
    of.resize(kept.size());
}

// Free slots and samples on bodies are not drawn.
void keepDrawn(RecordedFrame& frame) {
    std::vector<uint32_t> kept;
    const auto choose = [&kept](const std::vector<vec4>& from, const auto& drawn) {
        kept.clear();
        kept.reserve(from.size());
        for (uint32_t i = 0; i < from.size(); ++i)
            if (drawn(from[i])) kept.push_back(i);
    };
    choose(frame.foam, [](const vec4& p) { return p.w > 0; });
    keepChosen(kept, frame.foam);
    keepChosen(kept, frame.foamVelocity);
    choose(frame.position, [](const vec4& p) { return !(p.w < 0); });
    for (std::vector<vec4>* of : {&frame.position, &frame.velocity, &frame.normal, &frame.absorption}) keepChosen(kept, *of);
    for (std::vector<vec4>& of : frame.attributes) keepChosen(kept, of);
    for (std::vector<vec4>& of : frame.ellipsoids) keepChosen(kept, of);
    keepChosen(kept, frame.id);
}

}  // namespace

void frameOf(const FluidWorld& world, RecordedFrame& frame) {
    Device& device = world.device();
    const std::vector<Part> parts = partsOf(world, frame);
    frame.dry = world.dry();
    for (const Part& p : parts) device.read(*p.from, std::as_writable_bytes(std::span(*p.to)));
    if (!frame.id.empty()) device.read(*world.particles().id, std::as_writable_bytes(std::span(frame.id)));
    keepDrawn(frame);
}

// Reads arrive in the order of their requests.
void frameLater(const FluidWorld& world, const std::shared_ptr<RecordedFrame>& frame, std::function<void()> then) {
    Device& device = world.device();
    const auto take = [frame](void* to) {
        return [frame, to](std::span<const std::byte> bytes) { std::memcpy(to, bytes.data(), bytes.size()); };
    };
    for (const Part& p : partsOf(world, *frame)) device.readLater(*p.from, p.bytes(), take(p.to->data()));
    const auto done = [frame, then = std::move(then)] {
        keepDrawn(*frame);
        then();
    };
    if (frame->id.empty()) {
        device.readLater(*world.particles().id, 0, [done](std::span<const std::byte>) { done(); });
        return;
    }
    device.readLater(*world.particles().id, frame->id.size() * sizeof(uint32_t), [frame, done](std::span<const std::byte> bytes) {
        std::memcpy(frame->id.data(), bytes.data(), bytes.size());
        done();
    });
}

}  // namespace rivulet
