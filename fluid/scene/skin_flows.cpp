#include "fluid/scene/skin_flows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/assert.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

namespace {

constexpr double kPicolitre = 1.0e-15, kCubicMillimetre = 1.0e-9;  // m^3
constexpr float kWet = 0.3F;                                       // density ratio from which on a drop has met water
constexpr float kAlone = 0.5F;                                     // up to which a particle is no part of it
constexpr double kAirDensity = 1.2;                                // kg/m^3
constexpr double kBallDrag = 0.6;                                  // drag coefficient of a drop that falls

}  // namespace

Status SkinFlows::create(const SceneFile& scene, Device& device, Scene& nodes, const Log& log) {
    firstNode_ = nodes.nodes().size();
    pools_ = expectedPoured(scene, 0) > 0;
    for (size_t k = 0; k < scene.flow.size(); ++k) {
        auto made = FlowComponent::create(scene.flow[k], scene.folder, device, nodes, log);
        if (!made) return Error{fmt::format("flow[{}]: {}", k, made.error().message), made.error().fault};
        skins_.push_back(std::move(*made));
    }
    Bounds all;
    for (const auto& skin : skins_) {
        all.add(skin->bounds().min);
        all.add(skin->bounds().max);
    }
    // Where no ground is shown, what has fallen as far below as everything is large is gone.
    floor_ = scene.background.showFloor ? double{scene.background.floorHeight}
             : all.empty()              ? 0.0
                                        : double{all.min.y} - double{glm::length(all.size())};
    return ok();
}

bool SkinFlows::needsNew(const SceneFile& scene) const {
    if (scene.flow.size() != skins_.size()) return true;
    for (size_t k = 0; k < skins_.size(); ++k)
        if (skins_[k]->needsNew(scene.flow[k])) return true;
    return false;
}

void SkinFlows::apply(const SceneFile& scene) {
    for (size_t k = 0; k < std::min(skins_.size(), scene.flow.size()); ++k) skins_[k]->apply(scene.flow[k]);
}

Status SkinFlows::reset(const SceneFile& scene, Device& device, Scene& nodes, const Log& log) {
    if (empty()) return ok();
    nodes.nodes().resize(firstNode_);
    *this = SkinFlows();
    return create(scene, device, nodes, log);
}

struct SkinFlows::Snapshot {
    std::vector<std::shared_ptr<const FlowComponent::Snapshot>> skins;
    std::vector<FlowComponent::AirDrop> air;
    uint64_t drained = 0, dripped = 0, poured = 0, taken = 0, particles = 0;
    double time = 0;
};

std::shared_ptr<const SkinFlows::Snapshot> SkinFlows::save() const {
    auto made = std::make_shared<Snapshot>();
    for (const auto& skin : skins_) made->skins.push_back(skin->save());
    made->air = air_;
    made->drained = drained_;
    made->dripped = dripped_;
    made->poured = poured_;
    made->taken = taken_;
    made->particles = particles_;
    made->time = time_;
    return made;
}

Status SkinFlows::moveTo(Device& device, SceneFile scene, Scene& nodes, const Log& log, const Snapshot* from) {
    // An edit may be under way: they stay what they were made as.
    for (size_t k = 0; k < std::min(skins_.size(), scene.flow.size()); ++k) {
        scene.flow[k] = skins_[k]->params();
        scene.flow[k].liquid = skins_[k]->flow().params();
    }
    if (Status fresh = reset(scene, device, nodes, log); !fresh || from == nullptr) return fresh;
    ASSERT(from->skins.size() == skins_.size(), "a snapshot of the same scene's skins");
    for (size_t k = 0; k < skins_.size(); ++k) {
        if (Status taken = skins_[k]->restore(*from->skins[k]); !taken) return taken;
        skins_[k]->placeNode(nodes);
    }
    air_ = from->air;
    drained_ = from->drained;
    dripped_ = from->dripped;
    poured_ = from->poured;
    taken_ = from->taken;
    particles_ = from->particles;
    time_ = from->time;
    return ok();
}

double SkinFlows::expectedPoured(const SceneFile& scene, double seconds) {
    if (scene.flow.empty() || (scene.fluid.blocks.empty() && scene.emitters.empty())) return 0;
    double volume = std::pow(double{scene.fluid.spacing}, 3);
    for (const FlowParams& skin : scene.flow)
        for (const FlowSourceParams& source : skin.sources) volume += double{source.rate} * kCubicMillimetre / 60 * seconds;
    return volume;
}

SkinFlows::First SkinFlows::firstOn(const dvec3& from, const dvec3& to, double then) const {
    First first;
    for (const auto& skin : skins_)
        if (const std::optional<SkinSearch::Hit> hit = skin->meets(from, to, then);
            hit && (first.skin == nullptr || hit->share < first.where.share))
            first = {skin.get(), *hit};
    return first;
}

// Whether a skin has slots for `count` more drops in this step; they are then taken. What finds none flies on.
bool SkinFlows::hasRoom(const FlowComponent* skin, uint32_t count) {
    const auto [at, asked] = room_.try_emplace(skin, 0U);
    if (asked) at->second = skin->flow().room();
    if (count > at->second) return false;
    at->second -= count;
    return true;
}

// A particle whose way, and half a spacing beyond, meets a skin becomes drops side by side as wide as it was: those that the skin is in the
// way of land, the others fly by. A skin that has no room for them lets it pass. Water that stands about a skin, or waves against it, stays
// where it is: what comes down has fallen further than it is wide, or is alone.
void SkinFlows::takeLanding(const SceneFile& scene, FluidWorld& world, double seconds) {
    const double spacing = double{world.particles().spacing};
    const float reach = world.stats().maxSpeed > 0 ? static_cast<float>(world.stats().maxSpeed * seconds) : 0.0F;
    Bounds near;
    for (const auto& skin : skins_) {
        near.add(skin->bounds().min - (reach + 2 * static_cast<float>(spacing)));
        near.add(skin->bounds().max + (reach + 2 * static_cast<float>(spacing)));
    }
    std::vector<uint32_t> slots;
    const double then = time_ + seconds;
    const auto fall = static_cast<float>(std::sqrt(glm::length(dvec3(scene.fluid.gravity)) * spacing));
    for (const WorldParticle& p : world.within(near, fall, kAlone)) {
        const dvec3 x(p.position), v(p.velocity);
        const double speed = glm::length(v);
        const dvec3 way = speed > 0 ? v / speed : dvec3(0.0), from = x - v * seconds;
        if (!std::isfinite(speed)) continue;
        const First first = firstOn(from, x + way * (0.5 * spacing), then);
        if (first.skin == nullptr) continue;
        const auto on = static_cast<size_t>(
            std::find_if(skins_.begin(), skins_.end(), [&](const auto& s) { return s.get() == first.skin; }) - skins_.begin());
        // Volumes of particles are no whole picolitres: each has what brings the sum nearest.
        const auto upTo = static_cast<uint64_t>(std::llround(static_cast<double>(particles_ + 1) * std::pow(spacing, 3) / kPicolitre));
        const uint64_t volume = upTo - taken_;
        const double most = std::max(double{scene.flow[on].liquid.largestDrop} * kCubicMillimetre / kPicolitre, 1.0);
        const auto count = static_cast<uint32_t>(std::max(std::ceil(static_cast<double>(volume) / most), 1.0));
        if (!hasRoom(first.skin, count)) continue;
        ++particles_;
        taken_ = upTo;
        slots.push_back(p.slot);
        // Sunflower seeds in the disc that a particle's volume has as a ball.
        const double wide = std::cbrt(3 / (4 * std::numbers::pi)) * spacing;
        const dvec3 n = speed > 0 ? way : -dvec3(first.where.normal);
        const dvec3 a = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0))), b = glm::cross(n, a);
        for (uint32_t k = 0; k < count; ++k) {
            const double r = wide * std::sqrt((k + 0.5) / count), angle = k * (std::numbers::pi * (3 - std::sqrt(5.0)));
            const dvec3 off = (a * std::cos(angle) + b * std::sin(angle)) * r;
            const FlowComponent::AirDrop drop{x + off, v, static_cast<uint32_t>(volume * (k + 1) / count - volume * k / count)};
            const First own = count == 1 ? first : firstOn(from + off, x + off + n * (2 * spacing), then);
            // The skin that the particle came down on has room for all of them.
            if (own.skin != nullptr && (own.skin == first.skin || hasRoom(own.skin)))
                own.skin->land(own.where, drop);
            else
                air_.push_back(drop);
        }
    }
    world.withdraw(slots);
}

// In the air a drop is a ball that falls and drags; it ends on the first skin in its way, in the world's water, or on the ground.
Status SkinFlows::fall(const SceneFile& scene, FluidWorld& world, double seconds) {
    const vec3 wind = scene.flow.empty() ? vec3(0.0F) : scene.flow[0].wind;
    struct Way {
        dvec3 to;
        First first;
        size_t begin = 0, count = 0;  // of the places along it
    };
    std::vector<Way> ways;
    std::vector<vec3> places;
    const double then = time_ + seconds, spacing = double{world.particles().spacing};
    for (FlowComponent::AirDrop& d : air_) {
        const double density = scene.flow.empty() ? 1000 : double{scene.flow[0].liquid.density}, volume = d.picolitres * kPicolitre;
        const double radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
        const dvec3 against = dvec3(wind) - d.velocity;
        // Implicit in the drag: no step makes it turn round.
        const double drag = 0.5 * kAirDensity * kBallDrag * std::numbers::pi * radius * radius * glm::length(against) / (density * volume);
        d.velocity += (dvec3(scene.fluid.gravity) + against * drag) * seconds / (1 + drag * seconds);
        Way way{.to = d.position + d.velocity * seconds, .first = {}, .begin = places.size()};
        way.first = firstOn(d.position, way.to, then);
        if (pools_ && isFinite(vec3(way.to))) {
            way.count = static_cast<size_t>(std::min(std::ceil(glm::distance(d.position, way.to) / spacing), 64.0));
            for (size_t k = 0; k < way.count; ++k)
                places.emplace_back(glm::mix(d.position, way.to, static_cast<double>(k + 1) / static_cast<double>(way.count)));
        }
        ways.push_back(way);
    }
    std::vector<FluidSample> full;
    if (!places.empty()) {
        Result<std::vector<FluidSample>> sampled = world.sample(places);
        if (!sampled) return sampled.error();
        full = std::move(*sampled);
    }
    size_t kept = 0;
    for (size_t i = 0; i < air_.size(); ++i) {
        FlowComponent::AirDrop& d = air_[i];
        const Way& way = ways[i];
        size_t wet = 0;
        while (wet < way.count && !(full[way.begin + wet].density > kWet)) ++wet;
        const bool landed = way.first.skin != nullptr;
        if (wet < way.count && !(landed && double{way.first.where.share} * static_cast<double>(way.count) < static_cast<double>(wet + 1))) {
            world.deposit(places[way.begin + wet], vec3(d.velocity), d.picolitres * kPicolitre);
            poured_ += d.picolitres;
            continue;
        }
        if (landed && hasRoom(way.first.skin)) {
            way.first.skin->land(way.first.where, d);
            continue;
        }
        d.position = way.to;
        const bool somewhere = std::isfinite(glm::dot(way.to, way.to)) && glm::dot(way.to, way.to) < 1.0e12;
        if (!somewhere || way.to.y < floor_)
            drained_ += d.picolitres;
        else
            air_[kept++] = d;
    }
    air_.resize(kept);
    return ok();
}

Status SkinFlows::step(const SceneFile& scene, FluidWorld& world, double seconds, Scene& nodes) {
    if (empty() || !(seconds > 0)) return ok();
    room_.clear();
    if (Status fallen = fall(scene, world, seconds); !fallen) return fallen;
    if (pools_) takeLanding(scene, world, seconds);
    for (const auto& skin : skins_) {
        if (Status moved = skin->step(time_, seconds, scene.fluid.gravity, air_); !moved) return moved;
        skin->placeNode(nodes);
    }
    time_ += seconds;
    return ok();
}

Status SkinFlows::draw() {
    for (const auto& skin : skins_)
        if (Status drawn = skin->draw(); !drawn) return drawn;
    return ok();
}

std::vector<vec4> SkinFlows::airDrops() const {
    std::vector<vec4> all;
    for (const FlowComponent::AirDrop& d : air_) {
        all.emplace_back(vec3(d.position), static_cast<float>(std::cbrt(3 * d.picolitres * kPicolitre / (4 * std::numbers::pi))));
        all.emplace_back(vec3(d.velocity), 0.0F);
    }
    return all;
}

bool SkinFlows::drip(const dvec3& from, const dvec3& way, uint32_t picolitres) {
    const First first = firstOn(from, from + way, time_);
    if (first.skin == nullptr) return false;
    first.skin->land(first.where, {dvec3(0.0), dvec3(0.0), picolitres});
    dripped_ += picolitres;
    return true;
}

SkinFlows::Counted SkinFlows::counted() const {
    Counted c{.emitted = dripped_, .taken = taken_, .drained = drained_, .poured = poured_};
    for (const auto& skin : skins_) c.emitted += skin->emitted();  // with what lay in its brims at the start
    for (const FlowComponent::AirDrop& d : air_) c.air += d.picolitres;
    return c;
}

void SkinFlows::Counted::add(const SurfaceFlow::Ledger& own) {
    surface += own.drops + own.film;
    evaporated += own.evaporated;
    refused += own.refused;
    air += own.left - own.handed;  // a GPU tells of it late: it is taken up with the next step
}

SkinFlows::Ledger SkinFlows::Counted::ledger() const {
    Ledger l;
    l.emitted = static_cast<double>(emitted) * kPicolitre;
    l.taken = static_cast<double>(taken) * kPicolitre;
    l.poured = static_cast<double>(poured) * kPicolitre;
    l.onSurface = static_cast<double>(surface) * kPicolitre;
    l.inAir = static_cast<double>(air) * kPicolitre;
    l.evaporated = static_cast<double>(evaporated) * kPicolitre;
    l.drained = static_cast<double>(drained + refused) * kPicolitre;  // where there was no slot nothing was let out
    const uint64_t there = surface + air + evaporated + drained + refused + poured, came = emitted + taken;
    l.error = static_cast<double>(std::max(there, came) - std::min(there, came)) * kPicolitre;
    return l;
}

SkinFlows::Ledger SkinFlows::ledger() const {
    Counted c = counted();
    for (const auto& skin : skins_) c.add(skin->flow().ledger());
    return c.ledger();
}

void SkinFlows::ledgerLater(const std::function<void(const Ledger&)>& then) const {
    const auto c = std::make_shared<Counted>(counted());
    const auto awaited = std::make_shared<size_t>(skins_.size());
    for (const auto& skin : skins_)
        skin->flow().ledgerLater([c, awaited, then](const SurfaceFlow::Ledger& own) {
            c->add(own);
            if (--*awaited == 0) then(c->ledger());
        });
}

}  // namespace rivulet
