// What each call of rivulet.h has around it: nothing is thrown, one call at a time, OpenGL's state is kept.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "engine/gpu/current_context.h"
#include "engine/gpu/host_state.h"
#include "fluid/capi/handles.h"

namespace rivulet::capi {

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
