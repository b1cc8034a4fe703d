// LateDevice: a GPU that is two frames behind, whatever the speed of the machine: what is read later arrives that much later.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "shaders/fluid/solids/body_state.h"

namespace rivulet {

class LateDevice final : public Device {
  public:
    // Notes the rows of `bodies` bodies that are read in each frame.
    LateDevice(Device& of, size_t bodies) : of_(of), bodies_(bodies) {}
    Backend backend() const override { return of_.backend(); }
    const DeviceInfo& info() const override { return of_.info(); }
    using Device::kernel;
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override { return of_.kernel(path, defines); }
    std::vector<std::string> kernels() const override { return of_.kernels(); }
    Result<Buffer> allocate(size_t bytes) override {
        Result<Buffer> made = of_.allocate(bytes);
        if (made && poison != 0) of_.fill(*made, poison);
        return made;
    }
    void release(uint64_t handle, size_t bytes) override { of_.release(handle, bytes); }
    void write(Buffer& to, std::span<const std::byte> bytes, size_t offset) override { of_.write(to, bytes, offset); }
    void read(const Buffer& from, std::span<std::byte> bytes, size_t offset) override {
        ++reads;
        of_.read(from, bytes, offset);
    }
    void fill(Buffer& to, uint32_t word) override { of_.fill(to, word); }
    void copy(const Buffer& from, Buffer& to, size_t bytes) override { of_.copy(from, to, bytes); }
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) override {
        auto held = std::make_shared<Held>();
        held->frame = frame_;
        held->then = std::move(then);
        held_.push_back(held);
        of_.readLater(
            from, bytes,
            [held, this](std::span<const std::byte> came) {
                held->bytes.assign(came.begin(), came.end());
                if (came.size() != bodies_ * sizeof(DeviceBody)) return;
                rows.emplace_back(bodies_);
                std::memcpy(rows.back().data(), came.data(), came.size());
            },
            offset);
    }
    void poll() override {
        while (!held_.empty() && held_.front()->frame + kFrames < frame_) {
            const std::shared_ptr<Held> next = held_.front();
            held_.erase(held_.begin());
            next->then(next->bytes);
        }
    }
    void finish() override { of_.finish(); }
    std::vector<PassTime> takeTimes() override { return of_.takeTimes(); }
    size_t bytesAllocated() const override { return of_.bytesAllocated(); }
    void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) override {
        of_.dispatch(kernel, params, buffers, threads);
    }
    // After each frame.
    void frameEnds() {
        of_.finish();
        of_.poll();
        ++frame_;
    }

    uint32_t poison = 0;                        // fills new memory with this word
    size_t reads = 0;                           // that wait
    std::vector<std::vector<DeviceBody>> rows;  // of each frame, as they were then

  private:
    static constexpr size_t kFrames = 2;
    struct Held {
        size_t frame = 0;
        std::function<void(std::span<const std::byte>)> then;
        std::vector<std::byte> bytes;
    };
    Device& of_;
    size_t bodies_, frame_ = 0;
    std::vector<std::shared_ptr<Held>> held_;
};

}  // namespace rivulet
