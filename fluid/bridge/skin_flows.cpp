#include "fluid/bridge/skin_flows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid/bridge/scene_file.h"

namespace rivulet {

namespace {

constexpr double kPicolitre = 1.0e-15;  // m^3
constexpr double kAirDensity = 1.2;     // kg/m^3
constexpr double kBallDrag = 0.6;       // drag coefficient of a drop that falls

}  // namespace

Status SkinFlows::create(const SceneFile& scene, Device& device, Scene& nodes, const Log& log) {
    firstNode_ = nodes.nodes().size();
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

// In the air a drop is a ball that falls and drags; it ends on the first skin in its way, or on the ground.
void SkinFlows::fall(const SceneFile& scene, double seconds) {
    const vec3 wind = scene.flow.empty() ? vec3(0.0F) : scene.flow[0].wind;
    size_t kept = 0;
    for (FlowComponent::AirDrop& d : air_) {
        const double density = scene.flow.empty() ? 1000 : double{scene.flow[0].liquid.density}, volume = d.picolitres * kPicolitre;
        const double radius = std::cbrt(3 * volume / (4 * std::numbers::pi));
        const dvec3 against = dvec3(wind) - d.velocity;
        // Implicit in the drag: no step makes it turn round.
        const double drag = 0.5 * kAirDensity * kBallDrag * std::numbers::pi * radius * radius * glm::length(against) / (density * volume);
        d.velocity += (dvec3(scene.fluid.gravity) + against * drag) * seconds / (1 + drag * seconds);
        const dvec3 to = d.position + d.velocity * seconds;
        FlowComponent* first = nullptr;
        SkinSearch::Hit where;
        for (const auto& skin : skins_)
            if (const std::optional<SkinSearch::Hit> hit = skin->meets(d.position, to);
                hit && (first == nullptr || hit->share < where.share)) {
                first = skin.get();
                where = *hit;
            }
        if (first != nullptr) {
            first->land(where, d);
            continue;
        }
        d.position = to;
        const bool somewhere = std::isfinite(glm::dot(to, to)) && glm::dot(to, to) < 1.0e12;
        if (!somewhere || to.y < floor_)
            drained_ += d.picolitres;
        else
            air_[kept++] = d;
    }
    air_.resize(kept);
}

Status SkinFlows::step(const SceneFile& scene, FluidWorld& world, double seconds, Scene& nodes) {
    (void)world;
    if (empty() || !(seconds > 0)) return ok();
    fall(scene, seconds);
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

bool SkinFlows::drip(const dvec3& from, const dvec3& way, uint32_t picolitres) {
    FlowComponent* first = nullptr;
    SkinSearch::Hit where;
    for (const auto& skin : skins_)
        if (const std::optional<SkinSearch::Hit> hit = skin->meets(from, from + way);
            hit && (first == nullptr || hit->share < where.share)) {
            first = skin.get();
            where = *hit;
        }
    if (first == nullptr) return false;
    first->land(where, {dvec3(0.0), dvec3(0.0), picolitres});
    dripped_ += picolitres;
    return true;
}

SkinFlows::Ledger SkinFlows::ledger() const {
    Ledger l;
    uint64_t emitted = dripped_, surface = 0, evaporated = 0, air = 0, refused = 0;
    for (const auto& skin : skins_) {
        const SurfaceFlow::Ledger own = skin->flow().ledger();
        emitted += skin->emitted();  // with what lay in its brims at the start
        surface += own.drops + own.film;
        evaporated += own.evaporated;
        refused += own.refused;
    }
    for (const FlowComponent::AirDrop& d : air_) air += d.picolitres;
    l.emitted = static_cast<double>(emitted) * kPicolitre;
    l.onSurface = static_cast<double>(surface) * kPicolitre;
    l.inAir = static_cast<double>(air) * kPicolitre;
    l.evaporated = static_cast<double>(evaporated) * kPicolitre;
    l.drained = static_cast<double>(drained_ + refused) * kPicolitre;  // where there was no slot nothing was let out
    const auto there = static_cast<double>(surface + air + evaporated + drained_ + refused);
    l.error = emitted > 0 ? std::abs(there - static_cast<double>(emitted)) / static_cast<double>(emitted) : 0;
    return l;
}

}  // namespace rivulet
