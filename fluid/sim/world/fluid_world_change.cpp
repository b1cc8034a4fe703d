// What is added to a world and removed from it while it runs: walls, emitters, sinks.
#include <fmt/format.h>

#include <algorithm>

#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

Status FluidWorld::mayChangeWalls() const {
    if (!impl_->traits.walls)
        return badInput("the box is periodic along all axes, and the world began without walls: create it with a wall");
    if (impl_->wet)
        return badInput("fluid.wetness.on: the surfaces that get wet are those at the start: set it to false, or create a new world");
    return ok();
}

Status FluidWorld::setWalls(const Solids& solids, std::span<const Pose> poses, bool removeInside) {
    Impl& w = *impl_;
    if (Status whole = w.whole(); !whole) return whole;
    if (Status may = mayChangeWalls(); !may) return may;
    ProbeTargets targets = ProbeTargets::of(solids);
    targets.bodies = w.probeTargets.bodies;
    if (!w.params.probes.empty())  // before anything changes
        if (const auto may = ProbePasses::create(*w.device, w.params, targets, {w.solids, w.bodies, w.particles, *w.grid, w.traits}); !may)
            return may.error();
    std::vector<Pose> now(poses.begin(), poses.end());
    if (now.empty())
        for (const RigidSolid& rigid : solids.rigid) now.push_back(rigid.pose);
    if (Status done = w.solids.replace(solids, now, w.params, w.traits.threadDefines()); !done) return done;
    w.probeTargets = std::move(targets);
    w.posesBefore.clear();
    if (w.sleep) w.sleep->disturbAll(w.clock.time);
    if (!w.params.probes.empty())
        if (Status done = w.prepareProbes(w.params); !done) {
            w.probes.reset();  // it reads walls that are gone
            w.report(done.error().message);
        }
    // The walls have changed: what follows may fail, and is then no error of this call.
    if (removeInside && w.solids.any())
        if (Status removed = w.removeInside(); !removed) w.log.warning(removed.error().message);
    return ok();
}

Status FluidWorld::Impl::removeInside() {
    if (!solids.anyAdded()) return ok();
    std::vector<uint32_t> inside;
    std::vector<NamedBuffer> remembered;
    try {
        const std::vector<vec4> read = device->readAll<vec4>(particles.positionNext, particles.count);
        const std::vector<uint32_t> id = device->readAll<uint32_t>(particles.id, particles.count);
        for (uint32_t k = 0; k < particles.count; ++k)
            if (const vec4& p = read[k]; !(p.w < 0) && id[k] < slots && isFinite(vec3(p)) && solids.insideAdded(vec3(p), params.spacing))
                inside.push_back(k);
        remembered = method->remembered();
    } catch (const std::bad_alloc&) {
        return noMemory("there is not enough memory to find the particles inside a wall: they stay");
    }
    if (inside.empty()) return ok();
    Result<ExchangePasses> passes = ExchangePasses::create(*device);
    if (!passes) return passes.error();
    invalidateCells();
    for (std::span<const uint32_t> rest = inside; !rest.empty();) {
        const std::span<const uint32_t> some = rest.first(std::min(rest.size(), ExchangePasses::kMost));
        passes->take(step, *grid, particles, remembered, some, sorted);
        rest = rest.subspan(some.size());
    }
    hasFree = true;
    before.drained += inside.size();
    change();
    if (sleep) sleep->slotsChange();
    grid->sortAsleep();
    fillLedger(*figures);
    log.notice(fmt::format("{} particles were removed: a wall is now where they were", inside.size()));
    return ok();
}

void FluidWorld::Impl::setDry(const std::vector<DryParams>& volumes) {
    if (volumes.empty() && !dry.any()) return;
    dry.set(volumes, bodies.starts(), bodies.states());
    hasFree = true;
    if (sleep) sleep->disturbAll(clock.time);
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
