// Device cpu: kernels compiled as C++ for several instruction sets, run in chunks by the jobs of the host or on all cores.
#pragma once

#include <memory>

#include "engine/compute/device.h"
#include "engine/core/jobs.h"

namespace rivulet {

enum class Isa { generic, avx2, avx512 };
const char* isaName(Isa isa);
// The best instruction set that this machine supports, but none better than the environment's RIVULET_ISA (generic, avx2, avx512). Results
// are the same bit for bit with each.
Isa bestIsa();
Status checkIsa();  // error (badInput): RIVULET_ISA names none, or one that this machine lacks

// One compiled kernel. `defines` as "A=1;B=2", empty for none.
using CpuKernelFn = void (*)(uint32_t begin, uint32_t end, const void* params, void* const* buffers);
struct CpuKernelRow {
    const char* path;  // "fluid/methods/wcsph_density"
    const char* defines;
    Isa isa;
    CpuKernelFn run;
    uint32_t grain;  // kernel threads (particles, cells, ...) per chunk
};

// Memory of a host, for the buffers of a device cpu: particles, neighbour grid and lists, fields of solids, foam, drops.
struct HostMemory {
    void* user = nullptr;  // passed to both
    // `bytes`, a multiple of `alignment`, at an address that is a multiple of `alignment`, a power of two; they need not be zeros. Null:
    // out of memory, an error of the call that allocates. Called on threads that call the device; throws nothing.
    void* (*allocate)(void* user, size_t bytes, size_t alignment) = nullptr;  // null: calloc
    void (*release)(void* user, void* memory, size_t bytes) = nullptr;        // what `allocate` returned, with its bytes
};

struct CpuOptions {
    int threads = 0;  // 0: all cores, or all workers of `jobs`
    Isa isa = bestIsa();
    Jobs jobs = {};          // without `run`: the library's own threads
    HostMemory memory = {};  // both functions or neither
};

class CpuDevice;
std::unique_ptr<CpuDevice> makeCpuDevice(std::span<const CpuKernelRow> rows, const CpuOptions& options = {});

class CpuDevice final : public Device {
  public:
    CpuDevice(std::span<const CpuKernelRow> rows, const CpuOptions& options);
    ~CpuDevice() override;
    Backend backend() const override { return Backend::cpu; }
    const DeviceInfo& info() const override { return info_; }
    using Device::kernel;
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override;
    std::vector<std::string> kernels() const override;
    Result<Buffer> allocate(size_t bytes) override;
    void release(uint64_t handle, size_t bytes) override;
    void write(Buffer& to, std::span<const std::byte> bytes, size_t offset) override;
    void read(const Buffer& from, std::span<std::byte> bytes, size_t offset) override;
    void fill(Buffer& to, uint32_t word) override;
    void copy(const Buffer& from, Buffer& to, size_t bytes) override;
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) override;
    void poll() override {}
    void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) override;
    void finish() override {}
    std::vector<PassTime> takeTimes() override;
    size_t bytesAllocated() const override { return bytesAllocated_; }

    Isa isa() const { return isa_; }
    int threads() const;
    Jobs jobs() const;  // that its passes run on
    // Calls body(begin, end) for chunks of [0, count), in any order and on any thread. For passes written in C++ (sorting, lists). Chunks
    // are skipped as those of a dispatch (Device::stopOn).
    void parallelFor(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body);
    // From now on the memory of released buffers is kept for those allocated later, until the device ends: for one that makes and releases
    // buffers of many particles again and again.
    void keepReleased() { keepsReleased_ = true; }
    // Adds `ms` to the time of a pass written in C++, so that takeTimes() reports it beside the kernels.
    void addTime(std::string_view name, double ms);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    DeviceInfo info_;
    Isa isa_;
    size_t bytesAllocated_ = 0;
    bool keepsReleased_ = false;
};

// The memory behind a cpu Buffer.
template <class T>
T* hostPointer(const Buffer& buffer) {
    return reinterpret_cast<T*>(static_cast<uintptr_t>(buffer.handle()));
}

}  // namespace rivulet
