#include "engine/core/jobs.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/keep_loaded.h"
#include "engine/core/sanitized.h"
#include "engine/core/thread_pool.h"

#ifndef RIVULET_WITHOUT_TBB
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_scheduler_observer.h>
#include <oneapi/tbb/version.h>
#endif

namespace rivulet {

namespace {

// Of each thread, without a destructor: a library that is unloaded leaves none behind.
thread_local Jobs current;
thread_local bool alone = false;  // this thread runs a part of Jobs::run: a loop inside it runs on this thread

#ifndef RIVULET_WITHOUT_TBB
constexpr bool kTbb = !kThreadSanitized;

// oneTBB's threads run until the process ends, in its library: they would crash if it were unloaded together with the one that uses it.
bool keepTbb() {
    keepLoaded(reinterpret_cast<const void*>(&TBB_runtime_version));
    return true;
}

void runOnTbb(void (*function)(void*, size_t), void* argument, size_t count) {
    static const bool kept = keepTbb();
    (void)kept;
    tbb::parallel_for(
        size_t{0}, count, [=](size_t k) { function(argument, k); }, tbb::simple_partitioner());
}
int tbbWorkers() { return tbb::this_task_arena::max_concurrency(); }
void runInArena(void* arena, void (*function)(void*, size_t), void* argument, size_t count) {
    static_cast<tbb::task_arena*>(arena)->execute([=] { runOnTbb(function, argument, count); });
}
#else
constexpr bool kTbb = false;

void runOnTbb(void (*)(void*, size_t), void*, size_t) {}
int tbbWorkers() { return 1; }
void runInArena(void*, void (*)(void*, size_t), void*, size_t) {}
#endif

// Without oneTBB. ThreadSanitizer is slow with many threads.
int defaultWorkers() { return std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kThreadSanitized ? 4 : 256); }

// Threads that end with the loop.
void runOnNewThreads(void (*function)(void*, size_t), void* argument, size_t count) {
    std::vector<std::thread> others;
    others.reserve(count - 1);
    size_t begun = 1;
    try {
        for (; begun < count; ++begun) others.emplace_back(function, argument, begun);
    } catch (const std::system_error&) {  // the system gives no more threads: this one does the rest
    }
    function(argument, 0);
    for (; begun < count; ++begun) function(argument, begun);
    for (std::thread& thread : others) thread.join();
}

void runInPool(void* pool, void (*function)(void*, size_t), void* argument, size_t count) {
    static_cast<ThreadPool*>(pool)->run(function, argument, count);
}

void mayStop(const Jobs& jobs) {
    if (jobs.stop != nullptr && jobs.stop->load(std::memory_order_relaxed)) throw LoopStopped();
}

struct Loop {
    size_t count, grain;
    LoopBody body;
    const void* context;
    Jobs jobs;
    std::atomic<size_t> next = 0;
    std::atomic_flag failed;
    std::exception_ptr thrown;

    void work() {
        // Loops nest in oneTBB alone.
        const Jobs jobsBefore = std::exchange(current, jobs.run == runInArena ? Jobs{} : jobs);
        const bool aloneBefore = std::exchange(alone, !kTbb || (jobs.run != nullptr && jobs.run != runInArena));
        try {
            for (size_t begin = 0; (begin = next.fetch_add(grain, std::memory_order_relaxed)) < count;) {
                mayStop(jobs);
                body(context, begin, std::min(begin + grain, count));
            }
        } catch (...) {
            if (!failed.test_and_set()) thrown = std::current_exception();
            next.store(count, std::memory_order_relaxed);
        }
        current = jobsBefore;
        alone = aloneBefore;
    }
};

}  // namespace

JobsScope::JobsScope(const Jobs& jobs) : before_(std::exchange(current, jobs)) {}

JobsScope::~JobsScope() { current = before_; }

void JobsScope::end() { current = {}; }

Jobs aloneUntil(const std::atomic<bool>* stop) {
    Jobs jobs;
    jobs.run = [](void*, void (*function)(void*, size_t), void* argument, size_t count) {
        for (size_t k = 0; k < count; ++k) function(argument, k);
    };
    jobs.workers = 1;
    jobs.stop = stop;
    return jobs;
}

Jobs currentJobs() { return current; }

int jobWorkers() {
    if (alone) return 1;
    if (current.run != nullptr) return std::max(current.workers, 1);
    return kTbb ? tbbWorkers() : defaultWorkers();
}

void runLoop(size_t count, size_t grain, LoopBody body, const void* context) {
    if (count == 0) return;
    const size_t parts = (count - 1) / grain + 1, calls = std::min(parts, static_cast<size_t>(jobWorkers()));
    if (calls == 1) {
        for (size_t begin = 0; begin < count; begin += grain) {
            mayStop(current);
            body(context, begin, std::min(begin + grain, count));
        }
        return;
    }
    Loop loop{.count = count, .grain = grain, .body = body, .context = context, .jobs = current, .next = 0, .failed = {}, .thrown = {}};
    const auto function = [](void* argument, size_t) { static_cast<Loop*>(argument)->work(); };
    if (current.run != nullptr)
        current.run(current.user, function, &loop, calls);
    else if (kTbb)
        runOnTbb(function, &loop, calls);
    else
        runOnNewThreads(function, &loop, calls);
    if (loop.thrown) std::rethrow_exception(loop.thrown);
}

#ifndef RIVULET_WITHOUT_TBB
namespace {

// The threads of oneTBB in an arena. A loop ends before its threads have returned from it: the last instructions that they run are those of
// this library. Destruction waits until they have left the arena, so that the library can be unloaded.
class Arena : public tbb::task_scheduler_observer {
  public:
    explicit Arena(int threads) : Arena(std::make_unique<tbb::task_arena>(threads)) {}
    ~Arena() override {
        wait();
        observe(false);
    }
    // Until its threads have left it. Idle threads leave within milliseconds.
    void wait() const {
        using namespace std::chrono;
        const auto last = steady_clock::now() + seconds(1);
        while (within_.load() > 0 && steady_clock::now() < last) std::this_thread::sleep_for(microseconds(50));
    }
    void on_scheduler_entry(bool worker) override { within_ += worker ? 1 : 0; }
    void on_scheduler_exit(bool worker) override { within_ -= worker ? 1 : 0; }
    tbb::task_arena& arena() { return *arena_; }

  private:
    explicit Arena(std::unique_ptr<tbb::task_arena> arena) : tbb::task_scheduler_observer(*arena), arena_(std::move(arena)) {
        observe(true);
    }
    std::unique_ptr<tbb::task_arena> arena_;
    std::atomic<int> within_ = 0;
};

// Arenas that are not in use, with their numbers of threads: oneTBB never frees the 7 kB of one, so that the next Workers get it.
struct FreeArenas {
    std::mutex mutex;
    std::vector<std::pair<int, std::unique_ptr<Arena>>> all;

    static FreeArenas& here() {
        static FreeArenas free;
        return free;
    }
    std::unique_ptr<Arena> take(int threads) {
        const std::scoped_lock lock(mutex);
        const auto at = std::find_if(all.begin(), all.end(), [threads](const auto& one) { return one.first == threads; });
        if (at == all.end()) return nullptr;
        std::unique_ptr<Arena> found = std::move(at->second);
        all.erase(at);
        return found;
    }
    void give(int threads, std::unique_ptr<Arena> arena) {
        arena->wait();
        const std::scoped_lock lock(mutex);
        try {
            all.emplace_back(threads, std::move(arena));
        } catch (const std::bad_alloc&) {  // NOLINT(bugprone-empty-catch): one arena less
        }
    }
};

}  // namespace
#endif

struct Workers::Impl {
#ifndef RIVULET_WITHOUT_TBB
    std::unique_ptr<Arena> arena;
    int threads = 0;
    ~Impl() {
        if (arena) FreeArenas::here().give(threads, std::move(arena));
    }
#endif
    std::optional<ThreadPool> pool;
    Jobs jobs;
};

Workers::Workers(int threads) : impl_(std::make_unique<Impl>()) {
    if (kTbb) {
#ifndef RIVULET_WITHOUT_TBB
        if (threads > 0) {
            impl_->arena = FreeArenas::here().take(threads);
            if (!impl_->arena) impl_->arena = std::make_unique<Arena>(threads);
            impl_->threads = threads;
            impl_->jobs = {&impl_->arena->arena(), runInArena, threads};
        }
#endif
        return;
    }
    const int all = threads > 0 ? threads : defaultWorkers();
    impl_->jobs = {&impl_->pool.emplace(all - 1), runInPool, all};
}

Workers::~Workers() = default;

Jobs Workers::jobs() const { return impl_->jobs; }

}  // namespace rivulet
