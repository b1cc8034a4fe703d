// rivulet.h: queries and files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "engine/core/file.h"
#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/versioned.h"
#include "fluid/capi/walls.h"
#include "fluid/io/export.h"
#include "fluid/io/marching_cubes.h"
#include "fluid/io/mesh_file.h"
#include "fluid/sim/solids/buoyancy.h"
#include "fluid/sim/world/contradictions.h"
#include "fluid/sim/world/host_particles.h"

using namespace rivulet;
using namespace rivulet::capi;

namespace {

std::vector<vec3> placesOf(const float* places, size_t count) {
    std::vector<vec3> all;
    for (size_t k = 0; k < count; ++k) all.push_back(vectorOf(places + 3 * k));
    return all;
}

rivulet_sample sampleOf(const FluidSample& s) {
    rivulet_sample to{.density = s.density, .velocity = {}, .gradient = {}};
    put(s.velocity, to.velocity);
    put(s.gradient, to.gradient);
    return to;
}

// A rivulet_float, read.
struct Afloat {
    std::vector<FloatPoint> points;
    BodyState state;
    double mass = 0;
    float linearDrag = 0, quadraticDrag = 0;
};

Result<Afloat> floatOf(const rivulet_float& given, const std::string& name) {
    if (given.points == nullptr || given.volumes == nullptr || given.points_count == 0)
        return badInput(fmt::format("{} has no points: give points and their volumes", name));
    if (!(given.mass > 0) || !std::isfinite(given.mass))
        return badInput(fmt::format("{}.mass is {} kg: give more than 0", name, given.mass));
    for (const float drag : {given.linear_drag, given.quadratic_drag})
        if (!(drag >= 0) || drag > kMostGravity)
            return badInput(fmt::format("{}.linear_drag or quadratic_drag is {}: give 0 to {}", name, drag, kMostGravity));
    Afloat to{
        .points = {}, .state = {}, .mass = double{given.mass}, .linearDrag = given.linear_drag, .quadraticDrag = given.quadratic_drag};
    to.points.reserve(given.points_count);
    for (size_t k = 0; k < given.points_count; ++k) {
        const FloatPoint point{vectorOf(given.points + 3 * k), given.volumes[k]};
        if (!isWithin(point.place, kMostDistance) || !(point.volume >= 0) || !isWithin(vec3(point.volume), kMostDistance))
            return badInput(fmt::format("{}: point {} or its volume is not finite, negative or beyond {}", name, k, kMostDistance));
        to.points.push_back(point);
    }
    const Result<Pose> pose = soundPose(given.state.pose, name + ".state.pose");
    if (!pose) return pose.error();
    to.state = {*pose, vectorOf(given.state.velocity), vectorOf(given.state.spin)};
    if (!isWithin(to.state.velocity, kMostDistance) || !isWithin(to.state.spin, kMostDistance))
        return badInput(fmt::format("{}.state is not finite, or beyond {} m/s or rad/s", name, kMostDistance));
    return to;
}

rivulet_volume_count countOf(const VolumeCount& c) { return {c.id, c.entered, c.left, c.inside, c.time, c.volumeInside()}; }

Status writeCounts(const std::vector<VolumeCount>& all, rivulet_volume_count* to, size_t capacity, size_t* count) {
    if (count == nullptr) return badInput("count is NULL: it receives the number of volumes");
    *count = all.size();
    for (size_t k = 0; to != nullptr && k < std::min(all.size(), capacity); ++k) to[k] = countOf(all[k]);
    return ok();
}

// The row with the path's ending.
template <class Rows>
const auto* rowOf(const Rows& rows, const std::string& path) {
    for (const auto& row : rows)
        if (path.ends_with("." + std::string(row.ending))) return &row;
    return static_cast<decltype(&*rows.begin())>(nullptr);
}

}  // namespace

rivulet_status rivulet_world_sample(rivulet_world* world, const float* places, size_t count, rivulet_sample* samples, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (places == nullptr || samples == nullptr)) return badInput("places or samples is NULL, and count is not 0");
        const Result<std::vector<FluidSample>> answer = world->world->sample(placesOf(places, count));
        if (!answer) return answer.error();
        const std::vector<FluidSample>& all = *answer;
        std::transform(all.begin(), all.end(), samples, sampleOf);
        return ok();
    });
}

rivulet_status rivulet_world_sample_later(rivulet_world* world, const float* places, size_t count,
                                          void (*then)(void* user, const rivulet_sample* samples, size_t count), void* user,
                                          rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && places == nullptr) return badInput("places is NULL, and count is not 0");
        if (then == nullptr) return badInput("then is NULL: it receives the samples");
        return world->world->sampleLater(
            placesOf(places, count), [world = std::weak_ptr(world->alive), then, user](std::span<const FluidSample> water) {
                const std::shared_ptr<rivulet_world*> to = world.lock();
                if (!to) return;
                std::vector<rivulet_sample> samples;
                samples.reserve(water.size());
                for (const FluidSample& s : water) samples.push_back(sampleOf(s));
                (*to)->context->hostLog.later([then, user, samples = std::move(samples)] { then(user, samples.data(), samples.size()); });
            });
    });
}

rivulet_status rivulet_world_buoyancy(rivulet_world* world, const rivulet_float* floats, size_t count, const float* gravity, double seconds,
                                      rivulet_body_load* loads, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (floats == nullptr || loads == nullptr)) return badInput("floats or loads is NULL, and count is not 0");
        if (!(seconds > 0) || seconds > kLongestFrame)
            return badInput(fmt::format("seconds is {}: give more than 0 and at most {} s", seconds, kLongestFrame));
        BuoyancyParams params{.restDensity = world->params.fluid.restDensity, .gravity = world->params.fluid.gravity};
        if (gravity != nullptr) params.gravity = vectorOf(gravity);
        if (!isWithin(params.gravity, kMostGravity))
            return badInput(fmt::format("gravity is not finite, or beyond {} m/s^2", kMostGravity));
        std::vector<Afloat> all;
        all.reserve(count);
        std::vector<vec3> places;
        const auto* at = reinterpret_cast<const std::byte*>(floats);
        for (size_t k = 0; k < count; ++k) {
            const std::string name = fmt::format("floats[{}]", k);
            const Result<rivulet_float> one = readStruct(reinterpret_cast<const rivulet_float*>(at), "rivulet_float", name);
            if (!one) return one.error();
            at += one->size;
            Result<Afloat> read = floatOf(*one, name);
            if (!read) return read.error();
            addPlaces(read->points, read->state.pose, places);
            all.push_back(std::move(*read));
        }
        const Result<std::vector<FluidSample>> water = world->world->sample(places);
        if (!water) return water.error();
        size_t first = 0;
        for (size_t k = 0; k < count; ++k) {
            const Afloat& f = all[k];
            params.linearDrag = f.linearDrag;
            params.quadraticDrag = f.quadraticDrag;
            const BodyLoad load = buoyancy(f.points, f.state, std::span(*water).subspan(first, f.points.size()), params, f.mass, seconds);
            first += f.points.size();
            loads[k] = {{load.force.x, load.force.y, load.force.z}, {load.torque.x, load.torque.y, load.torque.z}};
        }
        return ok();
    });
}

rivulet_status rivulet_world_cast(rivulet_world* world, const rivulet_ray* rays, size_t count, rivulet_hit* hits, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (rays == nullptr || hits == nullptr)) return badInput("rays or hits is NULL, and count is not 0");
        std::vector<FluidRay> asked;
        for (size_t k = 0; k < count; ++k)
            asked.push_back({vectorOf(rays[k].origin), vectorOf(rays[k].direction),
                             rays[k].reach > 0 ? rays[k].reach : std::numeric_limits<float>::infinity()});
        const Result<std::vector<FluidHit>> answer = world->world->cast(asked);
        if (!answer) return answer.error();
        const std::vector<FluidHit>& all = *answer;
        for (size_t k = 0; k < all.size(); ++k) {
            hits[k].hit = all[k].hit ? 1 : 0;
            hits[k].inside = all[k].inside ? 1 : 0;
            hits[k].distance = all[k].distance;
            put(all[k].place, hits[k].place);
            put(all[k].normal, hits[k].normal);
            put(all[k].velocity, hits[k].velocity);
        }
        return ok();
    });
}

rivulet_status rivulet_world_heights(rivulet_world* world, const float* places, size_t count, float* heights, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (places == nullptr || heights == nullptr)) return badInput("places or heights is NULL, and count is not 0");
        std::vector<vec2> asked;
        for (size_t k = 0; k < count; ++k) asked.emplace_back(places[2 * k], places[2 * k + 1]);
        const Result<std::vector<float>> answer = world->world->heights(asked);
        if (!answer) return answer.error();
        std::copy(answer->begin(), answer->end(), heights);
        return ok();
    });
}

rivulet_status rivulet_world_wetness(rivulet_world* world, const float* places, size_t count, float* wetness, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (places == nullptr || wetness == nullptr)) return badInput("places or wetness is NULL, and count is not 0");
        std::fill_n(wetness, count, 0.0F);
        const FluidWorld& of = *world->world;
        const WetnessView wet = of.wetness();
        if (!wet.surface || count == 0) return ok();
        const std::vector<float> values = of.device().readAll<float>(*wet.values, wet.surface->points.size());
        for (size_t s = 0; s < wet.surface->solids.size(); ++s) {
            const Pose pose = wet.surface->solids[s].poseAmong(of.poses(), of.bodies());
            for (size_t k = 0; k < count; ++k)
                wetness[k] = std::max(wetness[k], wet.surface->at(values, s, pose.toOwn(vectorOf(places + 3 * k))));
        }
        return ok();
    });
}

rivulet_status rivulet_world_set_volumes(rivulet_world* world, const rivulet_volume* volumes, size_t count, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && volumes == nullptr) return badInput("volumes is NULL, and count is not 0");
        std::vector<Volume> all;
        for (size_t k = 0; k < count; ++k) {
            const Result<Volume> volume = volumeOf(volumes[k], fmt::format("volumes[{}]", k));
            if (!volume) return volume.error();
            all.push_back(*volume);
        }
        return world->world->setVolumes(all);
    });
}

rivulet_status rivulet_world_volumes(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                     rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status { return writeCounts(world->world->volumes(), counts, capacity, count); });
}

rivulet_status rivulet_world_volume_events(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                           rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (counts == nullptr || capacity < VolumePasses::kMost)
            return badInput(fmt::format("counts must have room for {}: events are reported only once", VolumePasses::kMost));
        return writeCounts(world->world->takeVolumeEvents(), counts, capacity, count);
    });
}

rivulet_status rivulet_world_loads(const rivulet_world* world, rivulet_load* loads, size_t capacity, size_t* count, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (count == nullptr) return badInput("count is NULL: it receives the number of probes");
        const std::vector<ProbeParams>& probes = world->params.fluid.probes;
        const ProbeFrame& frame = world->world->stats().loads;
        *count = probes.size();
        for (size_t k = 0; loads != nullptr && k < std::min(probes.size(), capacity); ++k) {
            rivulet_load to{};
            to.pressure = std::numeric_limits<double>::quiet_NaN();
            probes[k].name.copy(to.name, sizeof to.name - 1);
            if (k < frame.probes.size()) {
                const ProbeReading& p = frame.probes[k];
                to.time = frame.time;
                to.seconds = frame.seconds;
                for (int axis = 0; axis < 3; ++axis) {
                    to.force[axis] = p.force[axis];
                    to.torque[axis] = p.torque[axis];
                    to.impulse[axis] = p.impulse[axis];
                    to.angular_impulse[axis] = p.angularImpulse[axis];
                }
                to.pressure = p.pressure.value_or(to.pressure);
            }
            loads[k] = to;
        }
        return ok();
    });
}

rivulet_status rivulet_world_export(rivulet_world* world, const char* path, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (path == nullptr) return badInput("path is NULL");
        const ParticleFormat* format = rowOf(particleFormats().rows, path);
        if (format == nullptr) return badInput(fmt::format("{}: particles are written as .ply, .vtp or .csv", path));
        const HostParticles host = readParticles(*world->world);
        if (Status there = stillThere(*world->context, Needs::device); !there) return there;
        const ExportParticles of{.position = host.position,
                                 .velocity = host.velocity,
                                 .id = host.id,
                                 .mass = host.mass,
                                 .volume = std::pow(static_cast<double>(world->params.fluid.spacing), 3),
                                 .time = world->world->time()};
        return writeFileAtomic(path, format->write(of, {.origin = world->world->origin()}));
    });
}

rivulet_status rivulet_world_export_surface(rivulet_world* world, const char* path, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (path == nullptr) return badInput("path is NULL");
        const MeshFormat* format = nullptr;
        for (const MeshFormat& row : meshFormats().rows)
            if (std::string_view(path).ends_with("." + std::string(row.name))) format = &row;
        if (format == nullptr) return badInput(fmt::format("{}: a surface is written as .obj or .ply", path));
        const HostParticles host = readParticles(*world->world);
        if (Status there = stillThere(*world->context, Needs::device); !there) return there;
        Result<IsoSurface> surface = IsoSurface::create(host.position, world->params.fluid.spacing);
        if (!surface) return surface.error();
        Result<SurfaceMesh> mesh = marchingCubes(*surface);
        if (!mesh) return mesh.error();
        return writeFileAtomic(path, format->write(mesh->view(), {.origin = world->world->origin()}));
    });
}
