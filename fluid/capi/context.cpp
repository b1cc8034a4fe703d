// rivulet.h: contexts.
#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "engine/gpu/load.h"
#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/versioned.h"
#include "fluid/render/host_view.h"

namespace rivulet::capi {

Pose poseOf(const rivulet_pose& pose) {
    const float* r = pose.rotation;
    const bool none = r[0] == 0 && r[1] == 0 && r[2] == 0 && r[3] == 0;
    return {vectorOf(pose.position), none ? quat(1, 0, 0, 0) : quat(r[3], r[0], r[1], r[2])};
}

rivulet_pose poseOf(const Pose& pose) {
    const vec3& p = pose.position;
    const quat& q = pose.rotation;
    return {{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}};
}

void collectTimes(rivulet_context& context) {
    for (const PassTime& pass : context.device->takeTimes()) {
        PassTime& all = context.passes[pass.name];
        all.name = pass.name;
        all.ms += pass.ms;
        all.calls += pass.calls;
        context.deviceMs += pass.ms;
    }
}

Result<HostMesh> meshOf(const rivulet_mesh& mesh, const std::string& name) {
    if (mesh.positions == nullptr || mesh.indices == nullptr || mesh.vertices == 0 || mesh.indices_count == 0)
        return badInput(fmt::format("{} has no triangles: give positions and indices", name));
    if (mesh.indices_count % 3 != 0) return badInput(fmt::format("{} has {} indices: give a multiple of three", name, mesh.indices_count));
    constexpr size_t kMost = UINT32_MAX;
    if (mesh.vertices > kMost || mesh.indices_count > kMost)
        return badInput(
            fmt::format("{} has {} vertices and {} indices: give fewer than 2^32 of each", name, mesh.vertices, mesh.indices_count));
    HostMesh out;
    for (size_t k = 0; k < mesh.vertices; ++k) {
        const vec3& p = out.positions.emplace_back(vectorOf(mesh.positions + 3 * k));
        if (!isWithin(p, kMostDistance))
            return badInput(fmt::format("{}.positions has ({}, {}, {}) m as number {}: give finite values of at most {} m", name, p.x, p.y,
                                        p.z, k, kMostDistance));
    }
    out.indices.assign(mesh.indices, mesh.indices + mesh.indices_count);
    for (const uint32_t i : out.indices)
        if (i >= mesh.vertices) return badInput(fmt::format("{} has an index {} and {} vertices", name, i, mesh.vertices));
    if (mesh.uvs != nullptr && !areWithin({mesh.uvs, 2 * mesh.vertices}, kMostDistance))
        return badInput(fmt::format("{}.uvs are not finite", name));
    for (size_t k = 0; mesh.uvs != nullptr && k < mesh.vertices; ++k) out.uvs.emplace_back(mesh.uvs[2 * k], mesh.uvs[2 * k + 1]);
    return out;
}

namespace {

// The options of a cpu device, and the jobs of the context.
Result<CpuOptions> cpuOptionsOf(const rivulet_context_options& o, rivulet_context& c) {
    if (o.threads < 0) return badInput(fmt::format("options.threads is {}: give 1 or more, or 0 for all cores", o.threads));
    const Result<rivulet_jobs> jobs = readStruct(o.jobs, "rivulet_jobs", "jobs");
    if (!jobs) return jobs.error();
    if (o.jobs != nullptr && (jobs->run == nullptr || jobs->workers < 1))
        return badInput("jobs has no run, or less than 1 worker: give both, or set options.jobs to NULL");
    if (jobs->run != nullptr)
        c.jobs = {jobs->user, jobs->run, o.threads > 0 ? std::min(o.threads, jobs->workers) : jobs->workers, jobs->start, nullptr};
    else
        c.jobs = c.workers.emplace(o.threads > 0 ? std::min(o.threads, jobWorkers()) : jobWorkers())
                     .jobs();  // they end with the context: a host may unload us
    const Result<rivulet_memory> memory = readStruct(o.memory, "rivulet_memory", "memory");
    if (!memory) return memory.error();
    if (o.memory != nullptr && (memory->allocate == nullptr || memory->release == nullptr))
        return badInput("memory has not both allocate and release: give both, or set options.memory to NULL");
    CpuOptions cpu;
    cpu.jobs = c.jobs;
    cpu.memory = {memory->user, memory->allocate, memory->release};
    return cpu;
}

Status createContext(const rivulet_context_options& o, rivulet_context& c) {
    c.hostLog.function = o.log;
    c.hostLog.user = o.log_user;
    c.plainState = o.plain_state != 0;
    if (o.log != nullptr)
        c.log.sink = [&c](LogLevel level, std::string_view text) { c.hostLog.add(static_cast<rivulet_level>(level), messageLine(text)); };
    for (const auto& [name, values] :
         {std::pair("sky_horizon", std::span<const float>(o.sky_horizon)), std::pair("sky_zenith", std::span<const float>(o.sky_zenith)),
          std::pair("sky_sun", std::span<const float>(o.sky_sun)), std::pair("clouds", std::span<const float>(&o.clouds, 1))})
        if (!areWithin(values, kBrightest)) return badInput(fmt::format("options.{} is not finite, or beyond {}", name, kBrightest));
    c.gl = noGl("no function was given that finds OpenGL's functions");
    if (o.find != nullptr) {
        if (Status loaded = gpu::load(o.find); !loaded) return loaded;
        c.gl = currentGlFacts();
        c.current = gpu::currentContext().context;
    }
    std::string backend = o.backend == nullptr ? "" : o.backend;
    const std::string device = o.device == nullptr ? "" : o.device;
    if (Status settled = settleBackend(backend, "auto", device); !settled) return settled;
    const Result<CpuOptions> cpu = cpuOptionsOf(o, c);
    if (!cpu) return cpu.error();
    const CallScope scope(c, Needs::drawing);
    c.device = makeDevice(backend, c.gl, c.log, device, *cpu);
    c.device->stopOn(&c.stop);
    c.memoryLimit = o.memory_limit;
    if (o.memory_limit > 0) c.device->limitMemory(o.memory_limit);
    c.name = fmt::format("{}: {}", backendName(c.device->backend()), c.device->info().name);
    if (!c.gl.present()) return ok();
    WaterRendererOptions look;
    look.log = c.log;
    if (o.memory_limit > 0) look.memoryLimit = o.memory_limit;
    if (isSet(o.sky_horizon)) look.sky.horizon = vectorOf(o.sky_horizon);
    if (isSet(o.sky_zenith)) look.sky.zenith = vectorOf(o.sky_zenith);
    look.sky.sun = unitAlong(isSet(o.sky_sun) ? vectorOf(o.sky_sun) : look.sky.sun);
    look.sky.sunlight = vec3(1.0F);
    look.sky.clouds = o.clouds;
    auto water = WaterRenderer::create(look);
    if (!water) return water.error();
    c.water = std::move(*water);
    return ok();
}

}  // namespace
}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

const char* rivulet_version(void) { return RIVULET_VERSION; }

rivulet_status rivulet_context_create(const rivulet_context_options* options, rivulet_context** context, rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (context == nullptr) return badInput("context is NULL: pass the address of a handle");
        *context = nullptr;
        const Result<rivulet_context_options> o = readStruct(options, "rivulet_context_options", "options");
        if (!o) return o.error();
        auto made = std::make_unique<rivulet_context>();
        if (Status done = createContext(*o, *made); !done) {
            rivulet_context_destroy(made.release());
            return done;
        }
        *context = made.release();
        return ok();
    });
    if (status == RIVULET_OK) (*context)->hostLog.deliver((*context)->callback);
    return status;
}

void rivulet_context_destroy(rivulet_context* context) {
    if (context == nullptr) return;
    bool gone = false;
    silently([&] {
        Status can = ready(*context, Needs::drawing);
        if (context->children > 0) can = badInput(fmt::format("destroy its {} worlds and skins first", context->children.load()));
        if (!can) return context->log.error(fmt::format("a context was not destroyed: {}", can.error().message));
        const CallScope scope(*context, Needs::drawing);
        context->water.reset();
        context->device.reset();
        gone = true;
    });
    context->hostLog.deliver(context->callback);
    if (gone) delete context;
}

rivulet_status rivulet_context_lost(rivulet_context* context, rivulet_error* why) {
    return guarded(why, [&]() -> Status {
        if (context == nullptr) return badInput("context is NULL");
        if (isDrawnHere(*context) || ((context->busy || context->callback.frame != nullptr) && !context->callback.left()))
            return badInput("the context is in use: report its loss after the call");
        context->lost = true;
        context->current = nullptr;
        return ok();
    });
}

const char* rivulet_context_device(const rivulet_context* context) { return context == nullptr ? "" : context->name.c_str(); }

rivulet_status rivulet_context_times(rivulet_context* context, rivulet_pass_time* times, size_t capacity, size_t* count,
                                     rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (context == nullptr) return badInput("context is NULL");
        if (count == nullptr || (times == nullptr && capacity > 0)) return badInput("count or times is NULL");
        if (Status can = ready(*context, Needs::device); !can) return can;
        if (Status there = stillThere(*context, Needs::device); !there) return there;
        const CallScope scope(*context, Needs::device);
        collectTimes(*context);
        std::vector<PassTime> all;
        for (const auto& [name, pass] : context->passes) all.push_back(pass);
        if (context->water)
            for (const PassTime& pass : context->water->times()) all.push_back(pass);
        *count = all.size();
        for (size_t k = 0; k < std::min(capacity, all.size()); ++k) {
            times[k] = {.name = {}, .ms = all[k].ms, .calls = all[k].calls};
            all[k].name.copy(times[k].name, sizeof times[k].name - 1);
        }
        if (all.size() <= capacity) context->passes.clear();
        return ok();
    });
    if (context != nullptr) context->hostLog.deliver(context->callback);
    return status;
}

void rivulet_context_stop(rivulet_context* context, uint32_t stop) {
    if (context != nullptr) context->stop.store(stop != 0, std::memory_order_relaxed);
}

size_t rivulet_context_memory(const rivulet_context* context) {
    if (context == nullptr) return 0;
    return context->device->bytesAllocated() + (context->water ? context->water->bytes() : 0);
}
