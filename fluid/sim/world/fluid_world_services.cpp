// Queries of a game: the water at places, where rays meet it, and the counts of volumes.
#include <cmath>
#include <limits>

#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

// `params`: what the grid has to say. Where no step has sorted the particles yet they are, aside: the next step finds them as they were.
Status FluidWorld::Impl::prepareQuery(StepParams& s) {
    if (!query.any()) {
        Result<WaterQuery> made = WaterQuery::create(*device, params, traits);
        if (!made) return made.error();
        query = std::move(*made);
    }
    s = StepParams{};
    s.count = particles.count;
    s.h = params.supportSpacings * params.spacing;
    s.invH = 1.0F / s.h;
    s.spacing = params.spacing;
    if (around && !sorted && !sortedForQuery)
        if (Status there = follow(s); !there) return there;
    grid->fill(s);
    if (sorted || sortedForQuery) return ok();
    if (Status built = grid->build(s, particles); !built) return built;
    grid->undo(particles);
    sortedForQuery = true;
    return ok();
}

template <class Answer, class Ask>
Result<std::vector<Answer>> FluidWorld::Impl::ask(size_t count, const Ask& how) {
    if (particles.count == 0) return std::vector<Answer>(count);
    if (Status valid = whole(); !valid) return valid.error();
    device->goOn();  // another owner of buffers may have been interrupted
    StepParams s;
    if (Status ready = prepareQuery(s); !ready) return ready.error();
    const bool aside = !sorted && !traits.linked;
    Result<std::vector<Answer>> answer =
        how({s, *grid, aside ? particles.position : particles.positionNext, aside ? particles.velocity : particles.velocityNext});
    if (device->interrupted() || device->stopAsked()) {
        if (!sorted) sortedForQuery = false;
        return failed("the question was interrupted: end the stop, then ask again");
    }
    return answer;
}

Result<std::vector<FluidSample>> FluidWorld::sample(std::span<const vec3> places) {
    Impl& w = *impl_;
    return w.ask<FluidSample>(places.size(), [&](const WaterQuery::Water& water) { return w.query.sample(water, places); });
}

Result<std::vector<FluidHit>> FluidWorld::cast(std::span<const FluidRay> rays) {
    Impl& w = *impl_;
    return w.ask<FluidHit>(rays.size(), [&](const WaterQuery::Water& water) { return w.query.cast(water, rays); });
}

Status FluidWorld::sampleLater(std::span<const vec3> places, std::function<void(std::span<const FluidSample>)> then) {
    Impl& w = *impl_;
    bool asked = false;
    const auto later = [&](const WaterQuery::Water& water) -> Result<std::vector<FluidSample>> {
        if (Status s = w.query.sampleLater(water, places, then); !s) return s.error();
        asked = true;
        return std::vector<FluidSample>();
    };
    const Result<std::vector<FluidSample>> air = w.ask<FluidSample>(places.size(), later);
    if (!air) return air.error();
    if (!asked) then(*air);
    return ok();
}

void FluidWorld::visitForces(ParamVisitor& v) { impl_->forces.visit(v); }

Status FluidWorld::setVolumes(std::span<const Volume> volumes) {
    Impl& w = *impl_;
    return w.volumes.set(*w.device, volumes, w.slots, std::pow(double{w.params.spacing}, 3));
}

std::vector<VolumeCount> FluidWorld::volumes() const { return impl_->volumes.counts(); }
std::vector<VolumeCount> FluidWorld::takeVolumeEvents() { return impl_->volumes.takeEvents(); }

Result<std::vector<float>> FluidWorld::heights(std::span<const vec2> places) {
    const BoxParams& box = impl_->params.box;
    const float above = box.max.y + 2.0F * impl_->params.supportSpacings * impl_->params.spacing;
    std::vector<FluidRay> rays;
    rays.reserve(places.size());
    for (const vec2& p : places) rays.push_back({vec3(p.x, above, p.y), vec3(0.0F, -1.0F, 0.0F)});
    const Result<std::vector<FluidHit>> hits = cast(rays);
    if (!hits) return hits.error();
    std::vector<float> heights;
    heights.reserve(places.size());
    for (const FluidHit& hit : *hits) heights.push_back(hit.hit ? hit.place.y : std::numeric_limits<float>::quiet_NaN());
    return heights;
}

}  // namespace rivulet
