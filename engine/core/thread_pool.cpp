#include "engine/core/thread_pool.h"

#include <system_error>

namespace rivulet {

ThreadPool::ThreadPool(int threads) {
    threads_.reserve(static_cast<size_t>(threads));
    try {
        for (int k = 0; k < threads; ++k) threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // the system gives no more threads: those that there are do the work
    }
}

ThreadPool::~ThreadPool() {
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    begun_.notify_all();
    for (std::thread& thread : threads_) thread.join();
}

void ThreadPool::run(void (*function)(void* argument, size_t k), void* argument, size_t count) {
    std::unique_lock lock(mutex_);
    const auto loop = open_.insert(open_.end(), {function, argument, count, 0, 0});
    begun_.notify_all();
    while (loop->begun < count) runNext(loop, lock);
    ended_.wait(lock, [&] { return loop->ended == count; });
    running_.erase(loop);
}

void ThreadPool::runNext(std::list<Loop>::iterator loop, std::unique_lock<std::mutex>& lock) {
    const size_t k = loop->begun++;
    if (loop->begun == loop->count) running_.splice(running_.end(), open_, loop);
    lock.unlock();
    loop->function(loop->argument, k);
    lock.lock();
    if (++loop->ended == loop->count) ended_.notify_all();
}

void ThreadPool::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        begun_.wait(lock, [this] { return ends_ || !open_.empty(); });
        if (open_.empty()) return;
        runNext(open_.begin(), lock);
    }
}

}  // namespace rivulet
