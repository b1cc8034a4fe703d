#include "fluid/bridge/fluid_upload.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/core/timeline.h"

namespace rivulet {

namespace {

Status makeRoom(gpu::Buffer& buffer, size_t bytes) {
    if (buffer && buffer.bytes() >= bytes) return ok();
    Result<gpu::Buffer> made = gpu::Buffer::create(bytes);
    if (!made) return made.error();
    buffer = std::move(*made);
    return ok();
}

template <class T>
std::span<T> as(std::span<std::byte> bytes) {
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

Result<FluidView> FluidUpload::view(const FluidWorld& world, const FluidLookParams& look, std::span<const vec4> drops) {
    const double start = hostSeconds();
    const ParticleView particles = world.particles();
    Device& device = world.device();
    const bool same = device.backend() == Backend::gl;
    facts_ = {.way = same ? "same memory" : "ring", .ms = 0, .bytes = 0, .waits = ring_.waits()};
    FluidView out;
    out.count = particles.count > 0 ? particles.slots : 0;
    out.spacing = particles.spacing;
    out.radius = look.radiusSpacings * particles.spacing;
    out.bounds.add(world.params().box.min);
    out.bounds.add(world.params().box.max);
    out.dropCount = static_cast<uint32_t>(drops.size() / 2);
    if (out.dropCount > 0) {
        if (Status s = makeRoom(drops_, drops.size_bytes()); !s) return s.error();
        drops_.writeAll(drops);
        out.drops = drops_.name();
    }
    out.foamCount = particles.foam != nullptr ? particles.foamSlots : 0;
    // The points' shader reads normals where it else reads velocities. There are none before the first step.
    const bool normals = (look.colourBy == "normal" || look.colourBy == "surface") && particles.normal != nullptr;
    std::vector<Array> arrays;
    const auto wanted = [&](const Buffer* from, gpu::Buffer& to, unsigned& name, bool ofParticles) {
        if (from == nullptr) return;
        if (same)
            name = static_cast<unsigned>(from->handle());
        else
            arrays.push_back({from, &to, &name, ofParticles});
    };
    if (out.foamCount > 0) {
        wanted(particles.foamDrawn, foam_[0], out.foam[0], false);
        wanted(particles.foamVelocity, foam_[1], out.foam[1], false);
    }
    if (out.count > 0) {
        wanted(particles.drawn, position_, out.position, true);
        wanted(normals ? particles.normal : particles.velocity, velocity_, out.velocity, true);
        wanted(particles.absorption, absorption_, out.absorption, true);
        for (size_t k = 0; look.splats == "ellipsoids" && k < 3; ++k)
            wanted(particles.ellipsoids[k], ellipsoids_[k], out.ellipsoids[k], true);
        if (same) out.id = static_cast<unsigned>(particles.id->handle());
    }
    if (!same && (out.count > 0 || out.foamCount > 0))
        if (Status s = bringOver(device, arrays, *particles.id, look.quality != "fine", out); !s) return s.error();
    facts_.ms = 1000 * (hostSeconds() - start);
    facts_.waits = ring_.waits();
    return out;
}

Status FluidUpload::bringOver(Device& device, std::span<const Array> arrays, const Buffer& ids, bool hurried, FluidView& out) {
    const auto bytesOf = [&](const Array& a) { return sizeof(vec4) * (a.ofParticles ? out.count : out.foamCount); };
    size_t bytes = 64 + out.count * sizeof(uint32_t);
    for (const Array& a : arrays) bytes += 64 + bytesOf(a);
    if (Status s = ring_.begin(bytes); !s) return s;
    const struct End {
        gpu::StagingRing& ring;
        ~End() { ring.end(); }  // whatever fails, copies may be under way
    } end{ring_};
    facts_.bytes = bytes;
    ids_.resize(out.count);
    if (out.count > 0) device.read(ids, std::as_writable_bytes(std::span(ids_)));
    // Those of even number first: half of them by place would be another half whenever a particle changes its cell, and still water would
    // flicker.
    order_.resize(out.count);
    std::iota(order_.begin(), order_.end(), 0U);
    if (hurried) {
        const auto odd = std::stable_partition(order_.begin(), order_.end(), [this](uint32_t i) { return ids_[i] % 2 == 0; });
        out.half = static_cast<uint32_t>(odd - order_.begin());
    }
    for (const Array& a : arrays) {
        const std::span<std::byte> into = ring_.take(bytesOf(a));
        if (hurried && a.ofParticles) {
            vectors_.resize(out.count);
            device.read(*a.from, std::as_writable_bytes(std::span(vectors_)));
            std::transform(order_.begin(), order_.end(), as<vec4>(into).begin(), [this](uint32_t i) { return vectors_[i]; });
        } else {
            device.read(*a.from, into);
        }
        if (Status room = makeRoom(*a.to, into.size()); !room) return room;
        ring_.copyTo(*a.to);
        *a.name = a.to->name();
    }
    if (out.count > 0) {
        const std::span<uint32_t> into = as<uint32_t>(ring_.take(out.count * sizeof(uint32_t)));
        std::transform(order_.begin(), order_.end(), into.begin(), [this](uint32_t i) { return ids_[i]; });
        if (Status room = makeRoom(id_, into.size_bytes()); !room) return room;
        ring_.copyTo(id_);
        out.id = id_.name();
    }
    return ok();
}

}  // namespace rivulet
