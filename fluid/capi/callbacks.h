// The host's functions, as the library calls them: what they throw does not pass, they may not call back, and a host may leave one by
// longjmp.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "fluid/capi/rivulet.h"

namespace rivulet::capi {

// A function of the host that is running.
struct Callback {
    const void* frame = nullptr;  // in the stack frame of the function that called it; null: none is running
    const void* by = nullptr;     // where that function begins
    std::thread::id thread;
    // Whether the host left it by longjmp: its caller's frame is then no longer on this thread's stack.
    bool left() const;
};

// Around a call of a host's function: a local variable.
class CallbackScope {
  public:
    [[gnu::noinline]] explicit CallbackScope(Callback& callback);
    ~CallbackScope() { callback_ = {}; }
    CallbackScope(const CallbackScope&) = delete;
    CallbackScope& operator=(const CallbackScope&) = delete;

  private:
    Callback& callback_;
};

// Sentences for the host's log, and other calls of its functions. They wait until the call that has them is done: what the host's function
// does can then leave nothing half done.
class HostLog {
  public:
    void (*function)(void* user, rivulet_level level, const char* sentence) = nullptr;
    void* user = nullptr;
    void add(rivulet_level level, std::string sentence);  // from any thread
    void later(std::function<void()> call);               // from any thread; what it throws is dropped
    void deliver(Callback& callback);                     // unless a function of the host is running: the call that runs it delivers them

  private:
    std::mutex mutex_;
    std::deque<std::function<void()>> waiting_;
};

}  // namespace rivulet::capi
