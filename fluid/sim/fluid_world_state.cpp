// A world's state, put away and taken up again.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/sim/fluid_world_impl.h"

namespace rivulet {

Status FluidWorld::savable() const { return impl_->bodies.savable(); }

void FluidWorld::save(WorldState& state) {
    Impl& w = *impl_;
    ASSERT(savable(), "a world whose bodies cannot be saved");
    w.sources.report();
    w.device->finish();
    w.device->poll();
    state.putText("world.params", fixedValues([&w](ParamVisitor& v) { w.params.visit(v); }));
    const FluidStats& f = *w.figures;
    const double numbers[] = {w.time,
                              w.pace.pending(),
                              w.dropped,
                              w.dtMin,
                              w.dtMax,
                              f.maxSpeed,
                              w.fastestWall,
                              w.fastestEver,
                              static_cast<double>(w.frame),
                              w.params.origin.x,
                              w.params.origin.y,
                              w.params.origin.z};
    state.put<double>("world.numbers", numbers);
    state.putText("world.limited", fmt::format("{}", fmt::join(f.limited, "\n")));
    w.particles.save(*w.device, state);
    for (const NamedBuffer& b : w.method->remembered())
        state.put<float>(fmt::format("method.{}", b.name), w.device->readAll<float>(*b.buffer, b.buffer->bytes() / sizeof(float)));
    w.solids.save(state);
    w.sources.save(state);
    if (w.foam) w.foam->save(state);
    if (w.exchange.any()) state.put<uint64_t>("world.taken", std::span(&w.takenOut, 1));
    w.volumes.save(state);
    w.bodies.save(state);
}

Status FluidWorld::restore(WorldState& state) {
    Impl& w = *impl_;
    if (Status can = savable(); !can) return can;
    // All of it is taken and judged before anything changes.
    Result<std::string> params = state.takeText("world.params");
    if (!params) return params.error();
    if (Status same = sameFixedValues(*params, fixedValues([&w](ParamVisitor& v) { w.params.visit(v); })); !same) return same;
    Result<std::vector<double>> numbers = state.take<double>("world.numbers", 12);
    if (!numbers) return numbers.error();
    const std::vector<double>& n = *numbers;
    if (std::any_of(n.begin(), n.end(), [](double v) { return !std::isfinite(v); }) ||
        std::any_of(n.begin(), n.begin() + 9, [](double v) { return v < 0; }))
        return badInput("the saved state's numbers make no sense: save it again");
    Result<std::string> limited = state.takeText("world.limited");
    if (!limited) return limited.error();
    Result<Particles::Saved> saved = w.particles.take(state);
    if (!saved) return saved.error();
    const std::vector<NamedBuffer> remembered = w.method->remembered();
    std::vector<std::vector<float>> memory;
    for (const NamedBuffer& b : remembered) {
        Result<std::vector<float>> values = state.take<float>(fmt::format("method.{}", b.name), b.buffer->bytes() / sizeof(float));
        if (!values) return values.error();
        memory.push_back(std::move(*values));
    }
    Result<SolidPasses::Places> places = w.solids.take(state);
    if (!places) return places.error();
    Result<SourcePasses::Saved> sources = w.sources.take(state);
    if (!sources) return sources.error();
    uint64_t taken = 0;
    if (w.exchange.any()) {
        Result<std::vector<uint64_t>> count = state.take<uint64_t>("world.taken", 1);
        if (!count) return count.error();
        taken = (*count)[0];
    }
    FoamPasses::Saved foam;
    if (w.foam) {
        Result<FoamPasses::Saved> foamed = w.foam->take(state);
        if (!foamed) return foamed.error();
        foam = std::move(*foamed);
    }
    Result<VolumePasses::Saved> volumes = VolumePasses::take(state, w.slots);
    if (!volumes) return volumes.error();
    Result<BodyPasses::Saved> bodies = w.bodies.take(state);
    if (!bodies) return bodies.error();
    if (Status all = state.allTaken(); !all) return all;
    if (Status moved = w.bodies.restore(*bodies); !moved) return moved;  // the last host that can object

    w.writeStart();
    w.particles.restore(*w.device, *saved);
    w.gatherColours();
    w.sources.restore(*sources);
    w.takenOut = taken;
    if (w.foam) w.foam->restore(foam);
    for (size_t k = 0; k < remembered.size(); ++k) w.device->writeAll<float>(*remembered[k].buffer, memory[k]);
    w.time = n[0];
    w.pace.reset(n[1]);
    w.dropped = n[2];
    w.dtMin = n[3];
    w.dtMax = n[4];
    w.knowFastest(n[5]);
    for (const vec4& v : saved->velocity)
        if (isFinite(vec3(v))) w.fastestStart = std::max(w.fastestStart, glm::length(vec3(v)));
    w.fastestWall = static_cast<float>(n[6]);
    w.fastestEver = static_cast<float>(n[7]);
    w.frame = static_cast<uint64_t>(n[8]);
    w.params.origin = dvec3(n[9], n[10], n[11]);
    FluidStats& f = *w.figures;
    const double volume = std::pow(double{w.params.spacing}, 3);
    f.frame = w.frame;
    f.time = w.time;
    f.particles =
        static_cast<uint32_t>(std::count_if(saved->position.begin(), saved->position.end(), [](const vec4& p) { return !(p.w < 0); }));
    f.emitted = (static_cast<double>(w.start.size()) + static_cast<double>(w.sources.given())) * volume;
    f.drained = static_cast<double>(w.sources.drained()) * volume;
    f.owed = w.sources.owed() * volume;
    f.poured = static_cast<double>(w.sources.born()) * volume;
    f.debt = w.sources.debt() * volume;
    f.taken = static_cast<double>(w.takenOut) * volume;
    for (size_t at = 0; at < limited->size();) {
        const size_t end = std::min(limited->find('\n', at), limited->size());
        f.limited.push_back(limited->substr(at, end - at));
        at = end + 1;
    }
    if (Status watched = w.volumes.restore(*w.device, *volumes, w.slots, volume); !watched) return watched;
    return w.solids.restore(*places);
}

}  // namespace rivulet
