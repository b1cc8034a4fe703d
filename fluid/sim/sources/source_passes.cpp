#include "fluid/sim/sources/source_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/core/assert.h"
#include "engine/core/param_check.h"
#include "engine/core/param_path.h"
#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/sources/attributes.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/state_check.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {

namespace {

constexpr uint32_t kMostCandidates = 16384;  // at once
constexpr float kNearest = 0.8F;             // spacings
// Largest density ratio of a new particle and its neighbours: beyond it the pressure would push them apart strongly.
constexpr float kCrowded = 1.01F;

Status check(const Sources& sources, float spacing, std::span<const AttributeParams> attributes) {
    for (size_t k = 0; k < sources.sinks.size(); ++k)
        if (Status s = checkParams(pathOf("sinks", k), sources.sinks[k]); !s) return s;
    if (!(sources.seconds >= 0) || !(sources.expectedDeposit >= 0) || !(sources.more >= 0))
        return badInput(fmt::format("Sources::seconds is {} s, expectedDeposit {} m^3 and more {} m^3: each must be 0 or more",
                                    sources.seconds, sources.expectedDeposit, sources.more));
    for (size_t k = 0; k < sources.emitters.size(); ++k) {
        const Emitter& e = sources.emitters[k];
        if (Status s = checkParams(pathOf("emitters", k), e.params); !s) return s;
        if (!std::all_of(e.triangles.begin(), e.triangles.end(), [](const vec3& p) { return isFinite(p); }))
            return badInput(fmt::format("the mesh of emitters[{}] has coordinates that are NaN or infinite: correct them", k));
        if (Status s = checkAttributes(attributes, e.params.attributes, fmt::format("emitters[{}]", k)); !s) return s;
        if (const std::string wrong = contradiction(e.params); !wrong.empty()) return badInput(fmt::format("emitters[{}].{}", k, wrong));
        // They are laid out as one layer, and that would take all the memory there is.
        if (const double layer = layerOf(e.params, spacing); layer > kMostCandidates)
            return badInput(
                fmt::format("emitters[{}] needs {:.3g} particles in one layer of its jet, more than {}: use a smaller radius, a higher "
                            "speed or a lower rate",
                            k, layer, kMostCandidates));
        if (!e.params.liquid.empty() && liquids().find(e.params.liquid) == nullptr)
            return badInput(fmt::format("emitters[{}].liquid '{}' is not a liquid; there are {}", k, e.params.liquid,
                                        fmt::join(liquids().names(), ", ")));
    }
    return ok();
}

}  // namespace

Result<SourcePasses> SourcePasses::create(Device& device, const Sources& sources, const FluidParams& params, bool matter, bool absorption) {
    if (Status s = check(sources, params.spacing, params.attributes); !s) return s.error();
    for (size_t k = 0; k < sources.emitters.size(); ++k)
        if (sources.emitters[k].params.shape == "mesh" && sources.emitters[k].triangles.size() < 3)
            return badInput(fmt::format("the mesh of emitters[{}] has no triangles: use another mesh", k));
    SourcePasses s;
    s.device_ = &device;
    s.matter_ = matter;
    s.absorption_ = absorption;
    s.spacing_ = params.spacing;
    s.attributes_ = params.attributes;
    for (size_t k = 0; k < sources.emitters.size(); ++k) {
        const EmitterParams& e = sources.emitters[k].params;
        const LiquidOf liquid = liquidOf(params, e.liquid);
        EmitterFeed feed(sources.emitters[k], static_cast<uint32_t>(k), params.spacing);
        feed.matter = vec4(1.0F, params.restDensity / liquid.density, liquid.viscosity, liquid.row);
        feed.absorption = dyed(liquid, e.dye, e.dyeAmount, e.dyeScattering);
        s.feeds_.push_back(std::move(feed));
    }
    s.deposits_ = sources.expectedDeposit > 0;
    if (s.deposits_) {
        EmitterFeed feed = EmitterFeed::ofDeposits(static_cast<uint32_t>(s.feeds_.size()), params.spacing);
        const LiquidOf liquid = liquidOf(params, "");
        feed.matter = vec4(1.0F, 1.0F, liquid.viscosity, liquid.row);
        feed.absorption = liquid.absorption;
        s.feeds_.push_back(std::move(feed));
    }
    s.sinkCount_ = sources.sinks.size();
    s.late_ = std::make_shared<Late>();
    if (!s.any()) return s;
    std::vector<Define> defines;
    if (absorption) defines.push_back({"ABSORPTION", "1"});
    if (matter) defines.push_back({"MATTER", "1"});
    Result<Kernel> emit = device.kernel("fluid/sources/emit", defines), drain = device.kernel("fluid/sources/drain"),
                   forget = device.kernel("fluid/sources/forget");
    for (const Result<Kernel>* k : {&emit, &drain, &forget})
        if (!*k) return k->error();
    s.emit_ = *emit;
    s.drain_ = *drain;
    s.forget_ = *forget;
    for (size_t k = 0; k < s.attributes_.size() && !s.feeds_.empty(); ++k) {
        Result<Kernel> emitAttribute = device.kernel("fluid/sources/emit_attribute");
        if (!emitAttribute) return emitAttribute.error();
        s.emitAttribute_ = *emitAttribute;
        Result<Buffer> made = device.allocate(s.feeds_.size() * sizeof(vec4));
        if (!made) return made.error();
        s.emittedAttributes_.push_back(std::move(*made));
    }
    s.writeAttributes();
    const size_t counters = s.feeds_.size() * EMITTER_COUNTERS + s.sinkCount_;
    for (auto [buffer, bytes] :
         {std::pair(&s.candidates_, s.feeds_.empty() ? 0 : kMostCandidates * sizeof(Candidate)),
          std::pair(&s.sinks_, s.sinkCount_ * sizeof(SinkVolume)), std::pair(&s.counters_, counters * sizeof(uint32_t))}) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    s.writeSinks(sources.sinks);
    s.reset();
    return s;
}

double SourcePasses::slotsFor(const Sources& sources, const FluidParams& params) {
    const double volume = std::pow(double{params.spacing}, 3);
    double slots = sources.expectedDeposit > 0 ? std::ceil(sources.expectedDeposit / volume) + 1 : 0;
    slots += std::ceil(sources.more / volume);
    for (const Emitter& e : sources.emitters) slots += std::ceil(volumeAfter(e.params, sources.seconds) / volume) + 1;
    const dvec3 size(params.box.max - params.box.min);
    // A full box receives no more; a tenth is added for higher densities.
    return std::min(slots, std::ceil(1.1 * size.x * size.y * size.z / volume) + 64);
}

void SourcePasses::writeSinks(const std::vector<SinkParams>& sinks) {
    std::vector<SinkVolume> volumes;
    for (const SinkParams& s : sinks) {
        if (s.shape == "sphere")
            volumes.push_back({vec4(s.position, 1.0F), vec4(s.radius, 0.0F, 0.0F, 0.0F)});
        else
            volumes.push_back({vec4(s.position - 0.5F * s.size, 0.0F), vec4(s.position + 0.5F * s.size, 0.0F)});
    }
    if (!volumes.empty()) device_->writeAll<SinkVolume>(sinks_, volumes);
}

void SourcePasses::writeAttributes() {
    for (size_t a = 0; a < emittedAttributes_.size(); ++a) {
        std::vector<vec4> values;
        values.reserve(feeds_.size());
        for (const EmitterFeed& feed : feeds_) values.push_back(attributeOf(attributes_[a], feed.emitter().params.attributes));
        device_->writeAll<vec4>(emittedAttributes_[a], values);
    }
}

Status SourcePasses::set(const Sources& sources) {
    if (sources.emitters.size() + (deposits_ ? 1 : 0) != feeds_.size() || sources.sinks.size() != sinkCount_)
        return badInput("the number of emitters or sinks has changed: create a new world");
    if (Status s = check(sources, spacing_, attributes_); !s) return s;
    std::vector<EmitterFeed::Next> next;
    for (size_t k = 0; k < sources.emitters.size(); ++k) next.push_back(feeds_[k].prepare(sources.emitters[k].params));
    writeSinks(sources.sinks);
    for (size_t k = 0; k < next.size(); ++k) feeds_[k].take(std::move(next[k]));
    writeAttributes();
    return ok();
}

void SourcePasses::reset() {
    for (EmitterFeed& feed : feeds_) feed.reset();
    reported_.assign(feeds_.size(), 0);
    auto late = std::make_shared<Late>();
    late->counters.assign(feeds_.size() * EMITTER_COUNTERS + sinkCount_, 0);  // where memory is short, the counters stay those of before
    late_ = std::move(late);
    waited_ = 0;
    if (any()) device_->fill(counters_, 0);
}

float SourcePasses::fastest() const {
    float v = 0;
    for (const EmitterFeed& feed : feeds_) v = std::max(v, feed.fastest());
    return v;
}

void SourcePasses::readCounts() {
    for (size_t k = 0; k < feeds_.size(); ++k) {
        const uint32_t* c = &late_->counters[k * EMITTER_COUNTERS];
        const uint32_t refused = c[1] + c[2];
        feeds_[k].refuse(refused - reported_[k]);
        reported_[k] = refused;
    }
}

// Removes from the list what would be spawned in a wall or a body, or too near to another of the list.
void SourcePasses::dropUnfit(const World& world) {
    const FluidParams& params = world.params;
    const float contact = 0.5F * spacing_, nearest2 = kNearest * kNearest * spacing_ * spacing_;
    const bvec3 periodic = params.box.periodic();
    const auto keyOf = [](const ivec3& c) {
        return (static_cast<uint64_t>(static_cast<uint32_t>(c.x)) * 73856093U) ^
               (static_cast<uint64_t>(static_cast<uint32_t>(c.y)) * 19349663U) ^
               (static_cast<uint64_t>(static_cast<uint32_t>(c.z)) * 83492791U);
    };
    std::unordered_multimap<uint64_t, vec3> taken;
    std::erase_if(list_, [&](const Candidate& c) {
        const vec3 p(c.position);
        bool fits = isFinite(p);
        for (int axis = 0; axis < 3 && fits; ++axis)
            fits = periodic[axis] ? p[axis] >= params.box.min[axis] && p[axis] < params.box.max[axis]
                                  : p[axis] >= params.box.min[axis] + 0.99F * contact && p[axis] <= params.box.max[axis] - 0.99F * contact;
        if (fits) {
            const ivec3 cell(glm::floor((p - params.box.min) / spacing_));
            for (int k = 0; k < 27 && fits; ++k) {
                const auto [from, to] = taken.equal_range(keyOf(cell + ivec3(k % 3, k / 3 % 3, k / 9) - 1));
                for (auto it = from; it != to && fits; ++it) fits = glm::dot(it->second - p, it->second - p) >= nearest2;
            }
            fits = fits && world.solids.maySpawn(p, spacing_) && world.bodies.maySpawn(p, spacing_) && !isDry(world.dry, p);
            if (fits) taken.emplace(keyOf(cell), p);
        }
        if (!fits) feeds_[static_cast<size_t>(c.position.w)].refuse(1);
        return !fits;
    });
}

void SourcePasses::run(const World& world, double time, double dt, bool last) {
    if (!any()) return;
    const StepParams& step = world.step;
    const NeighborGrid& grid = world.grid;
    Particles& particles = world.particles;
    EmitParams block{};
    block.step = step;
    block.sinks = static_cast<uint32_t>(sinkCount_);
    block.sinkCounters = static_cast<uint32_t>(feeds_.size()) * EMITTER_COUNTERS;
    block.nearest = kNearest * spacing_;
    const double support = double{step.h} / double{spacing_};
    block.weight = static_cast<float>(21.0 / (2.0 * 3.14159265358979323846 * support * support * support) / wendlandLatticeSum(support));
    block.crowded = kCrowded;
    if (sinkCount_ > 0) {
        device_->run(drain_, block, {&grid.cellStart(), &sinks_, &particles.positionNext, &particles.velocityNext, &counters_},
                     step.awakeSlots);
        for (const NamedBuffer& b : world.remembered)
            if (b.byId) device_->run(forget_, step, {&grid.cellStart(), &particles.positionNext, &particles.id, b.buffer}, step.awakeSlots);
    }
    waited_ += dt;
    // Often enough that a particle appears at most about a spacing from its exact place.
    if (feeds_.empty() || (!last && static_cast<double>(fastest()) * waited_ < static_cast<double>(spacing_))) return;
    readCounts();
    list_.clear();
    for (EmitterFeed& feed : feeds_) feed.offer(time - waited_, waited_, vec3(step.gravity), kMostCandidates - list_.size(), list_);
    waited_ = 0;
    dropUnfit(world);
    if (list_.empty()) return;
    block.candidates = static_cast<uint32_t>(list_.size());
    device_->writeAll<Candidate>(candidates_, list_);
    std::vector<const Buffer*> buffers = {&grid.cellStart(),       &candidates_, &particles.id, &particles.positionNext,
                                          &particles.velocityNext, &counters_};
    if (matter_) buffers.push_back(&particles.matterOf);
    if (absorption_) buffers.push_back(&particles.absorptionOf);
    device_->dispatch(emit_, std::as_bytes(std::span(&block, 1)), buffers, block.candidates);
    for (size_t a = 0; a < emittedAttributes_.size(); ++a)
        device_->run(
            emitAttribute_, block,
            {&grid.cellStart(), &candidates_, &particles.id, &particles.positionNext, &emittedAttributes_[a], &particles.attributesOf[a]},
            block.candidates);
    if (device_->backend() == Backend::cpu) report();
}

void SourcePasses::deposit(const vec3& place, const vec3& velocity, double volume) {
    ASSERT(deposits_, "deposits need Sources::expectedDeposit > 0");
    feeds_.back().deposit(place, velocity, volume);
}

void SourcePasses::report() {
    if (!any()) return;
    device_->readLater(counters_, counters_.bytes(), [into = late_](std::span<const std::byte> bytes) {
        const auto* words = reinterpret_cast<const uint32_t*>(bytes.data());
        into->counters.assign(words, words + into->counters.size());
    });
}

uint64_t SourcePasses::emitted() const {
    uint64_t sum = 0;
    for (size_t k = 0; k < feeds_.size(); ++k) sum += late_->counters[k * EMITTER_COUNTERS];
    return sum;
}

uint64_t SourcePasses::deposited() const { return deposits_ ? late_->counters[(feeds_.size() - 1) * EMITTER_COUNTERS] : 0; }

double SourcePasses::pending() const { return deposits_ ? feeds_.back().due() - static_cast<double>(deposited()) : 0; }

std::span<const vec3> SourcePasses::depositPlaces() const {
    if (!deposits_) return {};
    const EmitterFeed::Flight& flight = feeds_.back().flight();
    return std::span(flight.places).first(flight.count);
}

uint64_t SourcePasses::drained() const {
    uint64_t sum = 0;
    for (size_t k = 0; k < sinkCount_; ++k) sum += late_->counters[feeds_.size() * EMITTER_COUNTERS + k];
    return sum;
}

bool SourcePasses::full() const {
    for (size_t k = 0; k < feeds_.size(); ++k)
        if (late_->counters[k * EMITTER_COUNTERS + 2] > 0) return true;
    return false;
}

double SourcePasses::backlog() const {
    double sum = 0;
    for (const EmitterFeed& feed : feeds_) sum += feed.due();
    return sum - static_cast<double>(emitted());
}

uint64_t SourcePasses::meshesHash() const {
    uint64_t hash = 0;
    for (const EmitterFeed& feed : feeds_) hash = checksum(std::as_bytes(std::span(feed.emitter().triangles)), hash);
    return hash;
}

void SourcePasses::save(WorldState& state) const {
    if (!any()) return;
    const uint64_t numbers[] = {feeds_.size(), sinkCount_, meshesHash()};
    state.put<uint64_t>("sources.numbers", numbers);
    std::vector<EmitterFeed::Account> accounts;
    for (const EmitterFeed& feed : feeds_) accounts.push_back(feed.account());
    state.put<EmitterFeed::Account>("sources.accounts", accounts);
    state.put<uint32_t>("sources.heard", reported_);
    state.put<uint32_t>("sources.counters", late_->counters);
    state.put<double>("sources.waited", std::span(&waited_, 1));
    if (deposits_) state.put<EmitterFeed::Flight>("sources.poured", std::span(&feeds_.back().flight(), 1));
}

Result<SourcePasses::Saved> SourcePasses::take(WorldState& state) const {
    if (!any()) return Saved{};
    Result<std::vector<uint64_t>> numbers = state.take<uint64_t>("sources.numbers", 3);
    if (!numbers) return numbers.error();
    const std::vector<uint64_t>& n = *numbers;
    if (n[0] != feeds_.size() || n[1] != sinkCount_)
        return badInput(fmt::format("the state was saved with {} emitters and {} sinks, this scene has {} and {}", n[0], n[1],
                                    feeds_.size(), sinkCount_));
    if (n[2] != meshesHash()) return badInput("the state was saved with another emitter mesh: resume it with the scene it was saved from");
    Result<std::vector<EmitterFeed::Account>> accounts = state.take<EmitterFeed::Account>("sources.accounts", feeds_.size());
    if (!accounts) return accounts.error();
    Result<std::vector<uint32_t>> reported = state.take<uint32_t>("sources.heard", feeds_.size());
    if (!reported) return reported.error();
    Result<std::vector<uint32_t>> counters = state.take<uint32_t>("sources.counters", late_->counters.size());
    if (!counters) return counters.error();
    Result<std::vector<double>> waited = state.take<double>("sources.waited", 1);
    if (!waited) return waited.error();
    constexpr double kLongestWait = 100, kMostDue = 0x1p53;  // s; particles
    if (Status within = checkRange("sources.waited", *waited, 0, kLongestWait); !within) return within.error();
    bool sound = true;
    EmitterFeed::Flight flight;
    if (deposits_) {
        Result<std::vector<EmitterFeed::Flight>> saved = state.take<EmitterFeed::Flight>("sources.poured", 1);
        if (!saved) return saved.error();
        flight = (*saved)[0];
        if (flight.count > flight.places.size() || flight.next >= flight.places.size() || !isWithin(flight.velocity, kMostSpeed) ||
            !std::ranges::all_of(flight.places, [](const vec3& p) { return isWithin(p, kMostDistance); }))
            return badInput("section sources.poured of the saved state has impossible places or velocities: save it again");
    }
    for (size_t k = 0; k < feeds_.size(); ++k) {
        const EmitterFeed::Account& a = (*accounts)[k];
        const uint32_t* c = &(*counters)[k * EMITTER_COUNTERS];
        // What was offered has been taken or refused: the feed has counted it, or will when it next reads the counters.
        const auto taken = static_cast<uint32_t>(a.offered - a.refused) - (c[1] + c[2] - (*reported)[k]);
        sound = sound && a.due >= 0 && a.due <= kMostDue && a.refused <= a.offered && a.offered < uint64_t{1} << 53U && taken == c[0];
    }
    if (!sound) return badInput("sections sources.accounts, heard and counters of the saved state do not add up: save it again");
    return Saved{std::move(*accounts), std::move(*reported), std::move(*counters), (*waited)[0], flight};
}

void SourcePasses::restore(const Saved& saved) {
    if (!any()) return;
    reset();
    for (size_t k = 0; k < feeds_.size(); ++k) feeds_[k].restore(saved.accounts[k], saved.flight);
    reported_ = saved.reported;
    late_->counters = saved.counters;
    waited_ = saved.waited;
    device_->writeAll<uint32_t>(counters_, saved.counters);
}

}  // namespace rivulet
