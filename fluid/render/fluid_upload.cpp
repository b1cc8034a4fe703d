#include "fluid/render/fluid_upload.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/core/readable_bytes.h"
#include "engine/core/timeline.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {

namespace {

Status makeRoom(gpu::Buffer& buffer, size_t bytes) {
    if (buffer && buffer.bytes() >= bytes) return ok();
    Result<gpu::Buffer> made = gpu::Buffer::create(bytes);
    if (!made) return made.error();
    buffer = std::move(*made);
    return ok();
}

constexpr const char* kSameMemory = "same memory";
constexpr const char* kSharedWithOpenCl = "shared with OpenCL";
constexpr const char* kRing = "ring";

// How many of them hold all particles: free slots and samples on bodies have a negative w.
uint32_t lastDrawn(std::span<const vec4> positions) {
    size_t last = positions.size();
    while (last > 0 && positions[last - 1].w < 0) --last;
    return static_cast<uint32_t>(last);
}

template <class T>
std::span<T> as(std::span<std::byte> bytes) {
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

std::string sentenceOf(const TransferFacts& facts) {
    std::string text = facts.way;
    if (facts.way != std::string_view(kSameMemory) && !text.empty()) text += fmt::format(": {:.2f} ms", facts.ms);
    if (facts.bytes > 0) text += fmt::format(", {:.1f} MB", 1.0e-6 * static_cast<double>(facts.bytes));
    if (facts.waits > 0) text += fmt::format(", waited {} times", facts.waits);
    if (!facts.why.empty()) text += fmt::format(" ({})", facts.why);
    return text;
}

Status FluidUpload::Target::makeRoom(size_t bytes) {
    if (memory && memory.bytes() >= bytes) return ok();
    seen.reset();
    return rivulet::makeRoom(memory, bytes);
}

template <class Self>
auto FluidUpload::targets(Self& of) {
    std::vector all = {&of.position_,      &of.velocity_,      &of.id_,           &of.absorption_,
                       &of.foam_[0],       &of.foam_[1],       &of.wetness_,      &of.bodies_,
                       &of.ellipsoids_[0], &of.ellipsoids_[1], &of.ellipsoids_[2]};
    for (auto& attribute : of.attributes_) all.push_back(&attribute);
    return all;
}

void FluidUpload::dropTargets() {
    for (Target* to : targets(*this)) to->drop();
    held_ = {};
}

size_t FluidUpload::bytes() const {
    size_t sum = ring_.bytes() + drops_.bytes() + pendants_.bytes() + wetCells_.bytes();
    for (const Target* to : targets(*this)) sum += to->memory.bytes();
    return sum;
}

// Whether `arrays`, and `others` bytes, may be brought over, through the ring or at once.
Status FluidUpload::room(std::span<const Array> arrays, size_t others, bool ring) const {
    size_t each = others;
    for (const Array& a : arrays) each += a.bytes;
    const size_t needed = each * (ring ? 1 + gpu::StagingRing::kDeep : 1) + wetCells_.bytes();
    if (needed <= mostBytes_) return ok();
    return failed(fmt::format("to draw the particles {} are brought over to OpenGL, and {} are allowed; allow more, or use fewer particles",
                              readableBytes(needed), readableBytes(mostBytes_)));
}

// Another Device: buffers that the previous one has wrapped are invalid for it.
void FluidUpload::follow(std::shared_ptr<const GlSharing> sharing) {
    if (sharing_) dropTargets();
    sharing_ = std::move(sharing);
    refused_.clear();
}

bool FluidUpload::holds(const std::shared_ptr<const void>& revision, const FluidLookParams& look, bool normals) const {
    return revision && last_.revision == revision && last_.radiusSpacings == look.radiusSpacings && last_.normals == normals &&
           last_.ellipsoids == (look.splats == "ellipsoids") && last_.hurried == (look.quality != "fine");
}

void FluidUpload::hold(std::shared_ptr<const void> revision, const FluidLookParams& look, bool normals, const FluidView& view) {
    last_ = {.revision = std::move(revision),
             .radiusSpacings = look.radiusSpacings,
             .normals = normals,
             .ellipsoids = look.splats == "ellipsoids",
             .hurried = look.quality != "fine",
             .view = view};
}

// The last view again: nothing is copied.
FluidView FluidUpload::kept(double start) {
    facts_.bytes = 0;
    facts_.waits = ring_.waits();
    facts_.ms = 1000 * (hostSeconds() - start);
    return last_.view;
}

Status FluidUpload::bringDrops(std::span<const vec4> drops, std::span<const vec4> pendants, FluidView& out) {
    out.dropCount = static_cast<uint32_t>(drops.size() / 2);
    if (out.dropCount > 0) {
        if (Status s = makeRoom(drops_, drops.size_bytes()); !s) return s;
        drops_.writeAll(drops);
        out.drops = drops_.name();
    }
    out.pendantCount = static_cast<uint32_t>(pendants.size() / 5);
    if (out.pendantCount > 0) {
        if (Status s = makeRoom(pendants_, pendants.size_bytes()); !s) return s;
        pendants_.writeAll(pendants);
        out.pendants = pendants_.name();
    }
    return ok();
}

Result<FluidView> FluidUpload::view(const FluidWorld& world, const FluidLookParams& look, std::span<const vec4> drops,
                                    std::span<const vec4> pendants) {
    const double start = hostSeconds();
    const ParticleView particles = world.particles();
    Device& device = world.device();
    const bool same = device.backend() == Backend::gl;
    GlShare offered = same ? GlShare{} : device.glShare();
    const bool normals = look.showsNormals() && particles.normal != nullptr;
    const bool loose = !drops.empty() || !pendants.empty();
    if (!same && !loose && offered.by == sharing_ && holds(particles.revision, look, normals)) return kept(start);
    last_ = {};
    if (offered.by != sharing_) follow(std::move(offered.by));
    facts_ = {.way = same ? kSameMemory : kRing, .why = std::move(offered.whyNot), .ms = 0, .bytes = 0, .waits = ring_.waits()};
    FluidView out;
    out.count = particles.count > 0 ? particles.slots : 0;
    if (out.count > 0) {
        out.asleep = particles.asleep;
        out.sleepers = particles.sleepers;
    }
    out.spacing = particles.spacing;
    out.viscosity = particles.viscosity;
    out.radius = look.radiusSpacings * particles.spacing;
    out.bounds.add(world.params().box.min);
    out.bounds.add(world.params().box.max);
    if (Status s = bringDrops(drops, pendants, out); !s) return s.error();
    out.dry = world.bodyRows().current ? world.ownDry() : world.dry();
    out.foamCount = particles.foam != nullptr ? particles.foamSlots : 0;
    // The shader of the points reads normals in place of velocities. Before the first step there are no normals.
    std::vector<Array> arrays;
    const auto wanted = [&](const Buffer* from, Target& to, unsigned& name, bool ofParticles) {
        if (from == nullptr) return;
        if (same)
            name = static_cast<unsigned>(from->handle());
        else
            arrays.push_back({from, {}, &to, &name, sizeof(vec4) * (ofParticles ? out.count : out.foamCount), ofParticles});
    };
    if (out.foamCount > 0) {
        wanted(particles.foamDrawn, foam_[0], out.foam[0], false);
        wanted(particles.foamVelocity, foam_[1], out.foam[1], false);
    }
    if (const WetnessView wet = world.wetness(); wet.surface && !wet.surface->points.empty()) {
        out.wetCellBytes = wet.surface->cells.size() * sizeof(int32_t);
        out.wetnessBytes = wet.surface->points.size() * sizeof(float);
        if (same) {
            out.wetCells = static_cast<unsigned>(wet.cells->handle());
            out.wetness = static_cast<unsigned>(wet.values->handle());
        } else {
            if (Status s = holdWetCells(wet.surface); !s) return s.error();
            out.wetCells = wetCells_.name();
            arrays.push_back({wet.values, {}, &wetness_, &out.wetness, out.wetnessBytes, false});
        }
    }
    if (const BodyRows bodies = world.bodyRows(); bodies.rows != nullptr) {
        if (bodies.current) out.bodiesMoved = particles.revision;
        out.bodyCount = bodies.count;
        if (same)
            out.bodies = static_cast<unsigned>(bodies.rows->handle());
        else if (bodies.current)
            arrays.push_back({bodies.rows, {}, &bodies_, &out.bodies, bodies.count * sizeof(DeviceBody), false});
    }
    if (out.count > 0) {
        wanted(particles.drawn, position_, out.position, true);
        wanted(normals ? particles.normal : particles.velocity, velocity_, out.velocity, true);
        wanted(particles.absorption, absorption_, out.absorption, true);
        for (size_t k = 0; k < kMostAttributes; ++k) wanted(particles.attributes[k], attributes_[k], out.attributes[k], true);
        for (size_t k = 0; look.splats == "ellipsoids" && k < 3; ++k)
            wanted(particles.ellipsoids[k], ellipsoids_[k], out.ellipsoids[k], true);
        if (same) out.id = static_cast<unsigned>(particles.id->handle());
    }
    if (sharing_ && refused_.empty() && !arrays.empty()) {
        std::vector<Array> all = arrays;
        if (out.count > 0) all.push_back({particles.id, {}, &id_, &out.id, sizeof(uint32_t) * out.count, true});
        if (Status s = share(all); !s) return s.error();
    }
    if (sharing_ && refused_.empty()) {
        facts_.way = kSharedWithOpenCl;
    } else if (!arrays.empty()) {
        if (sharing_) facts_.why = refused_;
        const bool hurried = look.quality != "fine";
        ids_.resize(holdsSleepers(arrays, hurried, out) ? out.count - out.asleep : out.count);
        if (!ids_.empty()) device.read(*particles.id, std::as_writable_bytes(std::span(ids_)));
        if (Status s = bringOver(&device, arrays, hurried, out); !s) return s.error();
    }
    facts_.ms = 1000 * (hostSeconds() - start);
    facts_.waits = ring_.waits();
    if (!same && !loose) hold(particles.revision, look, normals, out);
    return out;
}

// The cells never change: they are brought over once.
Status FluidUpload::holdWetCells(std::shared_ptr<const WetSurface> surface) {
    if (surface == wetSurface_) return ok();
    if (const size_t needed = surface->cells.size() * sizeof(int32_t); needed > mostBytes_)
        return failed(fmt::format(
            "the cells of wet surfaces need {} of OpenGL memory, and {} are allowed; allow more, or set fluid.wetness.on to false",
            readableBytes(needed), readableBytes(mostBytes_)));
    if (Status s = rivulet::makeRoom(wetCells_, surface->cells.size() * sizeof(int32_t)); !s) return s;
    wetCells_.writeAll(std::span<const int32_t>(surface->cells));
    wetSurface_ = std::move(surface);
    return ok();
}

// All arrays in one copy, in the Device's order. Error (failed): out of GPU memory. A failure of OpenCL is stored in refused_.
Status FluidUpload::share(std::span<const Array> arrays) {
    std::vector<GlSharing::Copy> copies;
    Status done = ok();
    if (Status fits = room(arrays, 0, false); !fits) return fits;
    held_ = {};
    for (const Array& a : arrays) {
        if (Status room = a.to->makeRoom(a.bytes); !room) return room;
        if (!a.to->seen) {
            Result<GlSharing::Wrapped> seen = sharing_->wrap(a.to->memory.name());
            if (!seen) {
                done = seen.error();
                break;
            }
            a.to->seen = std::move(*seen);
        }
        copies.push_back({a.from, &a.to->seen, a.bytes});
        *a.name = a.to->memory.name();
    }
    if (done) done = sharing_->copy(copies);
    if (done) return ok();
    refused_ = done.error().message;
    dropTargets();  // OpenCL may still hold them
    return ok();
}

Result<FluidView> FluidUpload::view(const RecordedFrame& frame, const FluidLookParams& look) {
    last_ = {};  // the buffers hold another frame from now on
    const double start = hostSeconds();
    facts_ = {.way = "recording", .why = {}, .ms = 0, .bytes = 0, .waits = ring_.waits()};
    FluidView out;
    out.count = static_cast<uint32_t>(frame.position.size());
    out.spacing = frame.spacing;
    out.radius = look.radiusSpacings * frame.spacing;
    out.bounds = frame.box;
    out.dry = frame.dry;
    out.foamCount = static_cast<uint32_t>(frame.foam.size());
    const bool normals = look.showsNormals() && !frame.normal.empty();
    std::vector<Array> arrays;
    const auto wanted = [&](const std::vector<vec4>& from, Target& to, unsigned& name, bool ofParticles) {
        if (!from.empty()) arrays.push_back({nullptr, std::as_bytes(std::span(from)), &to, &name, from.size() * sizeof(vec4), ofParticles});
    };
    wanted(frame.foam, foam_[0], out.foam[0], false);
    wanted(frame.foamVelocity, foam_[1], out.foam[1], false);
    wanted(frame.position, position_, out.position, true);
    wanted(normals ? frame.normal : frame.velocity, velocity_, out.velocity, true);
    wanted(frame.absorption, absorption_, out.absorption, true);
    for (size_t k = 0; k < kMostAttributes; ++k) wanted(frame.attributes[k], attributes_[k], out.attributes[k], true);
    for (size_t k = 0; look.splats == "ellipsoids" && k < 3; ++k) wanted(frame.ellipsoids[k], ellipsoids_[k], out.ellipsoids[k], true);
    ids_ = frame.id;
    if (!arrays.empty())
        if (Status s = bringOver(nullptr, arrays, frame.halves && look.quality != "fine", out); !s) return s.error();
    facts_.ms = 1000 * (hostSeconds() - start);
    facts_.waits = ring_.waits();
    return out;
}

Result<FluidView> FluidUpload::view(const FluidSnapshot& s, const FluidLookParams& look) {
    if (s.empty()) return badInput("the snapshot is empty: take one of a world first");
    const double start = hostSeconds();
    const bool normals = look.showsNormals();
    if (holds(s.revision_, look, normals)) return kept(start);
    last_ = {};
    FluidView out;
    if (s.onGpu_) {
        facts_ = {.way = "copied on the GPU", .why = {}, .ms = 0, .bytes = 0, .waits = ring_.waits()};
        out.count = s.count_;
        out.spacing = s.frame_.spacing;
        out.radius = look.radiusSpacings * out.spacing;
        out.bounds = s.frame_.box;
        out.position = s.position_.name();
        out.velocity = normals && s.normal_.used ? s.normal_.name() : s.velocity_.name();
        out.id = s.id_.name();
        out.absorption = s.absorption_.name();
        for (size_t k = 0; k < kMostAttributes; ++k) out.attributes[k] = s.attributes_[k].name();
        for (size_t k = 0; look.splats == "ellipsoids" && k < 3; ++k) out.ellipsoids[k] = s.ellipsoids_[k].name();
        out.foam = {s.foam_[0].name(), s.foam_[1].name()};
        out.foamCount = s.foamCount_;
    } else {
        Result<FluidView> uploaded = view(s.frame_, look);
        if (!uploaded) return uploaded;
        out = *uploaded;
    }
    out.viscosity = s.viscosity_;
    out.dry = s.frame_.dry;
    if (Status brought = bringDrops(s.drops_, s.pendants_, out); !brought) return brought.error();
    if (!s.wetSurface_) {
        hold(s.revision_, look, normals, out);
        return out;
    }
    if (Status held = holdWetCells(s.wetSurface_); !held) return held.error();
    out.wetCells = wetCells_.name();
    out.wetCellBytes = s.wetSurface_->cells.size() * sizeof(int32_t);
    out.wetnessBytes = s.wetSurface_->points.size() * sizeof(float);
    out.wetness = s.wet_.name();
    if (!s.onGpu_) {
        if (Status room = wetness_.makeRoom(out.wetnessBytes); !room) return room.error();
        wetness_.memory.writeAll(std::span<const float>(s.wetness_));
        out.wetness = wetness_.memory.name();
    }
    hold(s.revision_, look, normals, out);
    return out;
}

bool FluidUpload::holdsSleepers(std::span<const Array> arrays, bool hurried, const FluidView& of) const {
    const auto held = [this](const Array& a) {
        return !a.ofParticles || (a.to->memory.bytes() >= a.bytes && std::find(held_.of.begin(), held_.of.end(), a.to) != held_.of.end());
    };
    return of.sleepers != nullptr && of.sleepers == held_.sleepers && hurried == held_.hurried &&
           std::all_of(arrays.begin(), arrays.end(), held);
}

// Uploads the first ids_.size() particles of `arrays`, and their ids: all particles, or only those awake, which come first. `device` owns
// the buffers; null: they are memory of the host.
Status FluidUpload::bringOver(Device* device, std::span<const Array> arrays, bool hurried, FluidView& out) {
    const auto count = static_cast<uint32_t>(ids_.size());
    const uint32_t awake = out.count - out.asleep;
    const auto bytesOf = [&](const Array& a) { return a.ofParticles ? count * sizeof(vec4) : a.bytes; };
    size_t bytes = 64 + ids_.size() * sizeof(uint32_t);
    for (const Array& a : arrays) bytes += 64 + bytesOf(a);
    if (Status fits = room(arrays, out.count * sizeof(uint32_t), true); !fits) return fits;
    if (Status s = ring_.begin(bytes); !s) return s;
    const struct End {
        gpu::StagingRing& ring;
        ~End() { ring.end(); }  // whatever fails, copies may be under way
    } end{ring_};
    if (count == out.count) held_ = {};
    const auto read = [&](const Array& a, std::span<std::byte> into) {
        if (a.from != nullptr)
            device->read(*a.from, into);
        else
            std::memcpy(into.data(), a.host.data(), into.size());
    };
    // Those of even number first: half of them by place would be another half whenever a particle changes its cell, and still water would
    // flicker.
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0U);
    if (hurried) {
        const auto even = [this](uint32_t i) { return ids_[i] % 2 == 0; };
        const auto asleep = order_.begin() + awake;
        out.half = static_cast<uint32_t>(std::stable_partition(order_.begin(), asleep, even) - order_.begin());
        if (count > awake) held_.half = static_cast<uint32_t>(std::stable_partition(asleep, order_.end(), even) - asleep);
        out.asleepHalf = held_.half;
    }
    // `to` keeps what it holds beyond what is copied.
    const auto bring = [&](std::span<std::byte> from, size_t whole, Target& to, unsigned& name) {
        if (Status room = to.makeRoom(whole); !room) return room;
        if (!from.empty()) ring_.copyTo(to.memory);
        name = to.memory.name();
        facts_.bytes += from.size();
        return ok();
    };
    for (const Array& a : arrays) {
        const std::span<std::byte> into = ring_.take(bytesOf(a));
        if (hurried && a.ofParticles) {
            vectors_.resize(count);
            read(a, std::as_writable_bytes(std::span(vectors_)));
            std::transform(order_.begin(), order_.end(), as<vec4>(into).begin(), [this](uint32_t i) { return vectors_[i]; });
        } else {
            read(a, into);
        }
        if (out.asleep > 0 && a.to == &position_) out.awake = lastDrawn(as<vec4>(into).first(awake));
        if (Status room = bring(into, a.bytes, *a.to, *a.name); !room) return room;
    }
    if (out.count > 0) {
        const std::span<uint32_t> into = as<uint32_t>(ring_.take(ids_.size() * sizeof(uint32_t)));
        std::transform(order_.begin(), order_.end(), into.begin(), [this](uint32_t i) { return ids_[i]; });
        if (Status room = bring(std::as_writable_bytes(into), out.count * sizeof(uint32_t), id_, out.id); !room) return room;
    }
    if (count < out.count) return ok();
    held_.sleepers = out.sleepers;
    held_.hurried = hurried;
    for (const Array& a : arrays)
        if (a.ofParticles) held_.of.push_back(a.to);
    return ok();
}

}  // namespace rivulet
