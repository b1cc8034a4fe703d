// How fast a device is, measured by tiny kernels (shaders/bench): bandwidth, operations by kind, and the cost of a dispatch.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/compute/device.h"
#include "engine/core/result.h"

namespace rivulet {

// Of the whole device, all of it busy.
struct DeviceRates {
    double bandwidth = 0;    // bytes/s, read and written together
    double arithmetic = 0;   // operations/s: (x + a) * b is two, and cannot be fused
    double integer = 0;      // operations/s
    double special = 0;      // square roots/s
    double loads = 0;        // loads/s, from a few elements that every cache holds, all threads at once
    double loadsInStep = 1;  // share of a load's time for which threads in lockstep that do not load wait too: 1 on a GPU
    double rounds = 0;       // rounds of a loop/s: its count, comparison and branch
    double dispatchMs = 0;   // ms of a dispatch of one work group
    double fragments = 0;    // fragments/s of a target of 16-bit floats, of a shader that does nothing; gl alone, otherwise 0
    double filtered = 0;     // reads/s of a texture between its texels, four channels of 16 bits; gl alone
    double fetches = 0;      // reads/s of a texel of one channel; gl alone
    double copied = 0;       // bytes of the buffer that was copied for `bandwidth`; caches hold a small one
    double seconds = 0;      // that the measurement took
};

// The time of a device, s: on a GPU of the wall. A device that is software: processor time of this process over the number of threads.
double deviceSeconds(const Device& device);

// Elements of 16 bytes of each of the two buffers that are copied: a power of two, at most 2^24; on a device that is software 2^22. 0: the
// largest buffer of the device is too small.
uint32_t copiedElements(bool software, size_t maxBufferBytes);

// Takes less than a second on a GPU, a few seconds on a device that is software. Buffers for which there is no memory are halved. gl: its
// context must be current. No value: hostSeconds() passed `until` before all was measured. Error: a kernel does not compile (failed);
// memory is exhausted (Error::memory, and the device is not full afterwards); the device is cpu, which has other kernels (badInput).
Result<std::optional<DeviceRates>> measureRates(Device& device, double until = 1.0e300);
// What a device gl draws: fragments, filtered, fetches. Its context must be current. False: as no value above. Error: as above.
Result<bool> measureDrawing(Device& device, DeviceRates& rates, double until = 1.0e300);

}  // namespace rivulet
