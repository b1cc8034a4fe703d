#include "fluid/sim/surface/foam_passes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/world/state_check.h"

namespace rivulet {

namespace {

// Density ratios between which foam lies on water: below it flies, above it is a bubble. Ihmsen et al. count 6 and 20 neighbours of 30.
constexpr float kSprayBelow = 0.2F, kBubbleAbove = 0.7F;
constexpr float kSprayDrag = 0.15F;  // 1/m: of a drop of 3 mm
// Up to this share of its slots foam is spawned in full; from there on less, so that none is removed before its time.
constexpr float kRoomy = 0.7F;

// Sums over a cubic lattice without its middle: of 1 - r/h, and over its half y > 0 of y times what slope() is.
struct LatticeSums {
    double hat = 0, flat = 0;
};
LatticeSums latticeSums(double support) {
    LatticeSums sums;
    const int n = static_cast<int>(std::ceil(support));
    for (int z = -n; z <= n; ++z)
        for (int y = -n; y <= n; ++y)
            for (int x = -n; x <= n; ++x) {
                const double r = std::sqrt(double(x * x + y * y + z * z));
                if (r == 0 || r >= support) continue;
                sums.hat += 1 - r / support;
                if (y > 0) sums.flat += y * std::pow(support - r, 3);
            }
    return sums;
}

}  // namespace

Result<FoamPasses> FoamPasses::create(Device& device, const FluidParams& params, const PairTraits& traits, uint32_t particles) {
    FoamPasses f;
    f.device_ = &device;
    f.slots_ = static_cast<uint32_t>(params.foam.most);
    const double support = double{params.supportSpacings};
    const LatticeSums sums = latticeSums(support);
    f.hat_ = static_cast<float>(1 / sums.hat);
    f.flat_ = static_cast<float>(-1 / (sums.flat * std::pow(double{params.spacing}, 4)));
    f.fullness_ = static_cast<float>(21.0 / (2.0 * std::numbers::pi * support * support * support) / wendlandLatticeSum(support));
    for (auto [kernel, path] : {std::pair(&f.air_, "fluid/surface/foam_air"), std::pair(&f.crest_, "fluid/surface/foam_crest")}) {
        Result<PairKernel> found = PairKernel::find(device, path, traits);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (auto [kernel, path] : {std::pair(&f.move_, "fluid/surface/foam_move"), std::pair(&f.wanted_, "fluid/surface/foam_wanted"),
                                std::pair(&f.spawn_, "fluid/surface/foam_born"), std::pair(&f.back_, "fluid/surface/foam_drawn")}) {
        Result<Kernel> found = device.kernel(path);
        if (!found) return found.error();
        *kernel = *found;
    }
    for (auto [buffer, bytes] :
         {std::pair(&f.airs_, size_t{particles} * sizeof(vec4)), std::pair(&f.births_, size_t{particles} * sizeof(float)),
          std::pair(&f.before_, size_t{f.slots_} * sizeof(vec4)), std::pair(&f.foam_, size_t{f.slots_} * sizeof(vec4)),
          std::pair(&f.velocity_, size_t{f.slots_} * sizeof(vec4)),
          std::pair(&f.lists_, (size_t{f.slots_} + FOAM_LISTS) * sizeof(uint32_t)), std::pair(&f.most_, sizeof(uint32_t))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    device.fill(f.most_, f.slots_);
    device.fill(f.airs_, 0);  // no pass writes that of samples on bodies
    return f;
}

void FoamPasses::reset() {
    device_->fill(foam_, 0);
    counts_ = std::make_shared<Counts>();
    frame_ = 0;
    drawNewest();
}

void FoamPasses::run(const FluidParams& fluid, const StepParams& step, NeighborGrid& grid, const Particles& particles, SolidPasses& solids,
                     double seconds) {
    const FoamParams& p = fluid.foam;
    ++frame_;
    FoamStep f{};
    f.step = step;
    f.wind = vec4(fluid.forces.wind, kSprayDrag);
    f.slots = slots_;
    f.seed = frame_;
    f.seconds = static_cast<float>(seconds);
    const float used = static_cast<float>(counts_->alive) / static_cast<float>(std::max(slots_, 1U));
    f.births = std::clamp((1 - used) / (1 - kRoomy), 0.0F, 1.0F);
    f.life = p.life;
    f.buoyancy = p.buoyancy;
    f.drag = p.drag;
    f.fullness = fullness_;
    f.sprayBelow = kSprayBelow;
    f.bubbleAbove = kBubbleAbove;
    const Buffer *position = &particles.positionNext, *velocity = &particles.velocityNext;
    device_->fill(lists_, 0);
    device_->run(move_, f, {&grid.cellStart(), position, velocity, &before_, &foam_, &velocity_, &lists_}, slots_);
    const SolidPasses::Movers flecks{&before_, &foam_, &velocity_, &most_, 0, slots_};
    if (solids.moving()) {
        solids.keepOut(step, flecks, seconds);
        device_->copy(foam_, before_, size_t{slots_} * sizeof(vec4));  // their way is done
    }
    const uint32_t threads = grid.pairThreads();
    if (step.asleepSets > 0) device_->fill(airs_, 0);  // sleeping water has none
    StepParams air = step;
    air.force = vec4(flat_, hat_, 0.0F, 0.0F);
    air_.run(*device_, particles, air, {&grid.neighbors(), position, velocity, &airs_}, threads);
    StepParams crest = step;
    crest.force = air.force;
    crest.gravity = vec4(p.airFrom, p.airTo, p.crestFrom, p.crestTo);
    crest.boxMin = vec4(p.trappedAir, p.waveCrest, p.speedFrom, p.speedTo);
    device_->fill(births_, 0);
    crest_.run(*device_, particles, crest, {&grid.neighbors(), position, velocity, &airs_, &births_}, threads);
    device_->run(wanted_, f, {&particles.id, position, &births_, &lists_}, particles.count);
    device_->run(spawn_, f, {&particles.id, position, velocity, &births_, &lists_, &before_, &foam_, &velocity_}, particles.count);
    // New foam starts where its particle is now: solids keep it out where they are now, not along their way in the frame.
    solids.keepOut(step, flecks, 0);
    device_->readLater(lists_, FOAM_LISTS * sizeof(uint32_t), [counts = std::weak_ptr(counts_)](std::span<const std::byte> bytes) {
        const std::shared_ptr<Counts> t = counts.lock();
        if (!t) return;  // begun anew meanwhile
        const auto* words = reinterpret_cast<const uint32_t*>(bytes.data());
        const uint32_t spawned = std::min(words[1], words[3]);
        t->alive = words[0] + spawned;
    });
}

Status FoamPasses::prepareDrawn() {
    if (drawn_) return ok();
    Result<Buffer> made = device_->allocate(size_t{slots_} * sizeof(vec4));
    if (!made) return made.error();
    drawn_ = std::move(*made);
    return ok();
}

void FoamPasses::drawEarlier(double seconds) {
    FoamStep f{};
    f.slots = slots_;
    f.seconds = static_cast<float>(seconds);
    device_->run(back_, f, {&foam_, &velocity_, &drawn_}, slots_);
    earlier_ = true;
}

void FoamPasses::save(WorldState& state) const {
    state.put<vec4>("foam.slots", device_->readAll<vec4>(foam_, slots_));
    state.put<vec4>("foam.velocity", device_->readAll<vec4>(velocity_, slots_));
    const uint32_t numbers[] = {counts_->alive, frame_};
    state.put<uint32_t>("foam.numbers", numbers);
}

Result<FoamPasses::Saved> FoamPasses::take(WorldState& state) const {
    Result<std::vector<vec4>> foam = state.take<vec4>("foam.slots", slots_);
    if (!foam) return foam.error();
    Result<std::vector<vec4>> velocity = state.take<vec4>("foam.velocity", slots_);
    if (!velocity) return velocity.error();
    Result<std::vector<uint32_t>> numbers = state.take<uint32_t>("foam.numbers", 2);
    if (!numbers) return numbers.error();
    if (Status sound = checkRange("foam.slots", *foam, kMostDistance, -kLatest, kLatest); !sound) return sound.error();
    if (Status sound = checkRange("foam.velocity", *velocity, kMostSpeed, 0, 4); !sound) return sound.error();
    if ((*numbers)[0] > slots_) return outOfRange("foam.numbers", 0, static_cast<double>((*numbers)[0]), 0, static_cast<double>(slots_));
    return Saved{std::move(*foam), std::move(*velocity), (*numbers)[0], (*numbers)[1]};
}

void FoamPasses::restore(const Saved& saved) {
    reset();
    device_->writeAll<vec4>(foam_, std::span<const vec4>(saved.foam));
    device_->writeAll<vec4>(velocity_, std::span<const vec4>(saved.velocity));
    counts_->alive = saved.alive;
    frame_ = saved.frame;
}

}  // namespace rivulet
