#include "fluid/sim/sleep/sleep_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/state_check.h"

namespace rivulet {

namespace {
constexpr float kAlone = 5;   // way of one particle that disturbs a cell, over the rms way of all that does
constexpr float kMeanOf = 3;  // the mean of a pressure forgets within this share of the time for which water must be calm
// rms deviation of pressures from their mean that disturbs a cell, over density g h. Water that has settled is under 0.5 (wcsph, 10 h
// deep).
constexpr double kPressure = 1;
}  // namespace

Result<SleepPasses> SleepPasses::create(Device& device, const StepParams& step, uint32_t count, const AsleepValues& values) {
    SleepPasses s;
    s.device_ = &device;
    s.count_ = count;
    s.cells_ = static_cast<uint32_t>(step.cellsX) * static_cast<uint32_t>(step.cellsY) * static_cast<uint32_t>(step.cellsZ);
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines = {};
    };
    for (const Wanted& w :
         {Wanted{&s.watch_, "fluid/sleep/sleep_watch"}, Wanted{&s.note_, "fluid/sleep/sleep_note"},
          Wanted{&s.disturb_, "fluid/sleep/sleep_disturb"}, Wanted{&s.turn_, "fluid/sleep/sleep_turn"},
          Wanted{&s.apply_, "fluid/sleep/sleep_apply"}, Wanted{&s.keep_, "fluid/sleep/sleep_keep"},
          Wanted{&s.recall_, "fluid/sleep/sleep_recall"}, Wanted{&s.recallPressure_, "fluid/sleep/sleep_recall", {{"PRESSURE", "1"}}},
          Wanted{&s.recallZero_, "fluid/sleep/sleep_recall", {{"ZERO", "1"}}}, Wanted{&s.drawn_, "fluid/sleep/sleep_drawn"}}) {
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    for (const AsleepValue& value : values.others) s.kept_.push_back({value, {}});
    std::vector<std::pair<Buffer*, size_t>> wanted = {{&s.disturbed_, s.cells_ * sizeof(float)},
                                                      {&s.asleep_, s.cells_ * sizeof(float)},
                                                      {&s.changed_, sizeof(vec4)},
                                                      {&s.noted_, size_t{count} * sizeof(vec4)}};
    for (Kept& k : s.kept_)
        if (k.value.from != nullptr) wanted.emplace_back(&k.byId, size_t{count} * sizeof(float));
    for (auto [buffer, bytes] : wanted) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return s;
}

SleepStep SleepPasses::block(const StepParams& step, double now) const {
    SleepStep s{};
    s.step = step;
    s.step.count = count_;
    s.now = static_cast<float>(now);
    s.cells = cells_;
    return s;
}

void SleepPasses::disturb(const StepParams& step, const Bounds& box, double now) {
    SleepStep s = block(step, now);
    s.wakeMin = vec4(box.min, 0.0F);
    s.wakeMax = vec4(box.max, 0.0F);
    device_->run(disturb_, s, {&disturbed_}, cells_);
}

void SleepPasses::disturbAll(double now) { device_->fill(disturbed_, std::bit_cast<uint32_t>(static_cast<float>(now))); }

void SleepPasses::reset(double now) {
    disturbAll(now);
    device_->fill(asleep_, 0);
    since_ = -1;
    poses_.clear();
}

void SleepPasses::run(const FluidParams& fluid, const StepParams& step, float gravity, NeighborGrid& grid, Particles& particles, double now,
                      const AsleepPressure& pressure) {
    SleepStep s = block(step, now);
    const double pull = double{gravity} * double{step.h};
    if (!(pull > 0)) disturbAll(now);  // nothing holds it where it is
    const double time = pull > 0 ? double{fluid.sleep.after} * std::sqrt(double{step.h} / double{gravity}) : 1.0e30;
    const double way = pull > 0 ? double{fluid.sleep.speed} * std::sqrt(pull) * time : 0;
    s.calmFor = static_cast<float>(time);
    s.together2 = static_cast<float>(way * way);
    s.alone2 = kAlone * kAlone * s.together2;
    s.pressure2 = static_cast<float>(kPressure * kPressure * pull * pull);
    s.share = std::min(kMeanOf * step.dt / s.calmFor, 1.0F);
    s.scale = pressure.scale;
    const bool first = since_ < 0;
    s.mayRest = !first && pull > 0 && now - since_ >= time ? 1 : 0;
    const bool cpu = device_->backend() == Backend::cpu;
    const uint32_t slots = step.awakeSlots;
    device_->fill(changed_, 0);
    if (!first)
        device_->run(watch_, s, {&grid.cellStart(), &particles.id, &particles.positionNext, pressure.from, &noted_, &disturbed_}, cells_);
    device_->run(turn_, s, {&grid.cellStart(), &disturbed_, &asleep_, &changed_}, cells_);
    if (first || s.mayRest > 0) {
        device_->run(note_, s, {&grid.cellStart(), &particles.id, &particles.positionNext, &noted_}, slots);
        since_ = now;
    }
    const bool turned = !cpu || *hostPointer<uint32_t>(changed_) != 0;
    if (turned) device_->run(apply_, s, {&grid.cellStart(), &particles.positionNext, &particles.velocityNext, &asleep_, &changed_}, count_);
    if (!turned) return;
    for (const Kept& k : kept_)
        if (k.value.from != nullptr)
            device_->run(keep_, s, {&grid.cellStart(), &particles.id, &particles.velocityNext, k.value.from, &k.byId, &changed_}, slots);
    grid.sortAsleep();
}

void SleepPasses::recall(const StepParams& step, const NeighborGrid& grid, const Particles& particles, const AsleepPressure& pressure) {
    SleepStep s = block(step, 0);
    s.scale = pressure.back;
    resorted_ = true;
    const uint32_t threads = device_->backend() == Backend::cpu ? count_ - grid.awakeSlots() : count_;
    device_->run(recallPressure_, s, {&grid.cellStart(), &particles.id, &noted_, pressure.to, &changed_}, threads);
    for (const Kept& k : kept_) {
        const bool zero = k.value.from == nullptr;
        device_->run(zero ? recallZero_ : recall_, s,
                     {&grid.cellStart(), &particles.id, zero ? k.value.to : &k.byId, k.value.to, &changed_}, threads);
    }
}

Status SleepPasses::prepareEllipsoids() {
    for (Buffer& of : ellipsoids_) {
        if (of) continue;
        Result<Buffer> made = device_->allocate(size_t{count_} * sizeof(vec4));
        if (!made) return made.error();
        of = std::move(*made);
    }
    return ok();
}

void SleepPasses::keepEllipsoids(const StepParams& step, const NeighborGrid& grid, const Particles& particles,
                                 const std::array<const Buffer*, 3>& ellipsoids, double now) {
    if (!ellipsoids_[2]) return;
    if (!std::exchange(holdsEllipsoids_, true)) disturbAll(now);
    const bool all = std::exchange(resorted_, false) || device_->backend() != Backend::cpu;
    for (size_t k = 0; k < ellipsoids.size(); ++k)
        if (ellipsoids[k] != nullptr)
            device_->run(drawn_, block(step, 0), {&grid.cellStart(), &particles.id, ellipsoids[k], &ellipsoids_[k]},
                         all ? count_ : grid.awakeSlots());
}

std::vector<std::pair<std::string, Buffer*>> SleepPasses::remembered() {
    std::vector<std::pair<std::string, Buffer*>> all = {
        {"sleep.disturbed", &disturbed_}, {"sleep.asleep", &asleep_}, {"sleep.noted", &noted_}};
    for (Kept& k : kept_)
        if (k.value.from != nullptr) all.emplace_back("sleep.kept" + std::to_string(all.size() - 3), &k.byId);
    return all;
}

void SleepPasses::save(WorldState& state) {
    state.put<double>("sleep.since", std::span(&since_, 1));
    if (!poses_.empty()) state.put<Pose>("sleep.poses", poses_);
    for (const auto& [name, buffer] : remembered())
        state.put<float>(name, device_->readAll<float>(*buffer, buffer->bytes() / sizeof(float)));
    if (!holdsEllipsoids_) return;
    for (size_t k = 0; k < ellipsoids_.size(); ++k)
        state.put<vec4>("sleep.ellipsoids" + std::to_string(k), device_->readAll<vec4>(ellipsoids_[k], count_));
}

Result<SleepPasses::Saved> SleepPasses::take(WorldState& state, size_t bodies) {
    Saved saved;
    Result<std::vector<double>> since = state.take<double>("sleep.since", 1);
    if (!since) return since.error();
    saved.since = (*since)[0];
    if (Status sound = checkRange("sleep.since", *since, -1, double{kLatest}); !sound) return sound.error();
    if (state.sections().contains("sleep.poses")) {
        Result<std::vector<Pose>> poses = state.take<Pose>("sleep.poses", bodies);
        if (!poses) return poses.error();
        for (size_t k = 0; k < poses->size(); ++k)
            if (!isSound((*poses)[k]))
                return badInput(fmt::format("section sleep.poses of the saved state has an invalid pose of body {}: save it again", k));
        saved.poses = std::move(*poses);
    }
    for (const auto& [name, buffer] : remembered()) {
        Result<std::vector<float>> values = state.take<float>(name, buffer->bytes() / sizeof(float));
        if (!values) return values.error();
        if (Status sound = checkRange(name, *values, -kHighestPressure, kHighestPressure); !sound) return sound.error();
        saved.values.push_back(std::move(*values));
    }
    const bool drawn = state.sections().contains("sleep.ellipsoids0");
    for (size_t k = 0; drawn && k < ellipsoids_.size(); ++k) {
        Result<std::vector<vec4>> values = state.take<vec4>("sleep.ellipsoids" + std::to_string(k), count_);
        if (!values) return values.error();
        // Drawn only; those of particles that are awake are found anew.
        for (vec4& v : *values)
            if (!isWithin(vec3(v), kMostDistance) || !(std::abs(v.w) <= kMostDistance)) v = vec4(0.0F);
        saved.ellipsoids.push_back(std::move(*values));
    }
    return saved;
}

void SleepPasses::restore(const Saved& saved) {
    since_ = saved.since;
    poses_ = saved.poses;
    const auto buffers = remembered();
    for (size_t k = 0; k < buffers.size(); ++k) device_->writeAll<float>(*buffers[k].second, saved.values[k]);
    holdsEllipsoids_ = !saved.ellipsoids.empty() && prepareEllipsoids();  // else the water wakes when it is drawn, and they are found again
    for (size_t k = 0; holdsEllipsoids_ && k < ellipsoids_.size(); ++k) device_->writeAll<vec4>(ellipsoids_[k], saved.ellipsoids[k]);
    resorted_ = true;
    slotsChange();
}

}  // namespace rivulet
