#include "fluid/capi/callbacks.h"

#include <unwind.h>

#include <cstdint>
#include <new>

namespace rivulet::capi {

namespace {

// The frames of this thread, from the newest on. Each begins where the one that it called ends, at its canonical frame address.
struct Search {
    uintptr_t frame = 0, by = 0;
    uintptr_t function = 0;  // of the frame before
    bool passed = false, waits = false;
};

_Unwind_Reason_Code look(_Unwind_Context* context, void* to) {
    auto& search = *static_cast<Search*>(to);
    if (_Unwind_GetCFA(context) > search.frame) {
        search.passed = true;
        search.waits = search.function == search.by;
        return _URC_END_OF_STACK;
    }
    search.function = _Unwind_GetRegionStart(context);
    return _URC_NO_REASON;
}

void run(Callback& callback, const std::function<void()>& call) {
    const CallbackScope scope(callback);
    try {
        call();
    } catch (...) {  // NOLINT(bugprone-empty-catch): an exception of the host's function has nowhere to go
    }
}

}  // namespace

CallbackScope::CallbackScope(Callback& callback) : callback_(callback) {
    auto* caller = static_cast<char*>(__builtin_return_address(0)) - 1;
    callback_ = {.frame = this, .by = _Unwind_FindEnclosingFunction(caller), .thread = std::this_thread::get_id()};
}

// Where the stack cannot be unwound to that frame, the callback counts as still running.
bool Callback::left() const {
    if (frame == nullptr || thread != std::this_thread::get_id()) return false;
    Search search{.frame = reinterpret_cast<uintptr_t>(frame), .by = reinterpret_cast<uintptr_t>(by)};
    _Unwind_Backtrace(look, &search);
    return search.passed && !search.waits;
}

void HostLog::add(rivulet_level level, std::string sentence) {
    if (function == nullptr) return;
    try {
        later([f = function, u = user, level, text = std::move(sentence)] { f(u, level, text.c_str()); });
    } catch (const std::bad_alloc&) {  // NOLINT(bugprone-empty-catch): a sentence less, and the call goes on
    }
}

void HostLog::later(std::function<void()> call) {
    const std::scoped_lock lock(mutex_);
    waiting_.push_back(std::move(call));
}

void HostLog::deliver(Callback& callback) {
    if (callback.frame != nullptr) return;
    for (;;) {
        std::unique_lock lock(mutex_);
        if (waiting_.empty()) return;
        const std::function<void()> call = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        run(callback, call);
    }
}

}  // namespace rivulet::capi
