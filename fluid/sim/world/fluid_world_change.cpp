// What is added to a world and removed from it while it runs: walls, bodies, emitters, sinks.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

Status FluidWorld::mayChangeWalls() const {
    if (!impl_->traits.walls)
        return badInput("the box is periodic along all axes, and the world began without walls: create it with a wall");
    return ok();
}

Status FluidWorld::setWalls(const Solids& solids, std::span<const Pose> poses, bool removeInside) {
    Impl& w = *impl_;
    if (Status can = w.mayChange(); !can) return can;
    if (Status may = mayChangeWalls(); !may) return may;
    ProbeTargets targets = ProbeTargets::of(solids);
    targets.bodies = w.probeTargets.bodies;
    if (!w.params.probes.empty())  // before anything changes
        if (const auto may = ProbePasses::create(*w.device, w.params, targets, {w.solids, w.bodies, w.particles, *w.grid, w.traits}); !may)
            return may.error();
    std::vector<Pose> now(poses.begin(), poses.end());
    if (now.empty())
        for (const RigidSolid& rigid : solids.rigid) now.push_back(rigid.pose);
    std::optional<WetPasses> wet;
    if (w.wet) {
        Result<WetPasses> made =
            w.wet->with(w.wetParts(WetSurface::partsOf({.field = solids.field, .rigid = solids.rigid})), w.params.spacing);
        if (!made) return made.error();
        wet.emplace(std::move(*made));
    }
    if (Status done = w.solids.replace(solids, now, w.params, w.traits.threadDefines()); !done) return done;
    w.probeTargets = std::move(targets);
    if (wet) w.wet = std::move(wet);
    w.change();
    w.solidsChanged = true;
    w.posesBefore.clear();
    if (w.sleep) w.sleep->disturbAll(w.clock.time);
    if (!w.params.probes.empty())
        if (Status done = w.prepareProbes(w.params); !done) {
            w.probes.reset();  // it reads walls that are gone
            w.report(done.error().message);
        }
    // The walls have changed: what follows may fail, and is then no error of this call.
    if (removeInside && w.solids.anyAdded()) {
        const auto inside = [&w](const vec3& p) { return w.solids.insideAdded(p, w.params.spacing); };
        if (Status removed = w.removeInside(inside, "wall"); !removed) w.log.warning(removed.error().message);
    }
    return ok();
}

std::vector<WetSurface::Part> FluidWorld::Impl::wetParts(std::vector<WetSurface::Part> ofWalls) const {
    for (size_t k = 0; k < bodies.states().size(); ++k) WetSurface::addBody(ofWalls, bodies.body(k), bodies.ids()[k]);
    return ofWalls;
}

Status FluidWorld::Impl::mayChange() const {
    if (device->stopAsked()) return failed("nothing was changed: a stop is asked, end it first");
    return whole();
}

Status FluidWorld::Impl::mayChangeBodies() const {
    if (stepping) return badInput("a step is under way: add and remove bodies between steps");
    return mayChange();
}

FluidWorld::Impl::BodyLists FluidWorld::Impl::bodyLists() const {
    BodyLists lists{.forProbes = bodies.ids(), .forDry = bodies.ids(), .starts = bodies.starts()};
    const size_t most = bodies.ids().size() + 1;
    lists.forProbes.reserve(most);
    lists.forDry.reserve(most);
    lists.starts.reserve(most);
    return lists;
}

template <class Work>
bool FluidWorld::Impl::afterChange(const Work& work) {
    try {
        work();
        return true;
    } catch (const std::bad_alloc&) {
        try {
            log.warning("there is not enough memory for all that follows a change of walls or bodies: water inside may stay");
        } catch (const std::bad_alloc&) {  // NOLINT(bugprone-empty-catch): nor for this
        }
        if (sleep) sleep->disturbAll(clock.time);
        return false;
    }
}

void FluidWorld::Impl::bodiesChanged(BodyLists lists) {
    revision = std::move(lists.revision);
    probeTargets.bodies = std::move(lists.forProbes);
    dry.bodiesChanged(std::move(lists.forDry), std::move(lists.starts));
    if (!bodies.matter().empty())
        device->write(particles.matterOf, std::as_bytes(std::span(bodies.matter())), size_t{slots} * sizeof(vec4));
    invalidateCells();
    afterChange([this] {  // a substep begins with this, too
        StepParams s{};
        s.count = particles.count;
        grid->fill(s);
        bodies.place(s, particles);
    });
}

Result<uint32_t> FluidWorld::addBody(const Body& body, bool removeInside, std::optional<uint32_t> id) {
    Impl& w = *impl_;
    const uint32_t own = id.value_or(w.bodies.nextId());
    if (Status may = w.mayChangeBodies(); !may) return may.error();
    w.bodies.settle();
    if (Status sound = BodyPasses::check(body); !sound) return sound.error();
    for (const vec3& sample : body.meetsWater ? body.shape.samples : std::vector<vec3>())
        if (const vec3 p = body.state.pose.toWorld(sample); !w.solids.maySpawn(p, w.params.spacing, 0))
            return badInput(
                fmt::format("the body would be inside a wall, at ({:.3g}, {:.3g}, {:.3g}) m: place it elsewhere", p.x, p.y, p.z));
    std::optional<WetPasses> wet;
    if (w.wet) {
        std::vector<WetSurface::Part> parts = w.wetParts(w.solids.wetParts());
        WetSurface::addBody(parts, body, own);
        Result<WetPasses> made = w.wet->with(parts, w.params.spacing);
        if (!made) return made.error();
        wet.emplace(std::move(*made));
    }
    Impl::BodyLists lists = w.bodyLists();
    lists.forProbes.push_back(own);
    lists.forDry.push_back(own);
    lists.starts.push_back(body.state.pose);
    w.device->goOn();
    if (Status added = w.bodies.add(body, own, w.params); !added) return added.error();
    if (wet) w.wet = std::move(wet);
    w.solidsChanged = true;
    w.bodiesChanged(std::move(lists));
    const size_t last = w.bodies.states().size() - 1;
    w.afterChange([&] {
        if (w.sleep && body.meetsWater) w.disturbAround(w.bodies.boundsOf(last));
        if (!removeInside || !body.meetsWater || !body.shape.distance) return;
        const auto inside = [&w, last](const vec3& p) { return w.bodies.inside(last, p, w.params.spacing); };
        if (Status removed = w.removeInside(inside, "body"); !removed) w.log.warning(removed.error().message);
    });
    return own;
}

Status FluidWorld::removeBody(uint32_t id) {
    Impl& w = *impl_;
    if (Status may = w.mayChangeBodies(); !may) return may;
    w.bodies.settle();
    const std::vector<uint32_t>& ids = w.bodies.ids();
    const auto at = static_cast<size_t>(std::ranges::find(ids, id) - ids.begin());
    if (at == ids.size()) return badInput(fmt::format("there is no body {}", id));
    for (size_t k = 0; k < w.dry.params().size(); ++k)
        if (w.dry.params()[k].body == static_cast<int>(id))
            return badInput(fmt::format("dry[{}] moves with body {}: remove the dry volume first", k, id));
    bool probed = false;
    for (size_t k = 0; k < w.params.probes.size(); ++k) {
        const ProbeParams& p = w.params.probes[k];
        if (p.on != "body") continue;
        probed = true;
        if (p.index == static_cast<int>(id))
            return badInput(fmt::format(
                "fluid.probes[{}] measures body {}: set fluid.probes[{}].on to box, or .index to another body, first", k, id, k));
        if (ids.size() == 1)
            return badInput(fmt::format(
                "fluid.probes[{}] measures all bodies, and body {} is the last: set fluid.probes[{}].on to box first", k, id, k));
    }
    std::optional<WetPasses> wet;
    if (w.wet) {
        std::vector<WetSurface::Part> parts = w.solids.wetParts();
        for (size_t k = 0; k < ids.size(); ++k)
            if (k != at) WetSurface::addBody(parts, w.bodies.body(k), ids[k]);
        Result<WetPasses> made = w.wet->with(parts, w.params.spacing);
        if (!made) return made.error();
        wet.emplace(std::move(*made));
    }
    Impl::BodyLists lists = w.bodyLists();
    const auto offset = static_cast<std::ptrdiff_t>(at);
    lists.forProbes.erase(lists.forProbes.begin() + offset);
    lists.forDry.erase(lists.forDry.begin() + offset);
    lists.starts.erase(lists.starts.begin() + offset);
    w.device->goOn();
    const Bounds place = w.bodies.boundsOf(at);
    if (Status gone = w.bodies.remove(at); !gone) return gone;
    if (wet) w.wet = std::move(wet);
    w.bodiesChanged(std::move(lists));
    if (w.sleep) {
        w.afterChange([&] { w.disturbAround(place); });
        if (std::vector<Pose>& poses = w.sleep->bodyPoses(); at < poses.size()) poses.erase(poses.begin() + offset);
    }
    if (!probed) return ok();
    const bool enough = w.afterChange([&] {  // they name bodies by their places among the others
        if (Status done = w.prepareProbes(w.params); !done) {
            w.probes.reset();
            w.report(done.error().message);
        }
    });
    if (!enough) w.probes.reset();
    return ok();
}

Status FluidWorld::Impl::removeInside(const std::function<bool(const vec3&)>& within, const char* what) {
    std::vector<uint32_t> inside;
    std::vector<NamedBuffer> remembered;
    try {
        const std::vector<vec4> read = device->readAll<vec4>(particles.positionNext, particles.count);
        const std::vector<uint32_t> id = device->readAll<uint32_t>(particles.id, particles.count);
        for (uint32_t k = 0; k < particles.count; ++k)
            if (const vec4& p = read[k]; !(p.w < 0) && id[k] < slots && isFinite(vec3(p)) && within(vec3(p))) inside.push_back(k);
        remembered = method->remembered();
    } catch (const std::bad_alloc&) {
        return noMemory(fmt::format("there is not enough memory to find the particles inside a {}: they stay", what));
    }
    const auto stopped = [what] {
        return failed(fmt::format("a stop was asked while the particles inside a {} were removed: some stay", what));
    };
    if (device->interrupted()) return stopped();
    if (inside.empty()) return ok();
    Result<ExchangePasses> passes = ExchangePasses::create(*device);
    if (!passes) return passes.error();
    invalidateCells();
    hasFree = true;
    for (std::span<const uint32_t> rest = inside; !rest.empty();) {
        const std::span<const uint32_t> some = rest.first(std::min(rest.size(), ExchangePasses::kMost));
        passes->take(step, *grid, particles, remembered, some, sorted);
        if (device->interrupted()) return stopped();
        before.drained += some.size();
        rest = rest.subspan(some.size());
    }
    change();
    if (sleep) sleep->slotsChange();
    grid->sortAsleep();
    fillLedger(*figures);
    log.notice(fmt::format("{} particles were removed: a {} is now where they were", inside.size(), what));
    return ok();
}

void FluidWorld::Impl::setDry(const std::vector<DryParams>& volumes) {
    if (volumes == dry.params()) return;  // a slider of the look sets them again
    dry.set(volumes, bodies.ids(), bodies.starts(), bodies.states());
    hasFree = true;
}

Status FluidWorld::Impl::replaceSources(const Sources& next) {
    if (traits.linked) return badInput("fluid.grid linked_list does not support emitters and sinks: choose fluid.grid sorted");
    for (size_t k = 0; k < next.emitters.size(); ++k)
        if (const EmitterParams& e = next.emitters[k].params; !traits.matter && liquidOf(params, e.liquid).row != 0)
            return badInput(
                fmt::format("emitters[{}].liquid is {}, and the world began with one liquid: create it with a block or an emitter of "
                            "another one",
                            k, e.liquid));
    if (sourceSetup.expectedDeposit > 0)
        return badInput("the number of emitters or sinks has changed in a world that exchanges water with others: create a new world");
    Sources setup = sourceSetup;
    setup.emitters = next.emitters;
    setup.sinks = next.sinks;
    Result<SourcePasses> made = SourcePasses::create(*device, setup, params, traits.matter, coloured);
    if (!made) return made.error();
    sources.report();
    device->finish();
    device->poll();
    before.emitted += sources.emitted();
    before.drained += sources.drained();
    sources = std::move(*made);
    sourceSetup = std::move(setup);
    hasFree = hasFree || sources.any();
    findLiquids();
    if (sleep) sleep->disturbAll(clock.time);
    return ok();
}

}  // namespace rivulet
