#include "fluid/validate/gpu_rates.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/timeline.h"
#include "shaders/bench/rate_params.h"

namespace rivulet {

namespace {

constexpr int kRuns = 9;         // the fastest counts: other work on the machine only adds time
constexpr int kInARow = 20;      // dispatches of one work group
constexpr uint32_t kMask = 255;  // elements that rate_math loads, less one

// The time of one dispatch, ms: the host's, with a wait at the end. Queued `times` times.
double msOf(Device& device, Kernel kernel, const RateParams& params, std::initializer_list<const Buffer*> buffers, uint32_t threads,
            int times) {
    double least = 1.0e9;
    for (int run = 0; run <= kRuns; ++run) {  // the first warms up
        device.finish();
        const double start = deviceSeconds(device);
        for (int k = 0; k < times; ++k) device.run(kernel, params, buffers, threads);
        device.finish();
        if (run > 0) least = std::min(least, 1000 * (deviceSeconds(device) - start) / times);
    }
    device.takeTimes();
    return least;
}

struct Loop {
    double perRound = 0;   // s of a round with 8 operations, of a thread, less the dispatch
    double operation = 0;  // s of an operation of a thread
};

}  // namespace

double deviceSeconds(const Device& device) {
    if (!device.info().software) return hostSeconds();
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / std::max(std::thread::hardware_concurrency(), 1U);
}

Result<DeviceRates> measureRates(Device& device) {
    if (device.backend() == Backend::cpu) return badInput("rates are measured on devices gl and cl");
    const double start = deviceSeconds(device);
    const bool software = device.info().software;
    const uint32_t threads = software ? 1U << 14U : 1U << 20U;
    const uint32_t copied = software ? 1U << 22U : 1U << 24U;  // vec4: 64 MiB, beyond the caches of a CPU; 256 MiB
    DeviceRates rates;

    const Result<Kernel> copy = device.kernel("bench/rate_copy");
    if (!copy) return copy.error();
    std::array<Kernel, 8> math;
    for (int kind = 0; kind < 4; ++kind)
        for (int operations = 1; operations <= 2; ++operations) {
            const Define defines[] = {{"KIND", std::to_string(kind)}, {"OPERATIONS", std::to_string(operations)}};
            const Result<Kernel> made = device.kernel("bench/rate_math", defines);
            if (!made) return made.error();
            math[static_cast<size_t>(2 * kind + operations - 1)] = *made;
        }
    Result<Buffer> from = device.allocate(size_t{copied} * sizeof(vec4));
    if (!from) return from.error();
    Result<Buffer> to = device.allocate(size_t{copied} * sizeof(vec4));
    if (!to) return to.error();

    RateParams params{.rounds = 0, .mask = kMask, .scale = 1.0F, .add = 0.0F};
    rates.dispatchMs = msOf(device, *copy, params, {&*from, &*to}, 64, kInARow);
    const double copyMs = msOf(device, *copy, params, {&*from, &*to}, copied, 1);
    rates.bandwidth = 2.0 * sizeof(vec4) * copied / (std::max(copyMs - rates.dispatchMs, 1.0e-6) / 1000);

    // Of two loops, with 8 and with 16 operations a round: the difference is 8 operations, what is left of the first is the loop.
    const auto loop = [&](size_t kind) {
        std::array<double, 2> round{};
        const uint32_t rounds = software && kind < 3 ? 512 : software ? 64 : 256;  // loads are slow there
        for (size_t k = 0; k < 2; ++k) {
            params.rounds = rounds;
            const double whole = msOf(device, math[2 * kind + k], params, {&*from, &*to}, threads, 1);
            params.rounds = 0;
            const double none = msOf(device, math[2 * kind + k], params, {&*from, &*to}, threads, 1);
            round[k] = (whole - none) / 1000 / (static_cast<double>(rounds) * threads);
        }
        // Other work on the machine may hide the difference: then the loop itself is neglected.
        const double eight = round[1] > 1.05 * round[0] ? round[1] - round[0] : round[0];
        return Loop{round[0], std::max(eight / 8, 1.0e-16)};
    };
    const Loop arithmetic = loop(0), integer = loop(1), special = loop(2), load = loop(3);
    rates.arithmetic = 2 / arithmetic.operation;  // (x + a) * b
    rates.integer = 2 / integer.operation;        // x * 3 ^ a
    rates.special = 1 / special.operation;
    // A load comes with one addition of floats and two of integers.
    rates.loads = 1 / std::max(load.operation - 1 / rates.arithmetic - 2 / rates.integer, 0.1 * load.operation);
    rates.rounds = 1 / std::max(arithmetic.perRound - 8 * arithmetic.operation, 0.1 * arithmetic.perRound);
    if (device.backend() == Backend::gl)
        if (Status drawn = measureDrawing(device, rates); !drawn) return drawn.error();
    rates.seconds = deviceSeconds(device) - start;
    return rates;
}

}  // namespace rivulet
