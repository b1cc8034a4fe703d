// What each call of rivulet.h has around it: nothing is thrown, one call at a time, OpenGL's state is kept. A call that the host left by
// longjmp, out of one of its own functions, is ended by the next one.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "engine/core/exception_error.h"
#include "engine/core/message_line.h"
#include "engine/gpu/current_context.h"
#include "engine/gpu/lost_context.h"
#include "fluid/capi/handles.h"

namespace rivulet::capi {

// What a call uses: host memory alone, the device, or the renderer.
enum class Needs { memory, device, drawing };

inline bool needsGl(const rivulet_context& context, Needs needs) {
    return context.gl.present() && !context.lost &&
           (needs == Needs::drawing || (needs == Needs::device && context.device->backend() == Backend::gl));
}

inline Status notCurrent() {
    return badInput("the OpenGL context that this was created in is not current on this thread: make it current first");
}
inline Status lostContext() {
    return failed("the OpenGL context is lost: destroy the worlds, the skins and the context, and create others");
}

// Whether this is called by a function of the host that draws a part of a snapshot.
inline bool isDrawnHere(const rivulet_context& context) { return context.drawer.load() == std::this_thread::get_id(); }

// Error (badInput): another call of the same context is running; OpenGL is needed, and the context's OpenGL context is not current.
inline Status ready(rivulet_context& context, Needs needs) {
    if (isDrawnHere(context)) return badInput("the context is in use: a renderer must not call back into it");
    const bool left = context.callback.left();
    if ((context.busy || context.callback.frame != nullptr) && !left)
        return badInput("the context is in use: callbacks must not call back into it, and only one thread at a time may use it");
    if ((needsGl(context, needs) || context.hostGl) && context.current != nullptr && gpu::currentContext().context != context.current)
        return notCurrent();
    if (left) {
        if (context.hostGl) context.drawing = false;
        context.hostGl.reset();  // restores the host's state
        gpu::LostContext::here() = false;
        JobsScope::end();
        context.callback = {};
        context.busy = false;
    }
    if (needsGl(context, needs) && context.drawing)
        return badInput(
            "a snapshot of the context is being drawn on another thread: only rivulet_world functions that need no OpenGL may run");
    return ok();
}

inline gpu::HostState::Saves savesOf(const rivulet_context& context) {
    return context.plainState ? gpu::HostState::nothing : gpu::HostState::rivulets;
}

// One call: the context is busy, loops run on its jobs and, if the call needs OpenGL, the host's OpenGL state is restored at the end.
// OpenGL objects of a context that has ended are dropped.
class CallScope {
  public:
    CallScope(rivulet_context& context, Needs needs) : context_(context), jobs_(context.jobs) {
        if (needsGl(context, needs)) context_.hostGl.emplace(savesOf(context));  // may throw
        if (context_.hostGl) context_.drawing = true;
        if (context.lost) lost_.emplace();
        context_.busy = true;
    }
    ~CallScope() {
        if (context_.hostGl) context_.drawing = false;
        context_.hostGl.reset();
        context_.busy = false;
    }
    CallScope(const CallScope&) = delete;
    CallScope& operator=(const CallScope&) = delete;

  private:
    rivulet_context& context_;
    JobsScope jobs_;
    std::optional<gpu::LostContext> lost_;
};

inline rivulet_status statusOf(const Status& status, rivulet_error* why) {
    if (why != nullptr) why->message[0] = '\0';
    if (status) return RIVULET_OK;
    if (why != nullptr) {
        const std::string text = messageLine(status.error().message);
        size_t n = std::min(text.size(), sizeof why->message - 1);
        while (n > 0 && n < text.size() && (static_cast<unsigned char>(text[n]) & 0xC0U) == 0x80) --n;  // no half character
        std::memcpy(why->message, text.data(), n);
        why->message[n] = '\0';
    }
    return status.error().fault == Fault::badInput ? RIVULET_BAD_INPUT : RIVULET_FAILED;
}

// Runs `work`, which returns a Status; an exception becomes one.
template <class Work>
rivulet_status guarded(rivulet_error* why, const Work& work) {
    try {
        return statusOf(work(), why);
    } catch (...) {
        try {
            return statusOf(errorOf(std::current_exception()), why);
        } catch (...) {  // there is no memory for a message either
            constexpr std::string_view kWhy = "out of memory";
            if (why != nullptr) why->message[kWhy.copy(why->message, kWhy.size())] = '\0';
            return RIVULET_FAILED;
        }
    }
}

// For functions that return nothing: what `work` throws, for want of memory for a message, is dropped.
template <class Work>
void silently(const Work& work) {
    try {
        work();
    } catch (...) {  // NOLINT(bugprone-empty-catch)
    }
}

inline const char* kindOf(const rivulet_world*) { return "world"; }
inline const char* kindOf(const rivulet_skin*) { return "skin"; }
inline const char* kindOf(const rivulet_snapshot*) { return "snapshot"; }

// Error (failed): OpenGL is needed and its context has ended; the context's device is lost, so that its results are invalid.
inline Status stillThere(const rivulet_context& context, Needs needs) {
    if (needs == Needs::memory || context.device == nullptr) return ok();
    // OpenCL that shares memory with OpenGL ends with it.
    if (context.lost && (needs == Needs::drawing || context.device->backend() == Backend::gl || context.device->glShare().by))
        return lostContext();
    const DeviceHealth health = context.device->health();
    if (health.state != DeviceHealth::lost) return ok();
    return failed(fmt::format("{} {}; create a context of another backend", context.name, health.why));
}

// Runs `work` in the CallScope of a world or a skin. Error (badInput): NULL, or as ready(). (failed): as stillThere(), before or after.
template <class Handle, class Work>
rivulet_status with(Handle* handle, rivulet_error* why, Needs needs, const Work& work) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (handle == nullptr) return badInput(fmt::format("{} is NULL", kindOf(handle)));
        if (Status can = ready(*handle->context, needs); !can) return can;
        if (Status there = stillThere(*handle->context, needs); !there) return there;
        const CallScope scope(*handle->context, needs);
        const Status done = work();
        if (Status there = stillThere(*handle->context, needs); !there) return there;
        return done;
    });
    if (handle != nullptr) handle->context->hostLog.deliver(handle->context->callback);
    return status;
}

// Before a handle is deleted: a world's recording gets its end.
inline void end(rivulet_world* world) {
    if (!world->recording || world->recording->frames() == 0) return;
    if (const Status closed = world->recording->close(); !closed) world->context->log.error(closed.error().message);
}
inline void end(rivulet_skin*) {}
inline void end(rivulet_snapshot*) {}

// If it cannot be destroyed now, this is logged.
template <class Handle>
void destroy(Handle* handle) {
    if (handle == nullptr) return;
    rivulet_context& context = *handle->context;
    silently([&] {
        if (Status can = ready(context, Needs::drawing); can) {
            const CallScope scope(context, Needs::drawing);
            --context.children;
            end(handle);
            delete handle;
        } else {
            context.log.error(fmt::format("a {} was not destroyed: {}", kindOf(handle), can.error().message));
        }
    });
    context.hostLog.deliver(context.callback);
}

}  // namespace rivulet::capi
