#include "fluid/validate/gpu_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/timeline.h"
#include "shaders/bench/rate_params.h"

namespace rivulet {

namespace {

constexpr int kRuns = 9;         // the fastest counts: other work on the machine only adds time
constexpr int kInARow = 20;      // dispatches of one work group
constexpr uint32_t kMask = 255;  // elements that rate_math loads, less one
constexpr uint32_t kLeastCopied = 1U << 14U;

// The time of one dispatch, ms: the host's, with a wait at the end. Queued `times` times. Past `until` it is run only once more.
double msOf(Device& device, Kernel kernel, const RateParams& params, std::initializer_list<const Buffer*> buffers, uint32_t threads,
            int times, double until) {
    double least = 1.0e9;
    for (int run = 0; run <= kRuns && (run < 2 || hostSeconds() < until); ++run) {  // the first warms up
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

// Two buffers of `elements`. Where memory does not suffice, `elements` is halved.
Result<std::array<Buffer, 2>> copiedBuffers(Device& device, uint32_t& elements) {
    for (;; elements /= 2) {
        Result<Buffer> from = device.allocate(size_t{elements} * sizeof(vec4));
        Result<Buffer> to = from ? device.allocate(size_t{elements} * sizeof(vec4)) : Result<Buffer>(from.error());
        if (to) return std::array<Buffer, 2>{std::move(*from), std::move(*to)};
        if (!to.error().memory) return to.error();
        device.forgiveFull();
        if (elements / 2 < kLeastCopied) return to.error();
    }
}

}  // namespace

double deviceSeconds(const Device& device) {
    if (!device.info().software) return hostSeconds();
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / std::max(std::thread::hardware_concurrency(), 1U);
}

uint32_t copiedElements(bool software, size_t maxBufferBytes) {
    uint32_t elements = software ? 1U << 22U : 1U << 24U;  // 64 MiB, beyond the caches of a CPU; 256 MiB
    while (elements >= kLeastCopied && size_t{elements} * sizeof(vec4) > maxBufferBytes) elements /= 2;
    return elements >= kLeastCopied ? elements : 0;
}

Result<std::optional<DeviceRates>> measureRates(Device& device, double until) {
    if (device.backend() == Backend::cpu) return badInput("rates are measured on devices gl and cl");
    const double start = deviceSeconds(device);
    const bool software = device.info().software;
    const auto late = [until] { return hostSeconds() >= until; };
    const std::optional<DeviceRates> none;
    uint32_t copied = copiedElements(software, device.info().maxBufferBytes);
    if (copied == 0)
        return noMemory(fmt::format("{} allows buffers of {} bytes, but {} are needed to measure its rates", device.info().name,
                                    device.info().maxBufferBytes, kLeastCopied * sizeof(vec4)));
    DeviceRates rates;

    if (late()) return none;
    const Result<Kernel> copy = device.kernel("bench/rate_copy");
    if (!copy) return copy.error();
    std::array<Kernel, 10> math;
    for (int kind = 0; kind < (software ? 5 : 4); ++kind)  // the fifth, loads by one thread in eight, tells nothing of a GPU
        for (int operations = 1; operations <= 2; ++operations) {
            if (late()) return none;
            const Define defines[] = {{"KIND", std::to_string(kind)}, {"OPERATIONS", std::to_string(operations)}};
            const Result<Kernel> made = device.kernel("bench/rate_math", defines);
            if (!made) return made.error();
            math[static_cast<size_t>(2 * kind + operations - 1)] = *made;
        }
    Result<std::array<Buffer, 2>> buffers = copiedBuffers(device, copied);
    if (!buffers) return buffers.error();
    const Buffer &from = (*buffers)[0], &to = (*buffers)[1];
    const uint32_t threads = std::min(software ? 1U << 14U : 1U << 20U, 4 * copied);  // each writes a float
    rates.copied = double{sizeof(vec4)} * copied;

    RateParams params{.rounds = 0, .mask = kMask, .scale = 1.0F, .add = 0.0F};
    const auto timed = [&](Kernel kernel, uint32_t items, int times) {
        return msOf(device, kernel, params, {&from, &to}, items, times, until);
    };
    rates.dispatchMs = timed(*copy, 64, kInARow);
    const double copyMs = timed(*copy, copied, std::clamp(static_cast<int>((1U << 22U) / copied), 1, kInARow));
    rates.bandwidth = 2.0 * sizeof(vec4) * copied / (std::max(copyMs - rates.dispatchMs, 1.0e-6) / 1000);

    // Of two loops, with 8 and with 16 operations a round: the difference is 8 operations, what is left of the first is the loop.
    const auto loop = [&](size_t kind) {
        std::array<double, 2> round{};
        const uint32_t rounds = software && kind < 3 ? 512 : software ? 64 : 256;  // loads are slow there
        for (size_t k = 0; k < 2; ++k) {
            params.rounds = rounds;
            const double whole = timed(math[2 * kind + k], threads, 1);
            params.rounds = 0;
            round[k] = (whole - timed(math[2 * kind + k], threads, 1)) / 1000 / (static_cast<double>(rounds) * threads);
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
    // Where one thread in eight loads, eight take what they take in step, and that one its own part of the time: s + (1 - s) / 8.
    if (software) rates.loadsInStep = std::clamp((8 * loop(4).operation / load.operation - 1) / 7, 0.0, 1.0);
    rates.rounds = 1 / std::max(arithmetic.perRound - 8 * arithmetic.operation, 0.1 * arithmetic.perRound);
    if (late()) return none;
    if (device.backend() == Backend::gl) {
        const Result<bool> drawn = measureDrawing(device, rates, until);
        if (!drawn) return drawn.error();
        if (!*drawn) return none;
    }
    rates.seconds = deviceSeconds(device) - start;
    return std::optional(rates);
}

}  // namespace rivulet
