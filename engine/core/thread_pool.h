// ThreadPool: threads that run the calls of a loop, for builds without oneTBB.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

namespace rivulet {

class ThreadPool {
  public:
    explicit ThreadPool(int threads);  // besides those that call run(); 0 or more
    ~ThreadPool();                     // waits for them
    // As Jobs::run. The calling thread takes part.
    void run(void (*function)(void* argument, size_t k), void* argument, size_t count);

  private:
    struct Loop {
        void (*function)(void* argument, size_t k);
        void* argument;
        size_t count, begun, ended;
    };
    void work();
    // Runs the next call of `loop`, which has one. `lock` is held before and after, not within.
    void runNext(std::list<Loop>::iterator loop, std::unique_lock<std::mutex>& lock);

    std::mutex mutex_;
    std::condition_variable begun_, ended_;
    std::list<Loop> open_, running_;  // with calls that have not begun; without
    bool ends_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace rivulet
