#include "fluid/flow/air_drops.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

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

// Whether a skin has free slots for `count` more drops in this step, beside those for particles that are claimed; they are then reserved. A
// drop without a slot flies on.
bool AirDrops::hasRoom(const Inputs& inputs, size_t skin, uint32_t count) {
    int64_t& room = room_[skin];
    if (room < 0) {
        room = inputs.skins[skin]->flow().room();
        for (const auto& claims : claims_)
            for (const Claim& c : claims->all)
                room -= std::count_if(c.parts.begin(), c.parts.end(), [&](const Claim::Part& part) { return part.lands == skin; });
        room = std::max<int64_t>(room, 0);
    }
    if (count > room) return false;
    room -= count;
    return true;
}

void AirDrops::add(const AirDrop& drop) {
    drops_.push_back(drop);
    drops_.back().number = numbers_++;
}

AirDrops AirDrops::copy() const {
    AirDrops made = *this;
    made.list_ = std::make_shared<std::optional<List>>(*list_);  // the others do not change once they are answered
    return made;
}

// Picolitres. A particle's volume is not a whole number of them: the sum of so many is, to the nearest.
uint64_t AirDrops::volumeOf(uint64_t particles) const {
    return static_cast<uint64_t>(std::llround(static_cast<double>(particles) * std::pow(spacing_, 3) / kPicolitre));
}

// Asks for the particles near skins that are fast or alone. Water that stands about a skin or waves against it is left alone.
void AirDrops::listParticles(const Inputs& inputs, double seconds) {
    FluidWorld& world = *inputs.world;
    constexpr float kFramesLate = 4;
    const float frames = world.device().backend() == Backend::cpu ? 1.0F : kFramesLate;
    const float reach = world.stats().maxSpeed > 0 ? static_cast<float>(world.stats().maxSpeed * seconds) * frames : 0.0F;
    Bounds near;
    for (const PlacedFlow* skin : inputs.skins) {
        near.add(skin->bounds().min - (reach + 2 * static_cast<float>(spacing_)));
        near.add(skin->bounds().max + (reach + 2 * static_cast<float>(spacing_)));
    }
    const auto fall = static_cast<float>(std::sqrt(glm::length(dvec3(inputs.gravity)) * spacing_));
    world.withinLater(near, fall, kAlone,
                      [list = std::weak_ptr(list_), then = inputs.time + seconds](std::span<const WorldParticle> found) {
                          if (const auto into = list.lock()) *into = List{then, {found.begin(), found.end()}};
                      });
}

// A particle whose path meets a skin becomes several drops, side by side over the particle's width; the path is extended by half a spacing.
// Each drop has a path of its own: if that meets a skin, the drop lands there, else it flies on. A skin without free slots takes none.
void AirDrops::takeLanding(const Inputs& inputs, double seconds) {
    constexpr double kLongest = 0.1;  // s
    constexpr double kAside = 0.1;    // of its way, chosen by eye
    FluidWorld& world = *inputs.world;
    spacing_ = double{world.particles().spacing};
    listParticles(inputs, seconds);
    if (!*list_) return;
    const List list = std::move(**list_);
    list_->reset();
    std::erase_if(claimedAt_, [&](const auto& claimed) { return claimed.second < list.time; });
    const auto claims = std::make_shared<Claims>();
    std::vector<ParticleClaim> asked;
    uint64_t promised = particles_;
    for (const auto& before : claims_) promised += before->all.size();
    const double then = inputs.time + seconds, late = then - list.time;
    // Lists do not arrive in every frame: a path begins where the last one's ended.
    const double since = std::min(list.time - testedTo_, kLongest), span = testedTo_ > 0 && since > 1.5 * seconds ? since : seconds;
    testedTo_ = then;
    const dvec3 g(inputs.gravity);
    for (const WorldParticle& p : list.particles) {
        if (claimedAt_.contains(p.id)) continue;
        const dvec3 before(p.position), from = before - dvec3(p.velocity) * span;
        const dvec3 v = late > 0 ? dvec3(p.velocity) + g * late : dvec3(p.velocity);
        const dvec3 x = late > 0 ? before + (dvec3(p.velocity) + g * (0.5 * late)) * late : before;
        const double speed = glm::length(v);
        if (!std::isfinite(speed)) continue;
        const dvec3 way = speed > 0 ? v / speed : dvec3(0.0);
        const dvec3 to = x + way * (0.5 * spacing_);
        const FirstMet first = firstMet(inputs.skins, from, to, then);
        if (first.skin == inputs.skins.size()) continue;
        const uint64_t volume = volumeOf(promised + 1) - volumeOf(promised);
        const double most = std::max(double{inputs.skins[first.skin]->flow().params().largestDrop} * kCubicMillimetre / kPicolitre, 1.0);
        const auto count = static_cast<uint32_t>(std::max(std::ceil(static_cast<double>(volume) / most), 1.0));
        if (!hasRoom(inputs, first.skin, count)) continue;
        ++promised;
        // It may have met the skin some frames ago: then the drops begin there.
        const dvec3 touches = late > 0 ? glm::mix(from, to, double{first.where.share}) - way * (0.5 * spacing_) : x;
        claims->all.push_back({touches, v, std::cbrt(3 / (4 * std::numbers::pi)) * spacing_, {}});
        spread(inputs, from, first, count, then, claims->all.back());
        // A particle that the water has turned aside is elsewhere.
        asked.push_back({p.id, vec3(x), static_cast<float>(kAside * glm::length(dvec3(p.velocity)) * late + spacing_)});
        claimedAt_[p.id] = then;
    }
    if (!asked.empty()) {
        std::vector<size_t> order(asked.size());
        std::iota(order.begin(), order.end(), size_t{0});
        std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return asked[a].id < asked[b].id; });
        std::vector<ParticleClaim> sorted;
        sorted.reserve(order.size());
        for (const size_t k : order) sorted.push_back(asked[k]);
        claims->removed.assign(asked.size(), 0);
        claims_.push_back(claims);
        world.withdrawLater(sorted, [to = std::weak_ptr(claims), order = std::move(order)](std::span<const uint32_t> removed) {
            const auto c = to.lock();
            if (!c) return;
            for (size_t k = 0; k < removed.size(); ++k) c->removed[order[k]] = removed[k];
            c->answered = true;
        });
    }
    landClaimed(inputs);
}

// The drops of a particle, placed like sunflower seeds over the disc of its ball.
void AirDrops::spread(const Inputs& inputs, const dvec3& from, const FirstMet& first, uint32_t count, double then, Claim& into) {
    const double speed = glm::length(into.velocity);
    const dvec3 n = speed > 0 ? into.velocity / speed : -dvec3(first.where.normal);
    const dvec3 a = glm::normalize(glm::cross(n, std::abs(n.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0))), b = glm::cross(n, a);
    into.parts.reserve(count);
    for (uint32_t k = 0; k < count; ++k) {
        const double r = into.radius * std::sqrt((k + 0.5) / count), angle = k * (std::numbers::pi * (3 - std::sqrt(5.0)));
        const dvec3 off = (a * std::cos(angle) + b * std::sin(angle)) * r;
        Claim::Part& part = into.parts.emplace_back();
        part.drop = {into.position + off, into.velocity, 0, static_cast<uint32_t>(first.skin)};
        const FirstMet own = count == 1 ? first : firstMet(inputs.skins, from + off, into.position + off + n * (2 * spacing_), then);
        // The skin that the particle meets has slots reserved for all of them.
        if (own.skin == inputs.skins.size() || (own.skin != first.skin && !hasRoom(inputs, own.skin))) continue;
        part.lands = own.skin;
        part.where = own.where;
    }
}

// What the world has removed becomes drops.
void AirDrops::landClaimed(const Inputs& inputs) {
    while (!claims_.empty() && claims_.front()->answered) {
        const std::shared_ptr<const Claims> claims = claims_.front();
        claims_.pop_front();
        for (size_t i = 0; i < claims->all.size(); ++i) {
            if (claims->removed[i] == 0) continue;
            const std::vector<Claim::Part>& parts = claims->all[i].parts;
            const uint64_t volume = volumeOf(++particles_) - taken_, count = parts.size();
            taken_ += volume;
            for (uint64_t k = 0; k < count; ++k) {
                AirDrop drop = parts[k].drop;
                drop.picolitres = static_cast<uint32_t>(volume * (k + 1) / count - volume * k / count);
                if (parts[k].lands && inputs.skins[*parts[k].lands]->flow().room() > 0)
                    inputs.skins[*parts[k].lands]->land(parts[k].where, drop);
                else
                    add(drop);
            }
        }
    }
}

// Of each drop, the first place in the water on its way, as far as the world has answered.
std::vector<std::optional<vec3>> AirDrops::wetPlaces() {
    std::vector<std::optional<vec3>> wet(drops_.size());
    for (; !questions_.empty() && questions_.front()->answered; questions_.pop_front(), ++answered_) {
        const Question& q = *questions_.front();
        for (const Question::Way& way : q.ways) {
            const auto at = std::lower_bound(drops_.begin(), drops_.end(), way.drop,
                                             [](const AirDrop& d, uint64_t number) { return d.number < number; });
            if (at == drops_.end() || at->number != way.drop) continue;
            size_t k = 0;
            while (k < way.count && !(q.full[way.begin + k] > kWet)) ++k;
            if (k == way.count || way.until * static_cast<double>(way.count) < static_cast<double>(k + 1)) continue;
            std::optional<vec3>& place = wet[static_cast<size_t>(at - drops_.begin())];
            if (!place) place = q.places[way.begin + k];
        }
    }
    return wet;
}

// A drop in the air is a falling ball with drag; it ends on the first skin in its path, in the world's water, or on the ground.
Status AirDrops::fall(const Inputs& inputs, double seconds) {
    std::vector<AirDrop::End> ends;
    ends.reserve(drops_.size());
    const auto question = std::make_shared<Question>();
    FluidWorld* world = inputs.world;
    const double then = inputs.time + seconds, spacing = world != nullptr ? double{world->particles().spacing} : 0.0;
    for (AirDrop& d : drops_) {
        if (d.end) {
            ends.push_back(*d.end);
            continue;
        }
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
        AirDrop::End& end = ends.emplace_back();
        end.to = d.position + off + d.velocity * seconds;
        if (const FirstMet first = firstMet(inputs.skins, d.position, end.to, then); first.skin != inputs.skins.size()) {
            end.skin = first.skin;
            end.where = first.where;
        }
        if (world == nullptr || !isFinite(vec3(end.to))) continue;
        const auto count = static_cast<size_t>(std::min(std::ceil(glm::distance(d.position, end.to) / spacing), 64.0));
        if (count == 0) continue;
        question->ways.push_back({d.number, question->places.size(), count, end.skin ? double{end.where.share} : 2.0});
        for (size_t k = 0; k < count; ++k)
            question->places.emplace_back(glm::mix(d.position, end.to, static_cast<double>(k + 1) / static_cast<double>(count)));
        d.asked = answered_ + questions_.size() + 1;
    }
    if (!question->places.empty()) {
        questions_.push_back(question);
        const Status asked = world->sampleLater(question->places, [to = std::weak_ptr(question)](std::span<const FluidSample> samples) {
            const auto q = to.lock();
            if (!q) return;
            q->full.reserve(samples.size());
            for (const FluidSample& s : samples) q->full.push_back(s.density);
            q->answered = true;
        });
        if (!asked) {
            questions_.pop_back();
            return asked;
        }
    }
    const std::vector<std::optional<vec3>> wet = wetPlaces();
    size_t kept = 0;
    for (size_t i = 0; i < drops_.size(); ++i) {
        AirDrop& d = drops_[i];
        const AirDrop::End& end = ends[i];
        if (wet[i] && world != nullptr) {
            world->deposit(*wet[i], vec3(d.velocity), d.picolitres * kPicolitre);
            poured_ += d.picolitres;
            continue;
        }
        const bool somewhere = std::isfinite(glm::dot(end.to, end.to)) && glm::dot(end.to, end.to) < 1.0e12;
        const bool gone = !somewhere || end.to.y < inputs.floor;
        if (d.asked > answered_ && (end.skin || gone)) {
            if (!d.end && end.skin) d.position = glm::mix(d.position, end.to, double{end.where.share});
            d.end = end;
            if (kept != i) drops_[kept] = d;
            ++kept;
            continue;
        }
        d.end.reset();
        if (end.skin && hasRoom(inputs, *end.skin)) {
            inputs.skins[*end.skin]->land(end.where, d);
            continue;
        }
        d.position = end.to;
        if (d.hung && d.age > (kNeck + kSwings) * inertial(d, inputs.skins[d.skin]->flow().params())) d.hung.reset();
        if (gone) {
            drained_ += d.picolitres;
            continue;
        }
        if (kept != i) drops_[kept] = d;
        ++kept;
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
        if (d.end && d.end->skin) {
            d.end->skin = *d.end->skin < places.size() ? places[*d.end->skin] : std::nullopt;
            if (!d.end->skin) d.end.reset();  // it flies on
        }
        return !place;
    });
    for (const auto& claims : claims_)
        for (Claim& c : claims->all)
            for (Claim::Part& part : c.parts) {
                part.drop.skin = part.drop.skin < places.size() ? places[part.drop.skin].value_or(0) : 0;
                if (part.lands) part.lands = *part.lands < places.size() ? places[*part.lands] : std::nullopt;
            }
}

std::vector<vec4> AirDrops::drawn() const {
    std::vector<vec4> all;
    for (const AirDrop& d : drops_) {
        if (d.hung) continue;
        all.emplace_back(vec3(d.position), static_cast<float>(radiusOf(d)));
        all.emplace_back(vec3(d.velocity), 0.0F);
    }
    const std::vector<vec4> others = claimed();
    all.insert(all.end(), others.begin(), others.end());
    return all;
}

std::vector<vec4> AirDrops::claimed() const {
    std::vector<vec4> all;
    for (const auto& claims : claims_)
        for (const Claim& c : claims->all) {
            all.emplace_back(vec3(c.position), static_cast<float>(c.radius));
            all.emplace_back(vec3(c.velocity), 0.0F);
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
    // What the world reports as removed becomes drops with the next step.
    uint64_t removed = 0;
    for (const auto& claims : claims_)
        if (claims->answered) removed += static_cast<uint64_t>(std::count(claims->removed.begin(), claims->removed.end(), 1U));
    if (removed > 0) {
        const uint64_t volume = volumeOf(particles_ + removed) - taken_;
        c.taken += volume;
        c.air += volume;
    }
    return c;
}

}  // namespace rivulet
