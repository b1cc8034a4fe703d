// Device: runs kernels on the CPU (engine/core/jobs.h), in OpenGL compute shaders or in OpenCL.
//
// Threading: a Device and everything made from it may be used by one thread at a time (gl: a thread on which its context is current), but
// not always the same one. Calls are in order: a dispatch sees the results of earlier dispatches and writes. read() and finish() wait
// for the GPU; allocate() and write() may, where they need new memory.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/large_pages.h"
#include "engine/core/result.h"
#include "engine/core/timeline.h"

namespace rivulet {

enum class Backend { cpu, gl, cl };
const char* backendName(Backend backend);  // "cpu", "gl", "cl"

class Device;

// Memory on a Device. Move-only; must not outlive its Device.
class Buffer {
  public:
    Buffer() = default;
    Buffer(Device& device, uint64_t handle, size_t bytes) : device_(&device), handle_(handle), bytes_(bytes) {}
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        Buffer moved(std::move(other));
        swap(moved);
        return *this;
    }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer();
    void swap(Buffer& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        std::swap(bytes_, other.bytes_);
    }
    uint64_t handle() const { return handle_; }  // cpu: the address; gl: the buffer's name; cl: the cl_mem
    size_t bytes() const { return bytes_; }
    explicit operator bool() const { return device_ != nullptr; }

  private:
    Device* device_ = nullptr;
    uint64_t handle_ = 0;
    size_t bytes_ = 0;
};

struct Define {
    std::string name, value;
};

struct Kernel {
    uint32_t index = UINT32_MAX;  // into the device's own list
};

struct DeviceInfo {
    std::string name;       // "Intel(R) Xeon(R) Processor, 2 threads, avx512"
    std::string driver;     // "" on the cpu
    bool software = false;  // a GPU API that runs on the CPU: llvmpipe, PoCL
    size_t maxBufferBytes = SIZE_MAX;
};

// Whether a device still works.
struct DeviceHealth {
    enum State {
        works,
        full,  // an allocation failed; existing buffers are valid
        lost,  // a command failed: the contents of all buffers are invalid, and no command runs any more
    } state = works;
    std::string why;  // continues a sentence after the device's name: "could not run fluid/grid/reorder: CL_OUT_OF_RESOURCES"
};

// Access of OpenGL to a Device's buffers without a copy through the host.
class GlSharing;
struct GlShare {
    std::shared_ptr<const GlSharing> by;  // null: not possible
    std::string whyNot;                   // the reason, if null: "Portable Computing Language offers no cl_khr_gl_sharing"
};

// Time of all dispatches of one kernel since the last takeTimes(). GPU times arrive 2 to 3 frames late.
struct PassTime {
    std::string name;
    double ms = 0;
    int calls = 0;
};

class Device {
  public:
    virtual ~Device() = default;
    virtual Backend backend() const = 0;
    virtual const DeviceInfo& info() const = 0;
    // The state known so far; failures on a GPU may be detected some calls late. A failure is permanent, but see forgiveFull().
    DeviceHealth health() const { return health_; }
    // For a caller that tried an allocation that was too large and has released it: a full device works again. A lost one stays lost.
    void forgiveFull() {
        if (health_.state == DeviceHealth::full) health_ = {};
    }
    virtual GlShare glShare() const { return {nullptr, "only OpenCL shares memory with OpenGL"}; }

    // `path` as "fluid/methods/wcsph_density" (shaders/fluid/methods/wcsph_density.kernel). The same path and defines give the same Kernel.
    virtual Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) = 0;
    Result<Kernel> kernel(std::string_view path) { return kernel(path, {}); }

    // Reads the files of its kernels again and compiles the changed ones. Returns how many changed; 0 if kernels are compiled in (cpu).
    // Error: the compiler's message, or a kernel has other arguments than its caller passes; no kernel changes then.
    virtual Result<size_t> reload() { return size_t{0}; }

    // The kernels made so far, with their defines: "fluid/methods/wcsph_density;MATTER=1;PERIODIC=1".
    virtual std::vector<std::string> kernels() const = 0;

    // A Buffer filled with zeros. 0 bytes give a valid Buffer of 0 bytes. Error (noMemory): out of memory, above limitMemory(), or
    // onAllocate() refuses.
    virtual Result<Buffer> allocate(size_t bytes) = 0;
    virtual void release(uint64_t handle, size_t bytes) = 0;  // Buffer's destructor calls it
    virtual void write(Buffer& to, std::span<const std::byte> bytes, size_t offset = 0) = 0;
    virtual void read(const Buffer& from, std::span<std::byte> bytes, size_t offset = 0) = 0;  // waits for the GPU; zeros of a lost one
    virtual void fill(Buffer& to, uint32_t word) = 0;                                          // every 4 bytes
    virtual void copy(const Buffer& from, Buffer& to, size_t bytes) = 0;

    // Copies `bytes` of `from`, from `offset` on, as of this call and passes them to `then` during a later poll(), without waiting. On the
    // cpu `then` is called at once.
    virtual void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset = 0) = 0;
    virtual void poll() = 0;

    // buffers[k] is binding k + 1 of the kernel's ARGS; binding 0 is the parameter block. 0 threads: nothing happens.
    virtual void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) = 0;
    template <class P>
    void run(Kernel kernel, const P& params, std::initializer_list<const Buffer*> buffers, uint32_t threads) {
        static_assert(sizeof(P) % 16 == 0, "a parameter block's size must be a multiple of 16");
        dispatch(kernel, std::as_bytes(std::span(&params, 1)), std::span(buffers.begin(), buffers.size()), threads);
    }
    virtual void finish() = 0;

    // Stopping in the middle of long work. While `flag` is true, dispatch() and CpuDevice::parallelFor() do nothing, and a pass that
    // already runs on the cpu ends with the chunks that have begun (about a millisecond); what a GPU has in its queue still runs. Any
    // thread or a signal handler may set the flag. It must outlive the device or the next stopOn(); null, the default: nothing stops.
    void stopOn(const std::atomic<bool>* flag) { stop_ = flag; }
    const std::atomic<bool>* stopFlag() const { return stop_; }
    bool stopAsked() const { return stop_ != nullptr && stop_->load(std::memory_order_relaxed); }
    // Whether a dispatch was skipped since the last goOn(), as a whole or in part: buffers then hold old values, new values, or both, and
    // all further dispatches are skipped too. Their owner calls goOn() before it writes them again; while a stop is asked, that has no
    // effect. (FluidWorld and Session do both; see FluidWorld::interrupted.)
    bool interrupted() const { return skipped_.load(std::memory_order_relaxed); }
    void goOn() { skipped_.store(skipped_.load(std::memory_order_relaxed) && stopAsked(), std::memory_order_relaxed); }

    virtual std::vector<PassTime> takeTimes() = 0;
    virtual size_t bytesAllocated() const = 0;
    // From now on allocate() fails if it would raise bytesAllocated() above `bytes`.
    void limitMemory(size_t bytes) { mostBytes_ = bytes; }
    // From now on allocate() asks `may` first, and fails if that returns false: for a host that divides memory itself. Empty: it never
    // asks.
    void onAllocate(std::function<bool(size_t bytes)> may) { mayAllocate_ = std::move(may); }
    // From now on `sink` receives the span of each dispatch, on a GPU some frames late, during poll() or takeTimes(). An empty sink ends
    // it.
    void onSpan(SpanSink sink) { span_ = std::move(sink); }

    template <class T>
    void writeAll(Buffer& to, std::span<const T> items) {
        write(to, std::as_bytes(items));
    }
    template <class T>
    std::vector<T> readAll(const Buffer& from, size_t count) {
        std::vector<T> items = largeVector<T>(count);
        read(from, std::as_writable_bytes(std::span(items)));
        return items;
    }

  protected:
    Status checkLimit(size_t bytes) const;  // error (failed): above limitMemory(), or onAllocate() refuses
    // Whether the next dispatch, or the next chunk of one, must not run. From any thread.
    bool skips() {
        if (interrupted()) return true;
        if (!stopAsked()) return false;
        skipped_.store(true, std::memory_order_relaxed);
        return true;
    }
    bool lost() const { return health_.state == DeviceHealth::lost; }
    SpanSink span_;
    size_t mostBytes_ = SIZE_MAX;
    std::function<bool(size_t)> mayAllocate_;
    DeviceHealth health_;

  private:
    const std::atomic<bool>* stop_ = nullptr;
    std::atomic<bool> skipped_ = false;
};

}  // namespace rivulet
