// rivulet.h: worlds.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "engine/core/json.h"
#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/drawing.h"
#include "fluid/capi/versioned.h"
#include "fluid/capi/walls.h"
#include "fluid/sim/world/contradictions.h"
#include "fluid/sim/world/host_particles.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet::capi {

void WorldParams::visitSources(ParamVisitor& v) {
    v.list({.name = "emitters", .doc = "sources of water"}, emitters);
    v.list({.name = "sinks", .doc = "regions that remove water"}, sinks);
    v.list({.name = "dry", .doc = "volumes that stay dry"}, dry);
}

void WorldParams::visit(ParamVisitor& v) {
    v.group({.name = "fluid", .doc = "the water"}, fluid);
    visitSources(v);
    v.group({.name = "look", .doc = "look of the water"}, look);
}

namespace {

VisitFn visiting(WorldParams& params) {
    return [&params](ParamVisitor& v) { params.visit(v); };
}

Result<Sources> sourcesOf(const WorldParams& params) {
    Sources sources;
    sources.sinks = params.sinks;
    sources.dry = params.dry;
    for (size_t k = 0; k < params.emitters.size(); ++k) {
        if (params.emitters[k].shape == "mesh")
            return badInput(fmt::format("emitters[{}].shape is mesh: use nozzle or box, a mesh needs a scene file", k));
        if (const std::string wrong = contradiction(params.emitters[k], k, params.fluid.box); !wrong.empty()) return badInput(wrong);
        sources.emitters.push_back({params.emitters[k], {}});
    }
    return sources;
}

FluidParams simulated(const rivulet_world& w, const WorldParams& params) {
    return w.context->gl.present() ? fluidForLook(params.fluid, params.look) : params.fluid;
}

// What a scene file is checked for. Error (badInput): values that contradict each other.
Status checkScene(const WorldParams& params) {
    for (const std::string& wrong : {contradiction(params.fluid), contradiction(params.look)})
        if (!wrong.empty()) return badInput(wrong);
    return ok();
}

Status addParticles(const rivulet_world_options& o, Sources& sources) {
    if (o.particles_count > 0 && o.particles == nullptr) return badInput("particles is NULL, and particles_count is not 0");
    for (size_t k = 0; k < o.particles_count; ++k)
        sources.particles.push_back(
            {vectorOf(o.particles + 3 * k), o.particle_velocities != nullptr ? vectorOf(o.particle_velocities + 3 * k) : vec3(0.0F)});
    return ok();
}

Status createWorld(rivulet_context& context, const rivulet_world_options& o, rivulet_world& w) {
    w.context = &context;
    if (context.memoryLimit > 0) w.upload.limitMemory(context.memoryLimit);
    if (o.json != nullptr)
        if (Status read = readJson(o.json, "json", visiting(w.params)); !read) return read;
    if (Status sense = checkScene(w.params); !sense) return sense;
    if (Status added = w.walls.begin(o, w.params.fluid, context.memoryLimit, context.jobs); !added) return added;
    Solids solids = w.walls.solids();
    if (Status added = w.bodies.begin(o, w.params.fluid, context.jobs, context.memoryLimit, context.callback, solids); !added) return added;
    Result<Sources> sources = sourcesOf(w.params);
    if (!sources) return sources.error();
    if (Status added = addParticles(o, *sources); !added) return added;
    constexpr double kMostBrought = 1.0e3;  // m^3
    if (!(o.skins_bring >= 0) || o.skins_bring > kMostBrought)
        return badInput(fmt::format("skins_bring is {} m^3: give 0 to {}", o.skins_bring, kMostBrought));
    sources->expectedDeposit = o.skins_bring;
    w.exchanges = o.skins_bring > 0;
    for (size_t k = 0; k < w.params.fluid.blocks.size(); ++k)
        if (w.params.fluid.blocks[k].shape == "mesh")
            return badInput(fmt::format("fluid.blocks[{}].shape is mesh: use another shape or particles, a mesh needs a scene file", k));
    auto made = FluidWorld::create(*context.device, simulated(w, w.params), solids, context.log, *sources);
    if (!made) return made.error();
    w.world = std::move(*made);
    return w.bodies.thrown();
}

}  // namespace
}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_world_create(rivulet_context* context, const rivulet_world_options* options, rivulet_world** world,
                                    rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (world == nullptr) return badInput("world is NULL: pass the address of a handle");
        *world = nullptr;
        if (context == nullptr) return badInput("context is NULL: create one with rivulet_context_create");
        const Result<rivulet_world_options> o = readStruct(options, "rivulet_world_options", "options");
        if (!o) return o.error();
        if (Status can = ready(*context, Needs::drawing); !can) return can;
        if (Status there = stillThere(*context, Needs::device); !there) return there;
        const CallScope scope(*context, Needs::drawing);
        auto made = std::make_unique<rivulet_world>();
        if (Status done = createWorld(*context, *o, *made); !done) return done;
        ++context->children;
        *world = made.release();
        return ok();
    });
    if (context != nullptr) context->hostLog.deliver(context->callback);
    return status;
}

void rivulet_world_destroy(rivulet_world* world) { destroy(world); }

rivulet_status rivulet_world_step(rivulet_world* world, const rivulet_inputs* inputs, double seconds, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        const Result<rivulet_inputs> input = readStruct(inputs, "rivulet_inputs", "inputs");
        if (!input) return input.error();
        const rivulet_inputs& in = *input;
        if (!std::isfinite(seconds)) return badInput("seconds is not finite");
        const size_t moving = world->walls.moving();
        if (in.poses != nullptr && in.poses_count != moving)
            return badInput(fmt::format("{} poses were given for {} walls that move: give one for each", in.poses_count, moving));
        const size_t deforming = world->walls.deforming();
        if (in.shapes != nullptr && in.shapes_count != deforming)
            return badInput(fmt::format("{} shapes were given for {} walls that deform: give one for each", in.shapes_count, deforming));
        FluidInputs to;
        if (in.gravity != nullptr) to.gravity = vectorOf(in.gravity);
        std::vector<Pose> poses;
        for (size_t k = 0; in.poses != nullptr && k < in.poses_count; ++k) {
            const Result<Pose> pose = soundPose(in.poses[k], fmt::format("inputs.poses[{}]", k));
            if (!pose) return pose.error();
            poses.push_back(*pose);
        }
        world->bodies.forget();
        // Walls of an incomplete world do not change, nor any while a stop is asked.
        if (world->world->lastStep() && !world->context->device->stopAsked()) {
            for (const std::string& wrong : world->walls.arrive(*world->world)) world->context->log.error(wrong);
            for (const std::string& wrong : world->bodies.arrive(*world->world)) world->context->log.error(wrong);
        }
        const Walls::Targets before = world->walls.targets();
        if (in.poses != nullptr) world->walls.move(poses);
        for (size_t k = 0; in.shapes != nullptr && k < deforming; ++k)
            if (in.shapes[k] != nullptr) world->walls.deform(k, in.shapes[k]);
        const Walls::Targets targets = world->walls.targets();
        to.poses = targets.poses;
        const std::vector<std::span<const vec3>> shapes(targets.shapes.begin(), targets.shapes.end());
        to.shapes = shapes;
        if (Status sound = world->world->checkInputs(to, seconds); !sound) {
            world->walls.moveBack(before);
            return sound;
        }
        rivulet_context& context = *world->context;
        collectTimes(context);
        to.deviceMs = context.deviceMs - world->deviceMs;  // of all its worlds: passes are not counted per world
        world->deviceMs = context.deviceMs;
        world->world->step(to, seconds);
        if (world->world->interrupted()) return failed("the step was interrupted: end the stop, then reset or restore the world");
        if (context.device->stopAsked()) return failed("nothing was stepped: a stop is asked with rivulet_context_stop");
        if (Status stepped = world->world->lastStep(); !stepped) return stepped;
        if (Status recorded = recordFrame(*world); !recorded) return recorded;
        return world->bodies.thrown();
    });
}

rivulet_status rivulet_world_reset(rivulet_world* world, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        world->bodies.forget();
        world->world->reset();
        world->walls.follow(world->world->poses());
        if (Status back = world->world->lastStep(); !back) return back;
        return world->bodies.thrown();
    });
}

rivulet_status rivulet_world_add_wall(rivulet_world* world, const rivulet_mesh* wall, uint32_t* id, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (wall == nullptr || id == nullptr) return badInput("wall or id is NULL");
        if (Status may = world->world->mayChangeWalls(); !may) return may;
        const Result<uint32_t> added = world->walls.add(*wall);
        if (!added) return added.error();
        *id = *added;
        return ok();
    });
}

rivulet_status rivulet_world_remove_wall(rivulet_world* world, uint32_t id, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (Status may = world->world->mayChangeWalls(); !may) return may;
        return world->walls.remove(*world->world, id);
    });
}

rivulet_status rivulet_world_wall(const rivulet_world* world, uint32_t id, int32_t* state, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (state == nullptr) return badInput("state is NULL");
        const Result<rivulet_wall_state> found = world->walls.stateOf(id);
        if (!found) return found.error();
        *state = *found;
        return ok();
    });
}

rivulet_status rivulet_world_set_sources(rivulet_world* world, const char* json, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (json == nullptr) return badInput("json is NULL: give, for example, \"{\\\"emitters\\\": []}\"");
        WorldParams changed = world->params;
        changed.emitters.clear();
        changed.sinks.clear();
        changed.dry.clear();
        if (Status read = readJson(json, "json", [&changed](ParamVisitor& v) { changed.visitSources(v); }); !read) return read;
        Result<Sources> sources = sourcesOf(changed);
        if (!sources) return sources.error();
        if (Status taken = world->world->setSources(*sources); !taken) return taken;
        std::swap(world->params, changed);
        return ok();
    });
}

rivulet_status rivulet_world_set(rivulet_world* world, const char* assignment, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (assignment == nullptr) return badInput("assignment is NULL: give, for example, \"fluid.viscosity=0.01\"");
        WorldParams changed = world->params;
        if (Status set = setParam(assignment, visiting(changed)); !set) return set;
        if (Status same = sameFixedValues(fixedValues(visiting(world->params)), fixedValues(visiting(changed))); !same)
            return badInput(fmt::format("{}: this parameter is fixed; create a new world to change it", assignment));
        if (changed.emitters.size() != world->params.emitters.size() || changed.sinks.size() != world->params.sinks.size())
            return badInput(fmt::format("{}: the number of emitters and sinks is set with rivulet_world_set_sources", assignment));
        if (Status sense = checkScene(changed); !sense) return sense;
        Result<Sources> sources = sourcesOf(changed);
        if (!sources) return sources.error();
        const FluidParams before = world->world->params();
        if (Status taken = world->world->setParams(simulated(*world, changed)); !taken) return taken;
        if (Status taken = world->world->setSources(*sources); !taken) {
            (void)world->world->setParams(before);
            return taken;
        }
        std::swap(world->params, changed);
        return ok();
    });
}

rivulet_status rivulet_world_stats(const rivulet_world* world, rivulet_stats* stats, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        const FluidStats& s = world->world->stats();
        rivulet_stats full{};
        full.time = world->world->time();
        full.dropped = world->world->dropped();
        full.particles = s.particles;
        full.lost = s.lost;
        full.average_compression = s.avgCompression;
        full.kinetic = s.kinetic;
        full.potential = s.potential;
        full.maximum_speed = s.maxSpeed;
        std::copy(std::begin(s.centreOfMass), std::end(s.centreOfMass), full.centre_of_mass);
        full.substeps = world->world->lastSubsteps();
        full.asleep = s.asleep;
        return writeStruct(full, stats, "rivulet_stats", "stats");
    });
}

rivulet_status rivulet_world_particles(rivulet_world* world, rivulet_particles* particles, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (particles == nullptr) return badInput("particles is NULL");
        const Result<rivulet_particles> input = readStruct(particles, "rivulet_particles", "particles");
        if (!input) return input.error();
        const rivulet_particles& to = *input;
        const size_t known = world->params.fluid.attributes.size();
        for (size_t k = known; k < std::size(to.attributes); ++k)
            if (to.attributes[k] != nullptr)
                return badInput(fmt::format("particles.attributes[{}] is given, and fluid.attributes has {}: set it to NULL", k, known));
        const HostParticles all = readParticles(*world->world);
        for (size_t n = 0; n < std::min(all.position.size(), to.capacity); ++n) {
            if (to.positions != nullptr) put(vec3(all.position[n]), to.positions + 3 * n);
            if (to.velocities != nullptr) put(vec3(all.velocity[n]), to.velocities + 3 * n);
            if (to.densities != nullptr) to.densities[n] = all.position[n].w;
            if (to.ids != nullptr) to.ids[n] = all.id[n];
            for (size_t k = 0; k < all.attributes.size(); ++k)
                if (to.attributes[k] != nullptr) std::memcpy(to.attributes[k] + 4 * n, &all.attributes[k][n].x, 4 * sizeof(float));
        }
        rivulet_particles full = to;
        full.count = all.position.size();
        return writeStruct(full, particles, "rivulet_particles", "particles");
    });
}

rivulet_status rivulet_world_save(rivulet_world* world, const char* path, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (path == nullptr) return badInput("path is NULL");
        if (Status savable = world->world->savable(); !savable) return savable;
        WorldState state;
        world->world->save(state);
        if (Status savable = world->world->savable(); !savable) return savable;  // reading it may have failed
        Result<size_t> written = writeState(path, state);
        return written ? ok() : Status(written.error());
    });
}

rivulet_status rivulet_world_restore(rivulet_world* world, const char* path, rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (path == nullptr) return badInput("path is NULL");
        Result<WorldState> state = readState(path);
        if (!state) return state.error();
        Status restored = world->world->restore(*state);
        if (restored) world->walls.follow(world->world->poses());
        return restored;
    });
}
