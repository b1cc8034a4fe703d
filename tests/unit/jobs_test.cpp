// Loops on the jobs of a host, on the library's own threads, and on the pool that replaces oneTBB.
#include "engine/core/jobs.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/core/parallel.h"
#include "engine/core/thread_pool.h"

namespace rivulet::jobs_test {
namespace {

using Function = void (*)(void*, size_t);

// A host whose calls run one after another, from the last to the first, on the thread that asks.
struct Serial {
    size_t calls = 0, most = 0, nested = 0;
    bool within = false;

    static void run(void* self, Function function, void* argument, size_t count) {
        auto& s = *static_cast<Serial*>(self);
        ++s.calls;
        s.most = std::max(s.most, count);
        if (s.within) ++s.nested;
        s.within = true;
        for (size_t k = count; k-- > 0;) function(argument, k);
        s.within = false;
    }
    Jobs jobs(int workers) { return {this, run, workers}; }
};

// A host that starts threads, and takes no part itself.
void onThreads(void*, Function function, void* argument, size_t count) {
    std::vector<std::thread> threads;
    for (size_t k = 0; k < count; ++k) threads.emplace_back(function, argument, k);
    for (std::thread& t : threads) t.join();
}

// How often each index of [0, count) was in a part.
std::vector<int> visits(size_t count, size_t grain) {
    std::vector<std::atomic<int>> seen(count);
    parallelParts(count, grain, [&](size_t begin, size_t end) {
        EXPECT_TRUE(begin % grain == 0 && begin < end && end == std::min(begin + grain, count));
        for (size_t k = begin; k < end; ++k) ++seen[k];
    });
    return {seen.begin(), seen.end()};
}

TEST(Jobs, EachIndexRunsOnceOnAnyJobs) {
    Serial serial;
    const Workers two(2), five(5), all(0);
    ThreadPool pool(3);
    const Jobs pooled{&pool, [](void* p, Function f, void* a, size_t n) { static_cast<ThreadPool*>(p)->run(f, a, n); }, 4};
    for (const Jobs& jobs : {Jobs{}, two.jobs(), five.jobs(), all.jobs(), serial.jobs(7), Jobs{nullptr, onThreads, 3}, pooled}) {
        const JobsScope scope(jobs);
        for (const auto& [count, grain] : {std::pair<size_t, size_t>(0, 8), {1, 8}, {1000, 1}, {1001, 64}, {64, 64}})
            EXPECT_EQ(visits(count, grain), std::vector<int>(count, 1)) << count << " by " << grain;
        std::vector<std::atomic<int>> seen(100);
        parallelFor(-40, 60, [&](int k) { ++seen[static_cast<size_t>(k + 40)]; });
        EXPECT_EQ(std::vector<int>(seen.begin(), seen.end()), std::vector<int>(100, 1));
    }
}

TEST(Jobs, ALoopAsksForAsManyCallsAsThereAreWorkers) {
    Serial serial;
    const JobsScope scope(serial.jobs(3));
    EXPECT_EQ(jobWorkers(), 3);
    visits(1000, 1);
    EXPECT_EQ(serial.calls, 1U);
    EXPECT_EQ(serial.most, 3U);
    visits(64, 64);  // one part needs no other thread
    EXPECT_EQ(serial.calls, 1U);
}

TEST(Jobs, ALoopWithinACallRunsOnItsThread) {
    Serial serial;
    const JobsScope scope(serial.jobs(4));
    std::atomic<int> sum = 0;
    parallelFor(0, 20, [&](int) { parallelFor(0, 30, [&](int) { ++sum; }); });
    EXPECT_EQ(sum, 600);
    EXPECT_EQ(serial.nested, 0U);
}

TEST(Jobs, TheInnermostScopeCounts) {
    Serial outer, inner;
    const JobsScope scope(outer.jobs(4));
    {
        const JobsScope within(inner.jobs(2));
        visits(10, 1);
    }
    EXPECT_EQ(outer.calls, 0U);
    EXPECT_EQ(inner.most, 2U);
    visits(10, 1);
    EXPECT_EQ(outer.most, 4U);
}

TEST(Jobs, AnExceptionReachesTheCaller) {
    Serial serial;
    const Workers three(3);
    for (const Jobs& jobs : {Jobs{}, three.jobs(), serial.jobs(2), Jobs{nullptr, onThreads, 3}}) {
        const JobsScope scope(jobs);
        EXPECT_THROW(parallelFor(0, 100,
                                 [](int k) {
                                     if (k == 37) throw std::runtime_error("37");
                                 }),
                     std::runtime_error);
        EXPECT_EQ(visits(50, 3), std::vector<int>(50, 1)) << "the next loop is whole";
    }
}

TEST(Jobs, SeveralThreadsShareAPool) {
    ThreadPool pool(2);
    std::atomic<size_t> sum = 0;
    std::vector<std::thread> callers;
    for (int c = 0; c < 4; ++c)
        callers.emplace_back([&] {
            for (int round = 0; round < 50; ++round)
                pool.run([](void* s, size_t k) { *static_cast<std::atomic<size_t>*>(s) += k; }, &sum, 5);
        });
    for (std::thread& t : callers) t.join();
    EXPECT_EQ(sum, 4U * 50U * (0 + 1 + 2 + 3 + 4));
}

}  // namespace
}  // namespace rivulet::jobs_test
