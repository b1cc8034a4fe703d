// CountingDevice: a Device that counts what it runs: kernels, their variants, dispatches and work items.
#pragma once

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/device.h"

namespace rivulet {

class CountingDevice final : public Device {
  public:
    explicit CountingDevice(Device& of) : of_(of) {}
    Backend backend() const override { return of_.backend(); }
    const DeviceInfo& info() const override { return of_.info(); }
    using Device::kernel;
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override { return of_.kernel(path, defines); }
    std::vector<std::string> kernels() const override { return of_.kernels(); }
    // oclgrind does not know that a fill or a copy initialises memory, but that a write does.
    Result<Buffer> allocate(size_t bytes) override {
        Result<Buffer> made = of_.allocate(bytes);
        if (made) fill(*made, 0);
        return made;
    }
    void release(uint64_t handle, size_t bytes) override { of_.release(handle, bytes); }
    // For oclgrind 21.10, a write of a part makes all after the part uninitialised: the whole buffer is written.
    void write(Buffer& to, std::span<const std::byte> bytes, size_t offset) override {
        if (backend() != Backend::cl || bytes.size() == to.bytes()) return of_.write(to, bytes, offset);
        std::vector<std::byte> all = of_.readAll<std::byte>(to, to.bytes());
        std::ranges::copy(bytes, all.begin() + static_cast<std::ptrdiff_t>(offset));
        of_.write(to, all, 0);
    }
    void read(const Buffer& from, std::span<std::byte> bytes, size_t offset) override { of_.read(from, bytes, offset); }
    void fill(Buffer& to, uint32_t word) override {
        if (backend() != Backend::cl) return of_.fill(to, word);
        const std::vector<uint32_t> words(to.bytes() / 4, word);
        of_.write(to, std::as_bytes(std::span(words)), 0);
    }
    void copy(const Buffer& from, Buffer& to, size_t bytes) override {
        if (backend() != Backend::cl) return of_.copy(from, to, bytes);
        of_.write(to, of_.readAll<std::byte>(from, bytes), 0);
    }
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) override {
        of_.readLater(from, bytes, std::move(then), offset);
    }
    void poll() override { of_.poll(); }
    void finish() override { of_.finish(); }
    std::vector<PassTime> takeTimes() override { return of_.takeTimes(); }
    size_t bytesAllocated() const override { return of_.bytesAllocated(); }
    void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) override {
        if (threads > 0) {
            Count& count = counts_[kernel.index];
            ++count.dispatches;
            count.items += threads;
        }
        of_.dispatch(kernel, params, buffers, threads);
    }

    struct Count {
        size_t dispatches = 0, items = 0;
    };
    // By variant: "fluid/methods/wcsph_density;MATTER=1".
    std::map<std::string, Count> ran() const {
        const std::vector<std::string> names = of_.kernels();
        std::map<std::string, Count> all;
        for (const auto& [index, count] : counts_) all[names.at(index)] = count;
        return all;
    }

  private:
    Device& of_;
    std::map<uint32_t, Count> counts_;
};

}  // namespace rivulet
