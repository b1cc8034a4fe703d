// Sleeping water of a world: what it needs, and what disturbs it from outside.
#include <fmt/format.h>

#include <algorithm>

#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

Status FluidWorld::Impl::prepareSleep() {
    if (!params.sleep.on) return ok();
    StepParams s{};
    grid->fill(s);
    const AsleepValues values = method->asleepValues(particles, s);
    if (values.pressure.from == nullptr)
        return badInput(
            fmt::format("method {} does not support fluid.sleep: set fluid.sleep.on to false, or choose another method", params.method));
    Result<SleepPasses> made = SleepPasses::create(*device, s, particles.count, values);
    if (!made) return made.error();
    sleep.emplace(std::move(*made));
    return ok();
}

void FluidWorld::Impl::disturbAround(const Bounds& box) {
    const vec3 near(2.0F * params.supportSpacings * params.spacing);
    StepParams cells{};
    grid->fill(cells);
    sleep->disturb(cells, {box.min - near, box.max + near}, clock.time);
}

// Water falls asleep under forces that stay as they are. What may move it otherwise is looked for here, before every frame.
void FluidWorld::Impl::disturbSleep() {
    const double now = clock.time;
    if (gravity != sleptUnder) sleep->disturbAll(now);
    sleptUnder = gravity;
    const char *force = forces.keepsAwake(), *setting = method->keepsAwake(params);
    // Water that sleeps gives walls no impulse. The load on a body is found from its own samples, whatever sleeps around them.
    const bool measured = std::ranges::any_of(params.probes, [](const ProbeParams& p) { return p.on != "body"; });
    if (measured) setting = "a probe measures the load on a wall";
    if (force != nullptr) report(fmt::format("fluid.sleep: water stays awake while the force '{}' is on", force));
    if (setting != nullptr) report(fmt::format("fluid.sleep: water stays awake while {}", setting));
    if (force != nullptr || setting != nullptr) {
        sleep->disturbAll(now);
        return;
    }
    for (const Bounds& box : solids.moved()) disturbAround(box);
    StepParams cells{};
    grid->fill(cells);
    const float way = params.sleep.speed * params.sleep.after * params.supportSpacings * params.spacing;  // of sleep_watch
    // Faster bodies are found by sleep_watch.
    std::vector<Pose>& last = sleep->bodyPoses();
    for (size_t k = 0; k < bodies.states().size(); ++k) {
        const Pose& pose = bodies.states()[k].pose;
        if (k == last.size()) last.push_back(pose);
        if (!bodies.movedBy(k, last[k], way)) continue;
        const vec3 half(bodies.reach(k));
        sleep->disturb(cells, {glm::min(pose.position, last[k].position) - half, glm::max(pose.position, last[k].position) + half}, now);
        last[k] = pose;
    }
    for (const Emitter& e : sourceSetup.emitters) {
        const EmitterParams& p = e.params;
        if (!(p.litresPerSecond > 0) || now + clock.frameLength < p.start || (p.stop > 0 && now > p.stop)) continue;
        const vec3 half = vec3(std::max(p.radius, 0.5F * glm::length(p.size)));
        Bounds box{p.position - half, p.position + half};
        for (const vec3& corner : e.triangles) box.add(corner);
        disturbAround(box);
    }
    for (const SinkParams& p : sourceSetup.sinks) {
        const vec3 half = p.shape == "box" ? 0.5F * p.size : vec3(p.radius);
        disturbAround({p.position - half, p.position + half});
    }
    const std::vector<DryVolume>& volumes = dry.volumes();
    for (size_t k = 0; k < std::max(volumes.size(), dryBefore.size()); ++k) {
        if (k < volumes.size() && k < dryBefore.size() && !hasMoved(dryBefore[k], volumes[k], way)) continue;
        if (k < dryBefore.size()) disturbAround(boundsOf(dryBefore[k]));
        if (k < volumes.size()) disturbAround(boundsOf(volumes[k]));
        dryBefore.resize(std::max(dryBefore.size(), k + 1));
        if (k < volumes.size()) dryBefore[k] = volumes[k];
    }
    dryBefore.resize(volumes.size());
}

}  // namespace rivulet
