#include "fluid/sim/sources/exchange_passes.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "engine/core/assert.h"

namespace rivulet {

namespace {

// Of as many particles as there are `positions`; w is the density ratio.
std::vector<WorldParticle> listed(std::span<const vec4> positions, std::span<const vec4> velocities, std::span<const uint32_t> slots,
                                  std::span<const uint32_t> ids) {
    std::vector<WorldParticle> all;
    all.reserve(positions.size());
    for (size_t k = 0; k < positions.size(); ++k)
        all.push_back({vec3(positions[k]), vec3(velocities[k]), positions[k].w, slots[k], ids[k]});
    // The atomic has them in any order.
    std::sort(all.begin(), all.end(), [](const WorldParticle& a, const WorldParticle& b) { return a.slot < b.slot; });
    return all;
}

template <class T>
std::span<const T> as(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

Result<ExchangePasses> ExchangePasses::create(Device& device) {
    ExchangePasses e;
    e.device_ = &device;
    for (auto [kernel, path] : {std::pair(&e.within_, "fluid/sources/within"), std::pair(&e.take_, "fluid/sources/take"),
                                std::pair(&e.forget_, "fluid/sources/forget"), std::pair(&e.claim_, "fluid/sources/claim")}) {
        Result<Kernel> found = device.kernel(path);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (auto [buffer, bytes] : {std::pair(&e.counter_, sizeof(uint32_t)), std::pair(&e.found_, 2 * kMost * sizeof(vec4)),
                                 std::pair(&e.slots_, 2 * kMost * sizeof(uint32_t)), std::pair(&e.claimed_, kMost * sizeof(uint32_t)),
                                 std::pair(&e.expected_, kMost * sizeof(vec4)), std::pair(&e.removed_, kMost * sizeof(uint32_t))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return e;
}

void ExchangePasses::list(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser, size_t most) {
    ExchangeParams block{};
    block.step = step;
    block.step.count = particles.count;
    block.low = vec4(box.min, 0.0F);
    block.high = vec4(box.max, 0.0F);
    block.most = static_cast<uint32_t>(most);
    block.faster = faster;
    block.looser = looser;
    device_->fill(counter_, 0);
    device_->run(within_, block, {&particles.positionNext, &particles.velocityNext, &particles.id, &counter_, &found_, &slots_},
                 particles.count);
}

std::vector<WorldParticle> ExchangePasses::within(const StepParams& step, const Particles& particles, const Bounds& box, float faster,
                                                  float looser) {
    if (box.empty()) return {};
    list(step, particles, box, faster, looser, kMost);
    const size_t count = std::min<size_t>(device_->readAll<uint32_t>(counter_, 1)[0], kMost);
    if (count == 0) return {};
    const std::vector<vec4> found = device_->readAll<vec4>(found_, kMost + count);
    const std::vector<uint32_t> slots = device_->readAll<uint32_t>(slots_, kMost + count);
    return listed(std::span(found).first(count), std::span(found).subspan(kMost), slots, std::span(slots).subspan(kMost));
}

// Reads arrive in the order of their requests.
void ExchangePasses::withinLater(const StepParams& step, const Particles& particles, const Bounds& box, float faster, float looser,
                                 std::function<void(std::span<const WorldParticle>)> then) {
    if (box.empty()) {
        then({});
        return;
    }
    struct Answer {
        size_t count = 0;
        std::vector<vec4> positions, velocities;
    };
    const auto answer = std::make_shared<Answer>();
    list(step, particles, box, faster, looser, kMost);
    device_->readLater(counter_, sizeof(uint32_t),
                       [answer](std::span<const std::byte> bytes) { answer->count = std::min<size_t>(as<uint32_t>(bytes)[0], kMost); });
    device_->readLater(found_, 2 * kMost * sizeof(vec4), [answer](std::span<const std::byte> bytes) {
        const std::span<const vec4> found = as<vec4>(bytes), moving = found.subspan(kMost);
        answer->positions.assign(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(answer->count));
        answer->velocities.assign(moving.begin(), moving.begin() + static_cast<std::ptrdiff_t>(answer->count));
    });
    device_->readLater(slots_, 2 * kMost * sizeof(uint32_t), [answer, then = std::move(then)](std::span<const std::byte> bytes) {
        then(listed(answer->positions, answer->velocities, as<uint32_t>(bytes), as<uint32_t>(bytes).subspan(kMost)));
    });
}

void ExchangePasses::claim(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
                           std::span<const ParticleClaim> claims, bool sorted, std::function<void(std::span<const uint32_t>)> then) {
    ASSERT(claims.size() <= kMost, "no more claims than kMost");
    std::vector<uint32_t> ids;
    std::vector<vec4> expected;
    ids.reserve(claims.size());
    expected.reserve(claims.size());
    for (const ParticleClaim& c : claims) {
        ASSERT(ids.empty() || ids.back() < c.id, "claims are in the order of ids, each once");
        ids.push_back(c.id);
        expected.emplace_back(c.position, c.within);
    }
    device_->writeAll<uint32_t>(claimed_, ids);
    device_->writeAll<vec4>(expected_, expected);
    device_->fill(removed_, 0);
    ExchangeParams block{};
    block.step = step;
    block.step.count = particles.count;
    block.count = static_cast<uint32_t>(claims.size());
    device_->run(claim_, block, {&claimed_, &expected_, &particles.id, &particles.positionNext, &particles.velocityNext, &removed_},
                 particles.count);
    forget(step, grid, particles, remembered, sorted);
    device_->readLater(removed_, claims.size() * sizeof(uint32_t),
                       [then = std::move(then)](std::span<const std::byte> bytes) { then(as<uint32_t>(bytes)); });
}

void ExchangePasses::forget(const StepParams& step, const NeighborGrid& grid, Particles& particles, std::span<const NamedBuffer> remembered,
                            bool sorted) {
    // Before the first sort no method has stored anything per particle.
    for (const NamedBuffer& b : remembered)
        if (b.byId && sorted)
            device_->run(forget_, step, {&grid.cellStart(), &particles.positionNext, &particles.id, b.buffer}, particles.count);
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
    forget(step, grid, particles, remembered, sorted);
}

Bounds ExchangePasses::taken(size_t count) {
    Bounds box;
    for (const vec4& place : device_->readAll<vec4>(found_, count)) box.add(vec3(place));
    return box;
}

}  // namespace rivulet
