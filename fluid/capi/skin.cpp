// rivulet.h: skins.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>

#include "engine/core/json.h"
#include "engine/gpu/host_buffer.h"
#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/skins.h"
#include "fluid/capi/versioned.h"
#include "fluid/flow/unwrap.h"
#include "fluid/sim/world/contradictions.h"

using namespace rivulet;
using namespace rivulet::capi;

namespace {

Status createSkin(rivulet_context& context, const rivulet_skin_options& o, rivulet_skin& s) {
    s.context = &context;
    if (o.mesh == nullptr) return badInput("mesh is NULL: a skin needs a mesh with uvs");
    const Result<rivulet_mesh> given = readStruct(o.mesh, "rivulet_mesh", "mesh");
    if (!given) return given.error();
    Result<HostMesh> mesh = meshOf(*given, "mesh");
    if (!mesh) return mesh.error();
    if (mesh->uvs.empty()) return badInput("mesh.uvs is NULL: the skin's map needs them");
    SurfaceFlowParams params;
    if (o.json != nullptr)
        if (Status read = readJson(o.json, "json", [&](ParamVisitor& v) { params.visit(v); }); !read) return read;
    Result<FlowMesh> cleaned = makeFlowMesh(mesh->view());
    if (!cleaned) return cleaned.error();
    if (const std::string found = cleaned->report.sentence(); !found.empty()) context.log.notice("mesh: " + found);
    const std::vector<vec2> uvs = cornerUvs(*cleaned, mesh->view());
    const int size = o.map_size == 0 ? 1024 : o.map_size;
    // The texture is drawn over the host's UVs, so that new ones would be of no use to it: it is told what is wrong.
    if (const UvReport report = checkUvs(*cleaned, uvs, std::clamp(size, 256, 2048)); !report.usable())
        context.log.notice(fmt::format(
            "mesh.uvs: {} The texture shows less than the skin carries there; give UVs whose charts do not overlap, such as those of "
            "skinUvs (fluid/flow/unwrap.h) or of a modelling program",
            report.sentence()));
    Result<SurfaceFlow> flow = SurfaceFlow::create(*context.device, std::move(*cleaned), params);
    if (!flow) return flow.error();
    s.flow.emplace(std::move(*flow));
    s.placed.emplace(*s.flow, [&s](double time) { return s.motion.at(time); });
    s.vertices = mesh->positions.size();
    Result<FlowMaps> maps = FlowMaps::create(*s.flow, uvs, size);
    if (!maps) return maps.error();
    s.maps.emplace(std::move(*maps));
    if (!context.gl.present() || context.lost) return ok();
    Result<FlowLayer> layer = FlowLayer::create(size);
    if (!layer) return layer.error();
    s.layer.emplace(std::move(*layer));
    return ok();
}

}  // namespace

namespace rivulet::capi {

Needs needsOf(const rivulet_skin_inputs* inputs) {
    constexpr size_t kAt = offsetof(rivulet_skin_inputs, positions_buffer);
    size_t size = 0;
    uint32_t buffer = 0;
    if (inputs != nullptr) std::memcpy(&size, inputs, sizeof size);
    if (size >= kAt + sizeof buffer) std::memcpy(&buffer, reinterpret_cast<const std::byte*>(inputs) + kAt, sizeof buffer);
    return buffer == 0 ? Needs::device : Needs::drawing;
}

}  // namespace rivulet::capi

namespace {

Status checkPositionsBuffer(const rivulet_skin& skin, const rivulet_skin_inputs& in) {
    if (in.positions != nullptr) return badInput("inputs.positions and inputs.positions_buffer are both set: give one of them");
    if (!skin.context->gl.present())
        return badInput("inputs.positions_buffer is set, and the context has no OpenGL: set rivulet_context_options.find");
    const Result<size_t> bytes = gpu::hostBufferSize(in.positions_buffer, "inputs.positions_buffer");
    if (!bytes) return bytes.error();
    const size_t needed = skin.vertices * sizeof(vec4);
    if (*bytes >= needed) return ok();
    return badInput(
        fmt::format("inputs.positions_buffer has {} bytes: a skin of {} vertices needs {}, a vec4 each", *bytes, skin.vertices, needed));
}

// The host's buffer in one of the device's: the host may write the next frame's positions while this step still runs.
Status copyPositions(rivulet_skin& skin, uint32_t from) {
    Device& device = *skin.context->device;
    const size_t bytes = skin.vertices * sizeof(vec4);
    if (!skin.moved) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        skin.moved = std::move(*made);
    }
    if (device.backend() == Backend::gl) {
        gpu::copyHostBuffer(from, static_cast<uint32_t>(skin.moved.handle()), bytes);
        return ok();
    }
    skin.readBack.resize(skin.vertices);
    gpu::readHostBuffer(from, std::as_writable_bytes(std::span(skin.readBack)));
    device.writeAll<vec4>(skin.moved, skin.readBack);
    return ok();
}

constexpr vec3 kEarth(0.0F, -9.81F, 0.0F);  // m/s^2

}  // namespace

dmat4 rivulet_skin::Motion::at(double time) const {
    const double share = seconds > 0 ? (time - begin) / seconds : 1;
    if (share == 1 || before == after) return after;
    const glm::dquat turn = glm::slerp(glm::quat_cast(glm::dmat3(before)), glm::quat_cast(glm::dmat3(after)), share);
    dmat4 m = glm::mat4_cast(turn);
    m[3] = glm::mix(before[3], after[3], share);
    return m;
}

namespace rivulet::capi {

Status checkSkinStep(rivulet_skin& skin, const rivulet_skin_inputs& in, double seconds) {
    if (!std::isfinite(seconds) || seconds > kLongestFrame)
        return badInput(fmt::format("seconds is {}: give a finite time of at most {} s", seconds, kLongestFrame));
    for (const float* given : {in.gravity, in.wind})
        if (given != nullptr && !isWithin(vectorOf(given), kMostGravity))
            return badInput(fmt::format("inputs.gravity or inputs.wind is not finite, or beyond {} m/s^2 or m/s", kMostGravity));
    if (in.to_world != nullptr && !areWithin({in.to_world, 16}, kMostDistance))
        return badInput(fmt::format("inputs.to_world is not finite, or beyond {}", kMostDistance));
    if (in.positions_buffer != 0)
        if (Status can = checkPositionsBuffer(skin, in); !can) return can;
    if (!(seconds > 0)) return ok();
    Device& device = *skin.context->device;
    device.goOn();  // another owner of buffers may have been interrupted
    if (skin.interrupted) return failed("an earlier step of the skin was interrupted: create it anew");
    if (device.stopAsked()) return failed("nothing was stepped: a stop is asked with rivulet_context_stop");
    return ok();
}

void placeSkin(rivulet_skin& skin, const rivulet_skin_inputs& in, double begin, double seconds) {
    const dmat4 after = in.to_world != nullptr ? dmat4(matrixOf(in.to_world)) : dmat4(1.0);
    skin.motion = {skin.steps++ > 0 ? skin.motion.after : after, after, begin, seconds};
}

Status stepSkin(rivulet_skin& skin, const rivulet_skin_inputs& in, const vec3& gravity, double seconds) {
    SurfaceFlowInputs to{.gravity = gravity, .toWorld = skin.motion.after};
    if (in.wind != nullptr) to.wind = vectorOf(in.wind);
    if (in.positions != nullptr) {
        skin.positions.clear();
        for (size_t k = 0; k < skin.vertices; ++k) skin.positions.push_back(vectorOf(in.positions + 3 * k));
        to.positions = skin.positions;
    }
    if (in.positions_buffer != 0) {
        if (Status copied = copyPositions(skin, in.positions_buffer); !copied) return copied;
        to.moved = &skin.moved;
    }
    const Status stepped = skin.flow->step(to, seconds);
    if ((skin.interrupted = skin.context->device->interrupted()))
        return failed("the step was interrupted: end the stop, then create the skin anew");
    return stepped;
}

}  // namespace rivulet::capi

rivulet_status rivulet_skin_create(rivulet_context* context, const rivulet_skin_options* options, rivulet_skin** skin, rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (skin == nullptr) return badInput("skin is NULL: pass the address of a handle");
        *skin = nullptr;
        if (context == nullptr) return badInput("context is NULL: create one with rivulet_context_create");
        const Result<rivulet_skin_options> o = readStruct(options, "rivulet_skin_options", "options");
        if (!o) return o.error();
        if (Status can = ready(*context, Needs::drawing); !can) return can;
        if (Status there = stillThere(*context, Needs::device); !there) return there;
        const CallScope scope(*context, Needs::drawing);
        auto made = std::make_unique<rivulet_skin>();
        if (Status done = createSkin(*context, *o, *made); !done) return done;
        made->serial = ++context->skinsMade;
        ++context->children;
        *skin = made.release();
        return ok();
    });
    if (context != nullptr) context->hostLog.deliver(context->callback);
    return status;
}

void rivulet_skin_destroy(rivulet_skin* skin) { destroy(skin); }

rivulet_status rivulet_skin_add(rivulet_skin* skin, const float* place, double microlitres, rivulet_error* why) {
    return with(skin, why, Needs::device, [&]() -> Status {
        if (place == nullptr) return badInput("place is NULL");
        const vec3 at = vectorOf(place);
        if (!isFinite(at)) return badInput("place is not finite");
        constexpr double kMost = 4000;  // microlitres, as 32 bits of picolitres hold
        if (!(microlitres > 0) || microlitres > kMost)
            return badInput(fmt::format("a drop of {} microlitres: give more than 0 and at most {}", microlitres, kMost));
        skin->flow->add(skin->placed->nearest(at), static_cast<uint32_t>(std::lround(1.0e6 * microlitres)));
        return ok();
    });
}

rivulet_status rivulet_skin_step(rivulet_skin* skin, const rivulet_skin_inputs* inputs, double seconds, rivulet_error* why) {
    return with(skin, why, needsOf(inputs), [&]() -> Status {
        const Result<rivulet_skin_inputs> in = readStruct(inputs, "rivulet_skin_inputs", "inputs");
        if (!in) return in.error();
        if (Status sound = checkSkinStep(*skin, *in, seconds); !sound || !(seconds > 0)) return sound;
        skin->maps->leaveOutHanging(false);
        placeSkin(*skin, *in, skin->motion.begin + skin->motion.seconds, seconds);
        return stepSkin(*skin, *in, in->gravity != nullptr ? vectorOf(in->gravity) : kEarth, seconds);
    });
}

rivulet_status rivulet_skin_texture(rivulet_skin* skin, uint32_t* texture, rivulet_error* why) {
    return with(skin, why, Needs::drawing, [&]() -> Status {
        if (texture == nullptr) return badInput("texture is NULL");
        if (!skin->layer) return badInput("the context has no OpenGL: set rivulet_context_options.find");
        skin->maps->draw(*skin->flow);
        skin->layer->update(*skin->maps);
        *texture = skin->layer->texture().name();
        return ok();
    });
}

rivulet_status rivulet_skin_stats_of(const rivulet_skin* skin, rivulet_skin_stats* stats, rivulet_error* why) {
    return with(skin, why, Needs::device, [&]() -> Status {
        const SurfaceFlow::Ledger l = skin->flow->ledger();
        constexpr double kPicolitre = 1.0e-15;  // m^3
        rivulet_skin_stats full{};
        full.drops = skin->flow->drops().size();
        full.added = kPicolitre * static_cast<double>(l.added);
        full.on_skin = kPicolitre * static_cast<double>(l.drops + l.film);
        full.left = kPicolitre * static_cast<double>(l.left);
        full.evaporated = kPicolitre * static_cast<double>(l.evaporated);
        full.refused = kPicolitre * static_cast<double>(l.refused);
        return writeStruct(full, stats, "rivulet_skin_stats", "stats");
    });
}
