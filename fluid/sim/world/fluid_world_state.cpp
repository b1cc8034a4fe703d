// The state of a world, saved and restored.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/assert.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_world_impl.h"
#include "fluid/sim/world/state_check.h"

namespace rivulet {

// Where a particle may be that is not lost: the grid's outermost cells reach beyond the box.
Bounds FluidWorld::Impl::reachable() const {
    const vec3 h(params.supportSpacings * params.spacing);
    return {params.box.min - h, params.box.max + 2.0F * h};
}

Status FluidWorld::savable() const {
    if (Status whole = impl_->whole(); !whole) return whole;
    return impl_->bodies.savable();
}

void FluidWorld::save(WorldState& state) {
    Impl& w = *impl_;
    ASSERT(savable(), "a world whose bodies cannot be saved");
    w.sources.report();
    w.dry.report();
    w.bodies.settle();
    w.device->finish();
    w.device->poll();
    state.putText("world.params", fixedValues([&w](ParamVisitor& v) { w.params.visit(v); }));
    const FluidStats& f = *w.figures;
    const double numbers[] = {w.clock.time,         w.stepper.pending(),  w.clock.dropped,
                              w.clock.dtMin,        w.clock.dtMax,        f.maxSpeed,
                              w.limits.fastestWall, w.limits.fastestEver, static_cast<double>(w.clock.frame),
                              w.params.origin.x,    w.params.origin.y,    w.params.origin.z};
    state.put<double>("world.numbers", numbers);
    if (w.startCount != w.start.size()) state.put<uint32_t>("world.begun", std::span(&w.startCount, 1));
    state.putText("world.limited", fmt::format("{}", fmt::join(f.limited, "\n")));
    w.particles.save(*w.device, state, w.reachable(), w.traits.samples);
    for (const NamedBuffer& b : w.method->remembered())
        state.put<float>(fmt::format("method.{}", b.name), w.device->readAll<float>(*b.buffer, b.buffer->bytes() / sizeof(float)));
    if (w.sleep) {
        w.sleep->save(state);
        state.put<vec3>("sleep.gravity", std::span(&w.sleptUnder, 1));
    }
    w.solids.save(state);
    w.sources.save(state);
    if (w.foam) w.foam->save(state);
    if (w.wet) w.wet->save(state);
    if (w.exchange.any()) state.put<uint64_t>("world.taken", std::span(w.withdrawn.get(), 1));
    if (const uint64_t before[] = {w.before.emitted, w.before.drained + w.dry.removed()}; before[0] + before[1] > 0)
        state.put<uint64_t>("world.sourcesBefore", before);
    w.volumes.save(state);
    w.bodies.save(state);
}

Status FluidWorld::restore(WorldState& state) {
    Impl& w = *impl_;
    w.change();
    if (Status can = w.bodies.savable(); !can) return can;
    // All of it is read and checked before anything changes.
    Result<std::string> params = state.takeText("world.params");
    if (!params) return params.error();
    if (Status same = sameFixedValues(*params, fixedValues([&w](ParamVisitor& v) { w.params.visit(v); })); !same) return same;
    Result<std::vector<double>> numbers = state.take<double>("world.numbers", 12);
    if (!numbers) return numbers.error();
    const std::vector<double>& n = *numbers;
    // As save() writes them; the last three are an origin.
    constexpr double kMost[] = {kLatest, 0.2, 1.0e12, kLatest, kLatest, 1.0e9, 1.0e9, 1.0e9, 0x1p53, 1.0e15, 1.0e15, 1.0e15};
    for (size_t k = 0; k < n.size(); ++k)
        if (const double least = k < 9 ? 0 : -kMost[k]; !(n[k] >= least && n[k] <= kMost[k]))
            return outOfRange("world.numbers", k, n[k], least, kMost[k]);
    std::optional<uint32_t> startCount;
    if (state.sections().contains("world.begun")) {
        Result<std::vector<uint32_t>> count = state.take<uint32_t>("world.begun", 1);
        if (!count) return count.error();
        startCount = (*count)[0];
        if (*startCount > w.slots) return outOfRange("world.begun", 0, static_cast<double>(*startCount), 0, static_cast<double>(w.slots));
    }
    Result<std::string> limited = state.takeText("world.limited");
    if (!limited) return limited.error();
    constexpr size_t kLongestText = size_t{1} << 16U;
    if (limited->size() > kLongestText ||
        std::ranges::any_of(*limited, [](char c) { return c != '\n' && static_cast<unsigned char>(c) < ' '; }))
        return badInput("section world.limited of the saved state is not a text: save it again");
    Result<BodyPasses::Saved> bodies = w.bodies.take(state);
    if (!bodies) return bodies.error();
    Result<Particles::Saved> saved = w.particles.take(state, w.reachable(), w.bodies.matter(bodies->first));
    if (!saved) return saved.error();
    const std::vector<NamedBuffer> remembered = w.method->remembered();
    std::vector<std::vector<float>> memory;
    for (const NamedBuffer& b : remembered) {
        Result<std::vector<float>> values = state.take<float>(fmt::format("method.{}", b.name), b.buffer->bytes() / sizeof(float));
        if (!values) return values.error();
        if (Status sound = checkRange(fmt::format("method.{}", b.name), *values, -kHighestPressure, kHighestPressure); !sound) return sound;
        memory.push_back(std::move(*values));
    }
    SleepPasses::Saved slept;
    vec3 sleptUnder(0.0F);
    if (w.sleep) {
        Result<SleepPasses::Saved> passes = w.sleep->take(state, w.bodies.states().size());
        if (!passes) return passes.error();
        slept = std::move(*passes);
        Result<std::vector<vec3>> gravity = state.take<vec3>("sleep.gravity", 1);
        if (!gravity) return gravity.error();
        sleptUnder = (*gravity)[0];
        if (!isWithin(sleptUnder, kMostSpeed)) return badInput("section sleep.gravity of the saved state is not finite: save it again");
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
        if (taken > uint64_t{1} << 53U) return outOfRange("world.taken", 0, static_cast<double>(taken), 0, 0x1p53);
    }
    std::array<uint64_t, 2> before{};
    if (state.sections().contains("world.sourcesBefore")) {
        Result<std::vector<uint64_t>> counts = state.take<uint64_t>("world.sourcesBefore", 2);
        if (!counts) return counts.error();
        std::copy(counts->begin(), counts->end(), before.begin());
        for (size_t k = 0; k < 2; ++k)
            if (before[k] > uint64_t{1} << 53U) return outOfRange("world.sourcesBefore", k, static_cast<double>(before[k]), 0, 0x1p53);
    }
    FoamPasses::Saved foam;
    if (w.foam) {
        Result<FoamPasses::Saved> foamed = w.foam->take(state);
        if (!foamed) return foamed.error();
        foam = std::move(*foamed);
    }
    std::vector<float> wetness;  // of a state without it, empty: all is dry
    if (w.wet && state.sections().contains("wetness.points")) {
        Result<std::vector<float>> points = w.wet->take(state);
        if (!points) return points.error();
        wetness = std::move(*points);
    }
    Result<VolumePasses::Saved> volumes = VolumePasses::take(state, w.slots);
    if (!volumes) return volumes.error();
    if (Status all = state.allTaken(); !all) return all;
    if (!volumes->volumes.empty())
        if (Status room = w.volumes.prepare(*w.device, w.slots); !room) return room;
    if (Status moved = w.bodies.restore(*bodies); !moved) return moved;  // the host is the last that can refuse

    w.changing = true;  // what fails from here on leaves the world incomplete, until it is restored again
    w.device->goOn();
    w.writeStart();
    if (startCount) w.startCount = *startCount;
    w.particles.restore(*w.device, *saved);
    if (w.around) w.around->set(saved->position);
    w.gatherForDrawing();
    w.sources.restore(*sources);
    w.withdrawn = std::make_shared<uint64_t>(taken);
    w.before = {before[0], before[1]};
    if (w.foam) w.foam->restore(foam);
    if (w.wet) w.wet->restore(wetness);
    for (size_t k = 0; k < remembered.size(); ++k) w.device->writeAll<float>(*remembered[k].buffer, memory[k]);
    if (w.sleep) w.sleep->restore(slept);
    w.sleptUnder = sleptUnder;
    w.clock.time = n[0];
    w.stepper.reset(n[1]);
    w.clock.dropped = n[2];
    w.clock.dtMin = n[3];
    w.clock.dtMax = n[4];
    w.assumeFastest(n[5]);
    for (const vec4& v : saved->velocity)
        if (isFinite(vec3(v))) w.limits.fastestStart = std::max(w.limits.fastestStart, glm::length(vec3(v)));
    w.limits.fastestWall = static_cast<float>(n[6]);
    w.limits.fastestEver = static_cast<float>(n[7]);
    w.clock.frame = static_cast<uint64_t>(n[8]);
    w.params.origin = dvec3(n[9], n[10], n[11]);
    FluidStats& f = *w.figures;
    const double volume = std::pow(double{w.params.spacing}, 3);
    f.frame = w.clock.frame;
    f.time = w.clock.time;
    f.particles =
        static_cast<uint32_t>(std::count_if(saved->position.begin(), saved->position.end(), [](const vec4& p) { return !(p.w < 0); }));
    w.fillLedger(f);
    if (w.sleep)
        f.asleep =
            static_cast<uint32_t>(std::count_if(saved->velocity.begin(), saved->velocity.end(), [](const vec4& v) { return v.w < 0; }));
    for (size_t at = 0; at < limited->size();) {
        const size_t end = std::min(limited->find('\n', at), limited->size());
        f.limited.push_back(limited->substr(at, end - at));
        at = end + 1;
    }
    w.volumes.restore(*w.device, *volumes, volume);
    if (Status placed = w.solids.restore(*places); !placed) return placed;
    w.last = ok();
    w.changing = false;
    w.interrupted = w.device->interrupted();
    if (w.interrupted) return failed("the restore was interrupted: end the stop, then restore again");
    return ok();
}

Status FluidWorld::continueFrom(FluidWorld& other, std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes) {
    impl_->change();
    other.impl_->change();
    Impl &w = *impl_, &o = *other.impl_;
    if (Status whole = o.whole(); !whole) return whole;
    w.device->goOn();
    const BoxParams &box = w.params.box, &then = o.params.box;
    if (w.params.spacing != o.params.spacing || box.min != then.min || box.max != then.max || box.periodic() != then.periodic())
        return badInput("the box or the spacing is not the same: the water restarts at t = 0");
    if ((o.coloured && !w.coloured) || (o.traits.matter && !w.traits.matter && !o.bodies.any()))
        return badInput("the water holds liquids that this scene no longer has: the water restarts at t = 0");
    SolidPasses::Places places{.poses = {poses.begin(), poses.end()}, .shapes = {}, .voxelsRewritten = 0};
    for (const std::span<const vec3>& shape : shapes) places.shapes.emplace_back(shape.begin(), shape.end());
    if (Status sound = w.solids.beginFrame(poses, shapes, 0); !sound) return sound;
    if (Status placed = w.solids.restore(places); !placed) return placed;
    o.device->finish();
    o.device->poll();
    bool sameBodies = false;
    if (w.bodies.any() && w.bodies.savable() && other.savable()) {
        WorldState state;
        o.bodies.settle();
        o.bodies.save(state);
        const Result<BodyPasses::Saved> saved = w.bodies.take(state);
        sameBodies = saved && w.bodies.restore(*saved);
    }
    const std::vector<vec4> position = o.device->readAll<vec4>(o.particles.positionNext, o.particles.count),
                            velocity = o.device->readAll<vec4>(o.particles.velocityNext, o.particles.count);
    const std::vector<uint32_t> id = o.device->readAll<uint32_t>(o.particles.id, o.particles.count);
    std::vector<size_t> kept;
    size_t met = 0;
    for (size_t k = 0; k < position.size(); ++k) {
        const vec3 at(position[k]);
        if (position[k].w < 0 || id[k] >= o.slots || !isFinite(at)) continue;
        const bool may = w.solids.maySpawn(at, w.params.spacing, 0) && (sameBodies || w.bodies.maySpawn(at, w.params.spacing, 0));
        if (may)
            kept.push_back(k);
        else
            ++met;
    }
    if (kept.size() > w.slots)
        return badInput(
            fmt::format("the state holds {1} particles, more than the limit of {0}: the water restarts at t = 0", w.slots, kept.size()));
    if (met > 0) w.log.notice(fmt::format("{} particles were removed: a solid is now where they were", met));

    w.changing = true;
    w.writeStart();
    std::vector<vec4> positions = w.device->readAll<vec4>(w.particles.positionNext, w.particles.count),
                      velocities(w.particles.count, vec4(0.0F));
    for (uint32_t k = 0; k < w.slots; ++k) {
        positions[k] = k < kept.size() ? position[kept[k]] : vec4(box.min, -1.0F);
        if (k < kept.size()) velocities[k] = vec4(vec3(velocity[kept[k]]), 0.0F);  // all awake
    }
    w.device->writeAll<vec4>(w.particles.positionNext, positions);
    if (w.around) w.around->set(positions);
    w.device->writeAll<vec4>(w.particles.velocityNext, velocities);
    const auto handOver = [&](Buffer& of, const Buffer& from, bool has, const vec4& otherwise) {
        if (of.bytes() == 0) return;
        std::vector<vec4> table = w.device->readAll<vec4>(of, w.particles.count);
        const std::vector<vec4> before = has ? o.device->readAll<vec4>(from, o.particles.count) : std::vector<vec4>();
        for (size_t k = 0; k < kept.size(); ++k) table[k] = has ? before[id[kept[k]]] : otherwise;
        w.device->writeAll<vec4>(of, table);
    };
    const LiquidOf own = liquidOf(w.params, "");
    handOver(w.particles.matterOf, o.particles.matterOf, o.traits.matter, vec4(1.0F, 1.0F, own.viscosity, own.row));
    handOver(w.particles.absorptionOf, o.particles.absorptionOf, o.coloured, own.absorption);
    for (size_t k = 0; k < w.params.attributes.size(); ++k) {
        const auto same = std::ranges::find(o.params.attributes, w.params.attributes[k].name, &AttributeParams::name);
        const bool has = same != o.params.attributes.end();
        const Buffer none, &from = has ? o.particles.attributesOf[same - o.params.attributes.begin()] : none;
        handOver(w.particles.attributesOf[k], from, has, w.params.attributes[k].value());
    }
    w.gatherForDrawing();
    if (w.foam && o.foam) {
        WorldState state;
        o.foam->save(state);
        if (const auto saved = w.foam->take(state)) w.foam->restore(*saved);  // else another number may be: it begins without
    }
    if (w.wet && o.wet && w.wet->surface()->points.size() == o.wet->surface()->points.size()) {
        WorldState state;
        o.wet->save(state);
        if (const auto saved = w.wet->take(state)) w.wet->restore(*saved);  // of other solids: dry
    }
    w.startCount = static_cast<uint32_t>(kept.size());
    if (w.sleep) w.sleep->reset(o.clock.time);
    w.clock.time = o.clock.time;
    w.stepper.reset(o.stepper.pending());
    w.clock.dropped = o.clock.dropped;
    w.clock.frame = o.clock.frame;
    w.params.origin = o.params.origin;
    w.assumeFastest(o.figures->maxSpeed);
    for (const size_t k : kept) w.limits.fastestStart = std::max(w.limits.fastestStart, glm::length(vec3(velocity[k])));
    w.limits.fastestEver = o.limits.fastestEver;
    FluidStats& f = *w.figures;
    f.frame = w.clock.frame;
    f.time = w.clock.time;
    f.particles = w.startCount;
    f.emitted = w.startCount * std::pow(double{w.params.spacing}, 3);
    w.last = ok();
    w.changing = false;
    w.interrupted = w.device->interrupted();
    return ok();
}

}  // namespace rivulet
