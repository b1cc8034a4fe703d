#include "fluid/scene/skin_flows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/scene/scene_file.h"

namespace rivulet {

namespace {

constexpr double kPicolitre = 1.0e-15, kCubicMillimetre = 1.0e-9;  // m^3

}  // namespace

Status SkinFlows::create(const SceneFile& scene, Device& device, Scene& nodes, const Log& log) {
    firstNode_ = nodes.nodes().size();
    pools_ = expectedDeposit(scene, 0) > 0;
    for (size_t k = 0; k < scene.flow.size(); ++k) {
        auto made = FlowComponent::create(scene.flow[k], scene.folder, device, nodes, log);
        if (!made) return Error{fmt::format("flow[{}]: {}", k, made.error().message), made.error().fault};
        skins_.push_back(std::move(*made));
        placed_.push_back(&skins_.back()->placed());
    }
    Bounds all;
    for (const auto& skin : skins_) {
        all.add(skin->bounds().min);
        all.add(skin->bounds().max);
    }
    // Without a shown floor, a drop is gone that has fallen below all skins by their overall size.
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

void SkinFlows::apply(const SceneFile& scene, Scene& nodes) {
    for (size_t k = 0; k < std::min(skins_.size(), scene.flow.size()); ++k) {
        skins_[k]->apply(scene.flow[k]);
        skins_[k]->placeNode(nodes);  // its look, also while the run is paused
    }
}

Status SkinFlows::reset(const SceneFile& scene, Device& device, Scene& nodes, const Log& log) {
    if (empty()) return ok();
    nodes.nodes().resize(firstNode_);
    *this = SkinFlows();
    return create(scene, device, nodes, log);
}

struct SkinFlows::Snapshot {
    std::vector<std::shared_ptr<const FlowComponent::Snapshot>> skins;
    AirDrops air;
    uint64_t dripped = 0;
    double time = 0;
};

std::shared_ptr<const SkinFlows::Snapshot> SkinFlows::save() const {
    auto made = std::make_shared<Snapshot>();
    for (const auto& skin : skins_) made->skins.push_back(skin->save());
    made->air = air_.copy();
    made->dripped = dripped_;
    made->time = time_;
    return made;
}

Status SkinFlows::moveTo(Device& device, SceneFile scene, Scene& nodes, const Log& log, const Snapshot* from) {
    // An edit may be pending: keep the values that the skins were made with.
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
    air_ = from->air.copy();
    dripped_ = from->dripped;
    time_ = from->time;
    return ok();
}

double SkinFlows::expectedDeposit(const SceneFile& scene, double seconds) {
    if (scene.flow.empty() || (scene.fluid.blocks.empty() && scene.emitters.empty())) return 0;
    double volume = std::pow(double{scene.fluid.spacing}, 3);
    for (const FlowParams& skin : scene.flow)
        for (const FlowSourceParams& source : skin.sources)
            volume += double{skin.amount} * double{source.rate} * kCubicMillimetre / 60 * seconds;
    return volume;
}

Status SkinFlows::step(const SceneFile& scene, FluidWorld& world, double seconds, Scene& nodes) {
    if (empty() || !(seconds > 0)) return ok();
    std::vector<vec3> winds;
    for (const auto& skin : skins_) winds.push_back(skin->params().wind);
    const AirDrops::Inputs around{.skins = placed_,
                                  .world = pools_ ? &world : nullptr,
                                  .gravity = scene.fluid.gravity,
                                  .winds = winds,
                                  .floor = floor_,
                                  .time = time_};
    if (Status fallen = air_.step(around, seconds); !fallen) return fallen;
    for (size_t k = 0; k < skins_.size(); ++k) {
        std::vector<AirDrop> left;
        Status moved = skins_[k]->step(time_, seconds, scene.fluid.gravity, left);
        for (AirDrop& drop : left) {
            drop.skin = static_cast<uint32_t>(k);
            air_.add(drop);
        }
        if (!moved) return moved;
        skins_[k]->placeNode(nodes);
    }
    time_ += seconds;
    return ok();
}

Status SkinFlows::draw() {
    for (const auto& skin : skins_)
        if (Status drawn = skin->draw(); !drawn) return drawn;
    return ok();
}

std::vector<vec4> SkinFlows::pendants() const {
    std::vector<vec4> rows;
    const auto add = [&](const HungDrop& d, size_t skin) { addPendant(d, skins_[skin]->params().look.absorption, rows); };
    for (size_t k = 0; k < placed_.size(); ++k)
        for (const HungDrop& d : placed_[k]->hanging()) add(d, k);
    for (const AirDrops::LetGo& d : air_.letGo(placed_)) add(d.shape, d.skin);
    return rows;
}

bool SkinFlows::drip(const dvec3& from, const dvec3& way, uint32_t picolitres) {
    const FirstMet first = firstMet(placed_, from, from + way, time_);
    if (first.skin == placed_.size()) return false;
    placed_[first.skin]->land(first.where, {dvec3(0.0), dvec3(0.0), picolitres});
    dripped_ += picolitres;
    return true;
}

SkinFlows::Counted SkinFlows::counted() const {
    const AirDrops::Counts air = air_.counts();
    Counted c{.emitted = dripped_, .taken = air.taken, .air = air.air, .drained = air.drained, .poured = air.poured};
    for (const auto& skin : skins_) c.emitted += skin->emitted();  // with the brims' initial content
    return c;
}

void SkinFlows::Counted::add(const SurfaceFlow::Ledger& own) {
    surface += own.drops + own.film;
    evaporated += own.evaporated;
    refused += own.refused;
    air += own.left - own.handed;  // reported late by a GPU: AirDrops gets it with the next step
}

SkinFlows::Ledger SkinFlows::Counted::ledger() const {
    Ledger l;
    l.emitted = static_cast<double>(emitted) * kPicolitre;
    l.taken = static_cast<double>(taken) * kPicolitre;
    l.poured = static_cast<double>(poured) * kPicolitre;
    l.onSurface = static_cast<double>(surface) * kPicolitre;
    l.inAir = static_cast<double>(air) * kPicolitre;
    l.evaporated = static_cast<double>(evaporated) * kPicolitre;
    l.drained = static_cast<double>(drained + refused) * kPicolitre;  // a drop without a slot was never added
    const uint64_t there = surface + air + evaporated + drained + refused + poured, came = emitted + taken;
    l.error = static_cast<double>(std::max(there, came) - std::min(there, came)) * kPicolitre;
    return l;
}

SkinFlows::Ledger SkinFlows::ledger() const {
    std::vector<SurfaceFlow::Ledger> own;
    own.reserve(skins_.size());
    for (const auto& skin : skins_) own.push_back(skin->flow().ledger());
    Counted c = counted();  // then all that the device reports has arrived
    for (const SurfaceFlow::Ledger& l : own) c.add(l);
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
