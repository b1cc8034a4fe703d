// Jobs: the threads that run parallel loops, as function pointers. A host gives its own job system; otherwise loops run on oneTBB, or on
// std::threads where the library is built without oneTBB (RIVULET_WITHOUT_TBB) and in builds with ThreadSanitizer: oneTBB is not compiled
// with ThreadSanitizer, which therefore cannot see how it synchronizes its threads and would report races that do not exist.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "engine/core/abi.h"

namespace rivulet {

// Results do not depend on the jobs or the number of workers, bit for bit. Foam is an exception: its slots depend on the order of threads.
struct Jobs {
    void* user = nullptr;  // passed to `run`
    // Calls function(argument, k) once for each k from 0 to count - 1, in any order, on any threads, and returns when all calls have
    // returned. `count` is at most `workers`. The calls do not wait for each other: they may also run one after another. `function` throws
    // nothing. Several threads may call `run` at a time; a loop within a call of `function` runs on that thread alone and does not call
    // `run`. Null: the library's own threads.
    void (*run)(void* user, void (*function)(void* argument, size_t k), void* argument, size_t count) = nullptr;
    int workers = 0;  // calls that can run at a time, the calling thread among them: 1 or more if `run` is given
    // Runs function(argument) beside the frames, on any thread, and returns at once; called at any time, also within `function`. Null: a
    // thread of its own.
    void (*start)(void* user, void (*function)(void* argument), void* argument) = nullptr;
    // While true, loops end with LoopStopped before their next part. Null: nothing stops them.
    const std::atomic<bool>* stop = nullptr;
};
struct LoopStopped {};

// Of loops that run on the calling thread alone.
Jobs aloneUntil(const std::atomic<bool>* stop);

// While it lives, parallel loops of this thread run on these jobs. The innermost scope counts.
class JobsScope {
  public:
    explicit JobsScope(const Jobs& jobs);
    ~JobsScope();
    JobsScope(const JobsScope&) = delete;
    JobsScope& operator=(const JobsScope&) = delete;

    static void end();  // of all scopes of this thread that were left by longjmp

  private:
    Jobs before_;
};

Jobs currentJobs();  // of this thread
int jobWorkers();    // those that take part in a loop of this thread

// A number of the library's own threads, the calling one among them, as Jobs. Destruction waits for them.
class Workers {
  public:
    // 0: one for each processor; with oneTBB those of the calling thread, and jobs() has no `run`.
    explicit Workers(int threads);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;
    Jobs jobs() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

// Runs body(context, begin, end) for the parts [k grain, (k + 1) grain) of [0, count), in any order, and returns when all have returned.
// Rethrows one of the exceptions that they threw; parts that have not begun by then are left out.
using LoopBody = void (*)(const void* context, size_t begin, size_t end);
void runLoop(size_t count, size_t grain, LoopBody body, const void* context);

}  // namespace rivulet
