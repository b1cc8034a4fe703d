// A kernel of the cpu under ThreadSanitizer, for run.sh: flow/born of the shaders in the include path, on four threads. Nothing is
// reported of the kernel as it is; a race is reported if its atomics are replaced, and with the argument "early" a loop that returns before
// its parts have ended, as where a barrier between two dispatches is missing.
#include <cstdio>
#include <cstring>
#include <deque>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

#define RIVULET_KERNEL_UNIT planted_unit
#include "engine/compute/device_cpu.h"
#include "shaders/common/lang.h"

namespace rivulet::planted_unit {
#include "shaders/flow/born.kernel"
}  // namespace rivulet::planted_unit

namespace rivulet {
namespace {

constexpr uint32_t kBirths = 400000;

// Jobs on threads of their own. `early`: run() returns while they still work.
struct Threads {
    bool early = false;
    std::deque<std::thread> left;
    static void run(void* user, void (*function)(void* argument, size_t k), void* argument, size_t count) {
        Threads& self = *static_cast<Threads*>(user);
        // All begin at a time: else the first could run all parts before the second exists.
        const auto begin = std::make_shared<std::latch>(static_cast<std::ptrdiff_t>(count));
        for (size_t k = 0; k < count; ++k)
            self.left.emplace_back([=] {
                begin->arrive_and_wait();
                function(argument, k);
            });
        if (!self.early) self.join();
    }
    void join() {
        for (std::thread& t : left) t.join();
        left.clear();
    }
};

int run(bool early) {
    Threads threads{.early = early, .left = {}};
    const CpuKernelRow rows[] = {{"flow/born", "", Isa::generic, planted_unit::born, kBirths / 4}};
    const auto device = makeCpuDevice(rows, {.isa = Isa::generic, .jobs = {.user = &threads, .run = Threads::run, .workers = 4}});
    planted_unit::FlowStep step;
    std::memset(static_cast<void*>(&step), 0, sizeof step);
    step.births = kBirths;  // all refused, because there is no slot: their volumes are summed in counter[0]
    std::vector<planted_unit::FlowBirth> births(kBirths);
    std::memset(static_cast<void*>(births.data()), 0, kBirths * sizeof births[0]);
    for (planted_unit::FlowBirth& b : births) b.volume = 3;
    const auto allocate = [&](size_t bytes) { return std::move(*device->allocate(bytes)); };
    Buffer cellStart = allocate(64), id = allocate(64), birth = allocate(kBirths * sizeof births[0]), drop = allocate(256),
           motion = allocate(256), counter = allocate(64);
    device->writeAll<planted_unit::FlowBirth>(birth, births);
    const Kernel kernel = *device->kernel("flow/born");
    for (int k = 0; k < 2; ++k) device->run(kernel, step, {&cellStart, &id, &birth, &drop, &motion, &counter}, kBirths);
    const uint32_t sum = device->readAll<uint32_t>(counter, 1)[0];
    threads.join();
    std::printf("sum %u of %u\n", sum, 2 * 3 * kBirths);
    return 0;
}

}  // namespace
}  // namespace rivulet

int main(int count, char** words) { return rivulet::run(count > 1 && std::strcmp(words[1], "early") == 0); }
