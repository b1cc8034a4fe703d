// What is behind rivulet.h's handles, and how a call is kept from throwing.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/current_context.h"
#include "engine/gpu/host_state.h"
#include "fluid/capi/rivulet.h"
#include "fluid/flow/flow_layer.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"

struct rivulet_context {
    rivulet::Log log;
    rivulet::GlFacts gl;
    std::unique_ptr<rivulet::Device> device;
    std::unique_ptr<rivulet::WaterRenderer> water;  // null: there is no OpenGL
    std::string name;
    std::map<std::string, rivulet::PassTime> passes;  // of the simulation, since rivulet_context_times()
    double deviceMs = 0;                              // of the simulation, since the start
    size_t memoryLimit = 0;                           // as rivulet_context_options
    int children = 0;                                 // worlds and skins
    void* current = nullptr;                          // OpenGL's own context, which it was made in; null: there is none, or nobody knows
    bool busy = false;                                // a call is under way
};

namespace rivulet::capi {

// The part of a scene file that a host's world has.
struct WorldParams {
    FluidParams fluid;
    std::vector<EmitterParams> emitters;
    std::vector<SinkParams> sinks;
    FluidLookParams look;
    void visit(ParamVisitor& v);
};

// A host's functions as a BodyHost.
struct BodyCallbacks {
    rivulet_body_host host{};
    std::vector<rivulet_body_load> loads;
    std::vector<rivulet_body_state> states;
};

// What a call works with: the host's memory alone, the device, or what draws.
enum class Needs { memory, device, drawing };

inline bool needsGl(const rivulet_context& context, Needs needs) {
    return context.gl.present() && (needs == Needs::drawing || (needs == Needs::device && context.device->backend() == Backend::gl));
}

// Error (badInput): another call of the same context is under way; OpenGL is needed, and what it was made in is not current.
inline Status ready(const rivulet_context& context, Needs needs) {
    if (context.busy) return badInput("the context is at work: callbacks must not call back into it, and one thread at a time may use it");
    if (needsGl(context, needs) && context.current != nullptr && gpu::currentContext().context != context.current)
        return badInput("the OpenGL context that this was created in is not current on this thread: make it current first");
    return ok();
}

// Hears of what the device did until now.
inline void hearTimes(rivulet_context& context) {
    for (const PassTime& heard : context.device->takeTimes()) {
        PassTime& all = context.passes[heard.name];
        all.name = heard.name;
        all.ms += heard.ms;
        all.calls += heard.calls;
        context.deviceMs += heard.ms;
    }
}

// While it lives the context is busy and, where the call needs OpenGL, its state is ours.
class Keep {
  public:
    Keep(rivulet_context& context, Needs needs) : context_(context) {
        context_.busy = true;
        if (needsGl(context, needs)) state_.emplace();
    }
    ~Keep() { context_.busy = false; }
    Keep(const Keep&) = delete;
    Keep& operator=(const Keep&) = delete;

  private:
    rivulet_context& context_;
    std::optional<gpu::HostState> state_;
};

// What a caller's struct says of its own size. `type` and `name`: what an error calls it. Error (badInput): no version of it has that size:
// it was not set, or to the size of a pointer.
inline Result<size_t> sizeOf(const void* given, const char* type, const std::string& name) {
    constexpr size_t kMost = 4096;
    size_t size = 0;
    std::memcpy(&size, given, sizeof size);
    if (size <= sizeof size || size > kMost) return badInput(fmt::format("{}.size is {}: set it to sizeof({})", name, size, type));
    return size;
}

// What a caller filled, of whichever version its header is: what it does not know of is 0. Errors as sizeOf.
template <class T>
Result<T> taken(const T* given, const char* type, const std::string& name) {
    T full{};
    if (given == nullptr) return full;
    const Result<size_t> size = sizeOf(given, type, name);
    if (!size) return size.error();
    std::memcpy(static_cast<void*>(&full), given, std::min(*size, sizeof(T)));
    const auto* bytes = reinterpret_cast<const unsigned char*>(given);
    if (std::any_of(bytes + std::min(*size, sizeof(T)), bytes + *size, [](unsigned char b) { return b != 0; }))
        return badInput(fmt::format("{} asks for what a later rivulet.h has, and this library is {}", name, rivulet_version()));
    return full;
}

// Fills a caller's struct, of whichever version its header is: what it does not know of is left out. Errors as sizeOf, or NULL.
template <class T>
Status handOver(T full, T* to, const char* type, const std::string& name) {
    if (to == nullptr) return badInput(name + " is NULL");
    const Result<size_t> size = sizeOf(to, type, name);
    if (!size) return size.error();
    full.size = *size;
    std::memcpy(static_cast<void*>(to), &full, std::min(*size, sizeof(T)));
    return ok();
}

inline rivulet_status answer(const Status& status, rivulet_error* why) {
    if (why != nullptr) why->message[0] = '\0';
    if (status) return RIVULET_OK;
    if (why != nullptr) {
        const std::string& text = status.error().message;
        const size_t n = std::min(text.size(), sizeof why->message - 1);
        std::memcpy(why->message, text.data(), n);
        why->message[n] = '\0';
    }
    return status.error().fault == Fault::badInput ? RIVULET_BAD_INPUT : RIVULET_FAILED;
}

// Runs what gives a Status; what is thrown becomes one.
template <class Work>
rivulet_status guarded(rivulet_error* why, const Work& work) {
    try {
        return answer(work(), why);
    } catch (const std::bad_alloc&) {
        return answer(failed("out of memory"), why);
    } catch (const std::exception& e) {
        return answer(failed(e.what()), why);
    } catch (...) {
        return answer(failed("something was thrown that says nothing of itself"), why);
    }
}

inline void put(const vec3& v, float* to) { std::copy_n(&v.x, 3, to); }
inline bool given(const float* v) { return v[0] != 0 || v[1] != 0 || v[2] != 0; }
inline vec3 vectorOf(const float* v) { return {v[0], v[1], v[2]}; }
inline mat4 matrixOf(const float* m) {
    mat4 out;
    std::memcpy(&out[0][0], m, sizeof out);
    return out;
}
Pose poseOf(const rivulet_pose& pose);
rivulet_pose poseOf(const Pose& pose);

// Spans over a caller's mesh. Error (badInput): NULL arrays, or counts that make no triangles.
struct HostMesh {
    std::vector<vec3> positions;
    std::vector<vec2> uvs;
    std::vector<uint32_t> indices;
    MeshView view() const { return {.positions = positions, .indices = indices, .normals = {}, .uvs = uvs}; }
};
Result<HostMesh> meshOf(const rivulet_mesh& mesh, const std::string& name);

}  // namespace rivulet::capi

struct rivulet_world {
    rivulet_context* context = nullptr;
    rivulet::capi::WorldParams params;
    std::vector<std::unique_ptr<rivulet::VoxelField>> fields;
    std::vector<rivulet::Pose> poses;  // of the walls that move, as last asked for
    std::unique_ptr<rivulet::capi::BodyCallbacks> callbacks;
    std::unique_ptr<rivulet::FreeBodies> free;
    std::unique_ptr<rivulet::FluidWorld> world;
    rivulet::FluidUpload upload;
    double deviceMs = 0;  // the context's, when this was last stepped
};

namespace rivulet::capi {

inline const char* kindOf(const rivulet_world*) { return "world"; }
inline const char* kindOf(const rivulet_skin*) { return "skin"; }

// Runs `work` on a world or skin that is there, OpenGL's state kept where it needs OpenGL. Errors as ready().
template <class Handle, class Work>
rivulet_status with(Handle* handle, rivulet_error* why, Needs needs, const Work& work) {
    return guarded(why, [&]() -> Status {
        if (handle == nullptr) return badInput(fmt::format("{} is NULL", kindOf(handle)));
        if (Status can = ready(*handle->context, needs); !can) return can;
        const Keep keep(*handle->context, needs);
        return work();
    });
}

// What cannot be destroyed now stays, and the log says why.
template <class Handle>
void destroy(Handle* handle) {
    if (handle == nullptr) return;
    rivulet_context& context = *handle->context;
    if (Status can = ready(context, Needs::drawing); !can)
        return context.log.error(fmt::format("a {} was to be destroyed, and stays: {}", kindOf(handle), can.error().message));
    const Keep keep(context, Needs::drawing);
    --context.children;
    delete handle;
}

}  // namespace rivulet::capi

struct rivulet_skin {
    rivulet_context* context = nullptr;
    size_t vertices = 0;
    std::optional<rivulet::SurfaceFlow> flow;
    std::optional<rivulet::FlowMaps> maps;
    std::optional<rivulet::FlowLayer> layer;
    std::vector<rivulet::vec3> positions;
};
