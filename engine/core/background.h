// Background: a result that is computed beside the frames of a host.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/exception_error.h"
#include "engine/core/jobs.h"
#include "engine/core/result.h"

namespace rivulet {

template <class T>
class Background {
  public:
    // Begins to run `make`, by Jobs::start of `jobs`. It takes one core: its loops run on one thread, and end with LoopStopped if this is
    // destroyed; what has no loops looks at currentJobs().stop. What it throws becomes an Error.
    Background(std::function<Result<T>()> make, const Jobs& jobs) : state_(std::make_unique<State>()) {
        state_->make = std::move(make);
        // Pointers of plain types: std::thread makes types of what it is given, which a host's shared library would export.
        void (*const function)(void*) = [](void* state) { static_cast<State*>(state)->run(); };
        void* const state = state_.get();
        if (jobs.start != nullptr)
            jobs.start(jobs.user, function, state);
        else
            state_->own = std::thread(function, state);
    }
    ~Background() {  // cancels it, and waits until it has stopped
        state_->stop = true;
        state_->wait();
    }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool done() const { return state_->done; }  // never waits
    // Once; waits until it is done.
    Result<T> take() {
        state_->wait();
        return std::move(*state_->result);
    }

  private:
    struct State {
        std::function<Result<T>()> make;
        std::atomic<bool> stop = false;
        std::mutex mutex;
        std::condition_variable ended;
        std::optional<Result<T>> result;
        std::atomic<bool> done = false;
        std::thread own;  // where the jobs have no start

        void run() {
            std::optional<Result<T>> made;
            try {
                const JobsScope scope(aloneUntil(&stop));
                made = make();
            } catch (const LoopStopped&) {
                made = failed("it was cancelled");
            } catch (const std::bad_alloc&) {
                made = noMemory("there is not enough memory for it");
            } catch (...) {
                made = errorOf(std::current_exception());
            }
            const std::scoped_lock lock(mutex);
            result = std::move(made);
            done = true;
            ended.notify_all();
        }
        void wait() {
            if (own.joinable()) own.join();
            std::unique_lock lock(mutex);
            ended.wait(lock, [this] { return done.load(); });
        }
    };
    std::unique_ptr<State> state_;
};

}  // namespace rivulet
