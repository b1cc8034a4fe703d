#include "fluid/sim/query/volumes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "shaders/fluid/query/volume_params.h"

namespace rivulet {

SinkVolume shapeOf(const Volume& v) {
    if (v.shape == Volume::sphere) return {vec4(v.position, 1.0F), vec4(v.radius, 0.0F, 0.0F, 0.0F)};
    return {vec4(v.position - 0.5F * v.size, 0.0F), vec4(v.position + 0.5F * v.size, 0.0F)};
}

Status checkVolume(const Volume& v, const std::string& what) {
    const bool sound = v.shape == Volume::sphere
                           ? v.radius >= 0 && std::isfinite(v.radius)
                           : v.shape == Volume::box && isFinite(v.size) && glm::all(glm::greaterThanEqual(v.size, vec3(0.0F)));
    if (sound && isFinite(v.position)) return ok();
    return badInput(fmt::format("{} has a position or size that is invalid: use metres, none negative", what));
}

namespace {

Status check(std::span<const Volume> volumes) {
    if (volumes.size() > VolumePasses::kMost)
        return badInput(
            fmt::format("{} volumes are more than the {} that can be watched: watch fewer", volumes.size(), VolumePasses::kMost));
    for (size_t k = 0; k < volumes.size(); ++k) {
        const Volume& v = volumes[k];
        if (Status sound = checkVolume(v, fmt::format("volume {}", v.id)); !sound) return sound;
        for (size_t j = 0; j < k; ++j)
            if (volumes[j].id == v.id) return badInput(fmt::format("two volumes have the id {}: give each its own", v.id));
    }
    return ok();
}

}  // namespace

Status VolumePasses::prepare(Device& device, uint32_t slots) {
    if (device_ != nullptr) return ok();
    Result<Kernel> found = device.kernel("fluid/query/count_volumes");
    if (!found) return found.error();
    Result<Buffer> shapes = device.allocate(kMost * sizeof(SinkVolume)), inside = device.allocate(size_t{slots} * sizeof(uint32_t)),
                   counters = device.allocate(2 * kMost * sizeof(uint32_t));
    for (const Result<Buffer>* b : {&shapes, &inside, &counters})
        if (!*b) return b->error();
    count_ = *found;
    shapes_ = std::move(*shapes);
    inside_ = std::move(*inside);
    counters_ = std::move(*counters);
    slots_ = slots;
    device_ = &device;
    return ok();
}

void VolumePasses::write() {
    // A bit of no volume: a box in which no particle is.
    std::vector<SinkVolume> shapes(kMost, {vec4(1.0F, 1.0F, 1.0F, 0.0F), vec4(0.0F)});
    for (size_t k = 0; k < volumes_.size(); ++k) shapes[bits_[k]] = shapeOf(volumes_[k]);
    device_->writeAll<SinkVolume>(shapes_, shapes);
}

Status VolumePasses::set(Device& device, std::span<const Volume> volumes, uint32_t slots, double particle) {
    if (Status s = check(volumes); !s) return s;
    if (device_ == nullptr && volumes.empty()) return ok();
    if (Status s = prepare(device, slots); !s) return s;
    constexpr uint32_t kNone = kMost;
    std::vector<uint32_t> bits(volumes.size(), kNone);
    uint32_t used = 0;
    for (size_t k = 0; k < volumes.size(); ++k)
        for (size_t j = 0; j < volumes_.size(); ++j)
            if (volumes_[j].id == volumes[k].id) {
                bits[k] = bits_[j];
                used |= 1U << bits_[j];
            }
    for (uint32_t b = 0; b < kMost; ++b)
        if ((used >> b & 1U) == 0) (*rows_)[b] = {};
    keep_ &= used;
    for (size_t k = 0; k < volumes.size(); ++k) {
        if (bits[k] != kNone) continue;
        bits[k] = static_cast<uint32_t>(std::countr_one(used));
        used |= 1U << bits[k];
        Row& row = (*rows_)[bits[k]];
        row.count.id = volumes[k].id;
        row.count.particle = particle;
        row.serial = ++serial_;
        const uint32_t none[2] = {0, 0};
        device.write(counters_, std::as_bytes(std::span(none)), bits[k] * sizeof none);
    }
    volumes_.assign(volumes.begin(), volumes.end());
    bits_ = std::move(bits);
    write();
    return ok();
}

void VolumePasses::count(const StepParams& step, const Particles& particles, double time) {
    if (volumes_.empty()) return;
    VolumeParams block{};
    block.step = step;
    block.count = *std::max_element(bits_.begin(), bits_.end()) + 1;
    block.keep = std::exchange(keep_, ~0U);
    device_->run(count_, block, {&particles.id, &particles.positionNext, &shapes_, &inside_, &counters_}, particles.count);
    std::array<uint64_t, kMost> serials{};
    for (size_t b = 0; b < kMost; ++b) serials[b] = (*rows_)[b].serial;
    device_->readLater(counters_, counters_.bytes(), [serials, time, weak = std::weak_ptr(rows_)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Rows> rows = weak.lock();
        if (!rows) return;  // the world is no more
        const auto* words = reinterpret_cast<const uint32_t*>(bytes.data());
        for (size_t b = 0; b < kMost; ++b) {
            Row& row = (*rows)[b];
            if (row.serial == 0 || row.serial != serials[b]) continue;
            row.count.entered += words[2 * b] - row.lastEntered;
            row.count.left += words[2 * b + 1] - row.lastLeft;
            row.count.inside = row.count.entered - row.count.left;
            row.count.time = time;
            row.lastEntered = words[2 * b];
            row.lastLeft = words[2 * b + 1];
        }
    });
}

std::vector<VolumeCount> VolumePasses::counts() const {
    std::vector<VolumeCount> all;
    all.reserve(bits_.size());
    for (const uint32_t b : bits_) all.push_back((*rows_)[b].count);
    return all;
}

std::vector<VolumeCount> VolumePasses::takeEvents() {
    std::vector<VolumeCount> events;
    for (const uint32_t b : bits_) {
        Row& row = (*rows_)[b];
        if (row.count.entered == row.entered && row.count.left == row.left) continue;
        VolumeCount event = row.count;
        event.entered -= std::exchange(row.entered, row.count.entered);
        event.left -= std::exchange(row.left, row.count.left);
        events.push_back(event);
    }
    return events;
}

void VolumePasses::reset() {
    if (device_ == nullptr) return;
    for (Row& row : *rows_) {
        if (row.serial == 0) continue;
        const VolumeCount was = row.count;
        row = {};
        row.count.id = was.id;
        row.count.particle = was.particle;
        row.serial = ++serial_;
    }
    device_->fill(inside_, 0);
    device_->fill(counters_, 0);
    keep_ = ~0U;
}

void VolumePasses::save(WorldState& state) const {
    if (volumes_.empty()) return;
    std::vector<uint64_t> numbers;
    std::vector<double> times;
    for (const uint32_t b : bits_) {
        const Row& row = (*rows_)[b];
        numbers.insert(numbers.end(), {b, row.count.entered, row.count.left, row.entered, row.left});
        times.push_back(row.count.time);
    }
    std::vector<uint32_t> inside = device_->readAll<uint32_t>(inside_, slots_);
    for (uint32_t& bits : inside) bits &= keep_;
    state.put<Volume>("volumes.shapes", volumes_);
    state.put<uint64_t>("volumes.numbers", numbers);
    state.put<double>("volumes.times", times);
    state.put<uint32_t>("volumes.inside", inside);
}

Result<VolumePasses::Saved> VolumePasses::take(WorldState& state, uint32_t slots) {
    Saved saved;
    const auto shapes = state.sections().find("volumes.shapes");
    if (shapes == state.sections().end()) return saved;
    const size_t count = std::min(shapes->second.size() / sizeof(Volume), kMost + 1);
    Result<std::vector<Volume>> volumes = state.take<Volume>("volumes.shapes", count);
    if (!volumes) return volumes.error();
    Result<std::vector<uint64_t>> numbers = state.take<uint64_t>("volumes.numbers", 5 * count);
    if (!numbers) return numbers.error();
    Result<std::vector<double>> times = state.take<double>("volumes.times", count);
    if (!times) return times.error();
    Result<std::vector<uint32_t>> inside = state.take<uint32_t>("volumes.inside", slots);
    if (!inside) return inside.error();
    saved = {std::move(*volumes), std::move(*numbers), std::move(*times), std::move(*inside)};
    if (Status s = check(saved.volumes); !s) return badInput("section volumes.shapes of the saved state is invalid: " + s.error().message);
    uint32_t used = 0;
    bool sound = true;
    for (size_t k = 0; k < count && sound; ++k) {
        const uint64_t* n = &saved.numbers[5 * k];
        sound = n[0] < kMost && (used >> n[0] & 1U) == 0 && n[3] <= n[1] && n[4] <= n[2] && std::isfinite(saved.times[k]);
        if (!sound) break;
        used |= 1U << n[0];
        const auto in = std::count_if(saved.inside.begin(), saved.inside.end(), [n](uint32_t bits) { return (bits >> n[0] & 1U) != 0; });
        sound = n[1] - n[2] == static_cast<uint64_t>(in);
    }
    if (!sound) return badInput("sections volumes.numbers, times and inside of the saved state do not add up: save it again");
    return saved;
}

void VolumePasses::restore(Device& device, const Saved& saved, double particle) {
    if (saved.volumes.empty()) return;
    *rows_ = {};
    volumes_ = saved.volumes;
    bits_.clear();
    for (size_t k = 0; k < volumes_.size(); ++k) {
        const uint64_t* n = &saved.numbers[5 * k];
        bits_.push_back(static_cast<uint32_t>(n[0]));
        Row& row = (*rows_)[n[0]];
        row.count = {volumes_[k].id, n[1], n[2], n[1] - n[2], saved.times[k], particle};
        row.entered = n[3];
        row.left = n[4];
        row.serial = ++serial_;
    }
    device.fill(counters_, 0);
    device.writeAll<uint32_t>(inside_, saved.inside);
    keep_ = ~0U;
    write();
}

}  // namespace rivulet
