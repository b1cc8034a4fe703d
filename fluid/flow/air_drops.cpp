#include "fluid/flow/air_drops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rivulet {

namespace {

constexpr double kPicolitre = 1.0e-15, kCubicMillimetre = 1.0e-9;  // m^3
constexpr float kWet = 0.3F;                                       // density ratio from which a drop counts as in water
constexpr float kAlone = 0.5F;                                     // density ratio up to which a particle is no part of the water
constexpr double kAirDensity = 1.2;                                // kg/m^3
constexpr double kBallDrag = 0.6;                                  // drag coefficient of a falling drop
// Of a drop that lets go, in sqrt(density x radius^3 / surface tension): how long its neck takes to break, and how long it is then drawn as
// it swings. Chosen by eye.
constexpr double kNeck = 3, kSwings = 3;

double inertial(const AirDrop& d, const SurfaceFlowParams& p) {
    return std::sqrt(double{p.density} * std::pow(radiusOf(d), 3) / double{p.surfaceTension});
}

// `share` of the time until the neck breaks. From what hung to a pear below a cone, r^2 = (1 - s) (s - neck)^2 (a + b s): the pear holds
// what falls, and the cone's foot becomes narrower.
HungDrop necking(const AirDrop& d, double share) {
    constexpr double kPear = 2.4, kFoot = 0.4;  // its length over the radius of its ball; the square of the cone's foot over that before
    if (share == 0) return *d.hung;             // it does not move yet
    HungDrop made = *d.hung;
    const double radius = radiusOf(d);
    const dvec3 end = d.position + made.down() * (radius * (1 + (kPear - 2) * share)), line = end - made.foot;
    made.profile.length = std::max(glm::dot(line, made.axis), 0.5 * d.hung->profile.length);
    made.lean = 2.0 * (line - made.axis * glm::dot(line, made.axis)) / made.profile.length;
    const double pear = std::min(kPear * radius / made.profile.length, 0.75), neck = 1 - pear, p4 = std::pow(pear, 4);
    const double a = kFoot * d.hung->profile.swell.x / (neck * neck);
    const double b = (4 * std::pow(radius, 3) / (3 * made.profile.length) - a * p4 / 12) / (neck * p4 / 12 + pear * p4 / 20);
    const dvec4 broken(neck * neck * a, neck * neck * b - 2 * neck * a, a - 2 * neck * b, b);
    made.profile.swell = glm::mix(d.hung->profile.swell, broken, share);
    return made;
}

// `time` after that, in inertial(): the pear becomes a ball, and swings at the frequency of Rayleigh 1879, sqrt(8) / (2 pi).
HungDrop swinging(const AirDrop& d, double time) {
    constexpr double kCalms = 1.5;
    HungDrop made = *d.hung;
    const double radius = radiusOf(d), swing = std::exp(-time / kCalms) * std::cos(std::sqrt(8.0) * time),
                 pear = swing > 0 ? swing * swing : 0;
    const double length = 2 * radius * (1 + 0.2 * swing), volume = 4 * std::pow(radius, 3) / (3 * length);
    made.axis = made.down();
    made.lean = dvec3(0.0);
    made.foot = d.position - made.axis * (0.5 * length);
    made.profile = {length, dvec4(0, 6 * volume * (1 - pear), 12 * volume * pear, 0)};
    return made;
}

}  // namespace

// Whether a skin has free slots for `count` more drops in this step; they are then reserved. A drop without a slot flies on.
bool AirDrops::hasRoom(const Inputs& inputs, size_t skin, uint32_t count) {
    int64_t& room = room_[skin];
    if (room < 0) room = inputs.skins[skin]->flow().room();
    if (count > room) return false;
    room -= count;
    return true;
}

// A particle whose path, extended by half a spacing, meets a skin becomes drops side by side over its width: those whose own path meets a
// skin land, the others fly on. If the skin has no free slots the particle passes. Water that stands about a skin or waves against it is
// left alone: a particle is taken if it is faster than after a fall of its own width, or alone.
void AirDrops::takeLanding(const Inputs& inputs, double seconds) {
    FluidWorld& world = *inputs.world;
    const double spacing = double{world.particles().spacing};
    const float reach = world.stats().maxSpeed > 0 ? static_cast<float>(world.stats().maxSpeed * seconds) : 0.0F;
    Bounds near;
    for (const PlacedFlow* skin : inputs.skins) {
        near.add(skin->bounds().min - (reach + 2 * static_cast<float>(spacing)));
        near.add(skin->bounds().max + (reach + 2 * static_cast<float>(spacing)));
    }
    std::vector<uint32_t> slots;
    const double then = inputs.time + seconds;
    const auto fall = static_cast<float>(std::sqrt(glm::length(dvec3(inputs.gravity)) * spacing));
    for (const WorldParticle& p : world.within(near, fall, kAlone)) {
        const dvec3 x(p.position), v(p.velocity);
        const double speed = glm::length(v);
        const dvec3 way = speed > 0 ? v / speed : dvec3(0.0), from = x - v * seconds;
        if (!std::isfinite(speed)) continue;
        const FirstMet first = firstMet(inputs.skins, from, x + way * (0.5 * spacing), then);
        if (first.skin == inputs.skins.size()) continue;
        // A particle's volume is not a whole number of picolitres: round so that the sum is nearest.
        const auto upTo = static_cast<uint64_t>(std::llround(static_cast<double>(particles_ + 1) * std::pow(spacing, 3) / kPicolitre));
        const uint64_t volume = upTo - taken_;
        const double most = std::max(double{inputs.skins[first.skin]->flow().params().largestDrop} * kCubicMillimetre / kPicolitre, 1.0);
        const auto count = static_cast<uint32_t>(std::max(std::ceil(static_cast<double>(volume) / most), 1.0));
        if (!hasRoom(inputs, first.skin, count)) continue;
        ++particles_;
        taken_ = upTo;
        slots.push_back(p.slot);
        // Placed like sunflower seeds over the disc of a ball of the particle's volume.
        const double wide = std::cbrt(3 / (4 * std::numbers::pi)) * spacing;
        const dvec3 n = speed > 0 ? way : -dvec3(first.where.normal);
        const dvec3 a = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0))), b = glm::cross(n, a);
        for (uint32_t k = 0; k < count; ++k) {
            const double r = wide * std::sqrt((k + 0.5) / count), angle = k * (std::numbers::pi * (3 - std::sqrt(5.0)));
            const dvec3 off = (a * std::cos(angle) + b * std::sin(angle)) * r;
            const AirDrop drop{x + off, v, static_cast<uint32_t>(volume * (k + 1) / count - volume * k / count),
                               static_cast<uint32_t>(first.skin)};
            const FirstMet own = count == 1 ? first : firstMet(inputs.skins, from + off, x + off + n * (2 * spacing), then);
            // The skin that the particle meets has slots reserved for all of them.
            if (own.skin != inputs.skins.size() && (own.skin == first.skin || hasRoom(inputs, own.skin)))
                inputs.skins[own.skin]->land(own.where, drop);
            else
                drops_.push_back(drop);
        }
    }
    world.withdraw(slots);
}

// A drop in the air is a falling ball with drag; it ends on the first skin in its path, in the world's water, or on the ground.
Status AirDrops::fall(const Inputs& inputs, double seconds) {
    struct Way {
        dvec3 to;
        FirstMet first;
        size_t begin = 0, count = 0;  // of the sampled places along it
    };
    std::vector<Way> ways;
    std::vector<vec3> places;
    FluidWorld* world = inputs.world;
    const double then = inputs.time + seconds, spacing = world != nullptr ? double{world->particles().spacing} : 0.0;
    for (AirDrop& d : drops_) {
        const double density = double{inputs.skins[d.skin]->flow().params().density}, volume = d.picolitres * kPicolitre;
        const double radius = radiusOf(d);
        const dvec3 against = dvec3(inputs.winds[d.skin]) - d.velocity;
        // The drag is implicit: no step length reverses the drop.
        const double drag = 0.5 * kAirDensity * kBallDrag * std::numbers::pi * radius * radius * glm::length(against) / (density * volume);
        // Its neck holds it at first.
        double falls = 1;
        dvec3 off(0.0);
        if (d.hung) {
            if (d.age == 0) off = d.hung->tip() - d.hung->down() * radius - d.position;
            d.age += seconds;
            falls = std::min(d.age / (kNeck * inertial(d, inputs.skins[d.skin]->flow().params())), 1.0);
        }
        d.velocity += (dvec3(inputs.gravity) * falls * falls + against * drag) * seconds / (1 + drag * seconds);
        Way way{.to = d.position + off + d.velocity * seconds, .first = {}, .begin = places.size()};
        way.first = firstMet(inputs.skins, d.position, way.to, then);
        if (world != nullptr && isFinite(vec3(way.to))) {
            way.count = static_cast<size_t>(std::min(std::ceil(glm::distance(d.position, way.to) / spacing), 64.0));
            for (size_t k = 0; k < way.count; ++k)
                places.emplace_back(glm::mix(d.position, way.to, static_cast<double>(k + 1) / static_cast<double>(way.count)));
        }
        ways.push_back(way);
    }
    std::vector<FluidSample> full;
    if (!places.empty()) {
        Result<std::vector<FluidSample>> sampled = world->sample(places);
        if (!sampled) return sampled.error();
        full = std::move(*sampled);
    }
    size_t kept = 0;
    for (size_t i = 0; i < drops_.size(); ++i) {
        AirDrop& d = drops_[i];
        const Way& way = ways[i];
        size_t wet = 0;
        while (wet < way.count && !(full[way.begin + wet].density > kWet)) ++wet;
        const bool landed = way.first.skin != inputs.skins.size();
        if (wet < way.count && !(landed && double{way.first.where.share} * static_cast<double>(way.count) < static_cast<double>(wet + 1))) {
            world->deposit(places[way.begin + wet], vec3(d.velocity), d.picolitres * kPicolitre);
            poured_ += d.picolitres;
            continue;
        }
        if (landed && hasRoom(inputs, way.first.skin)) {
            inputs.skins[way.first.skin]->land(way.first.where, d);
            continue;
        }
        d.position = way.to;
        if (d.hung && d.age > (kNeck + kSwings) * inertial(d, inputs.skins[d.skin]->flow().params())) d.hung.reset();
        const bool somewhere = std::isfinite(glm::dot(way.to, way.to)) && glm::dot(way.to, way.to) < 1.0e12;
        if (!somewhere || way.to.y < inputs.floor)
            drained_ += d.picolitres;
        else
            drops_[kept++] = d;
    }
    drops_.resize(kept);
    return ok();
}

Status AirDrops::step(const Inputs& inputs, double seconds) {
    room_.assign(inputs.skins.size(), -1);
    if (Status fallen = fall(inputs, seconds); !fallen) return fallen;
    if (inputs.world != nullptr) takeLanding(inputs, seconds);
    return ok();
}

void AirDrops::renumber(std::span<const std::optional<uint32_t>> places) {
    std::erase_if(drops_, [&](AirDrop& d) {
        const std::optional<uint32_t> place = d.skin < places.size() ? places[d.skin] : std::nullopt;
        if (!place) drained_ += d.picolitres;
        d.skin = place.value_or(0);
        return !place;
    });
}

std::vector<vec4> AirDrops::drawn() const {
    std::vector<vec4> all;
    for (const AirDrop& d : drops_) {
        if (d.hung) continue;
        all.emplace_back(vec3(d.position), static_cast<float>(radiusOf(d)));
        all.emplace_back(vec3(d.velocity), 0.0F);
    }
    return all;
}

std::vector<AirDrops::LetGo> AirDrops::letGo(std::span<PlacedFlow* const> skins) const {
    std::vector<LetGo> all;
    for (const AirDrop& d : drops_) {
        if (!d.hung) continue;
        const double time = d.age / inertial(d, skins[d.skin]->flow().params());
        all.push_back({time < kNeck ? necking(d, time / kNeck) : swinging(d, time - kNeck), d.skin});
    }
    return all;
}

AirDrops::Counts AirDrops::counts() const {
    Counts c{.air = 0, .drained = drained_, .poured = poured_, .taken = taken_};
    for (const AirDrop& d : drops_) c.air += d.picolitres;
    return c;
}

}  // namespace rivulet
