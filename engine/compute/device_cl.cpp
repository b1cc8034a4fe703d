#include "engine/compute/device_cl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <new>
#include <optional>

#include "engine/compute/cl_devices.h"
#include "engine/compute/cl_owned.h"
#include "engine/compute/cl_sharing.h"
#include "engine/core/assert.h"

namespace rivulet {
namespace {

using cl::Context;
using cl::Event;
using cl::Memory;
using cl::Program;
using cl::Queue;
using cl::stateOf;

constexpr size_t kParamSlots = 32;      // parameter blocks kept on the device
constexpr uint32_t kFlushEvery = 16;    // dispatches between two flushes
constexpr size_t kHarvestAbove = 1024;  // timed dispatches above which times are collected without takeTimes()

struct Opened {
    Context context;
    Queue queue;  // null: the device cannot be opened
    GlShare share;
};

class ClDevice final : public Device {
  public:
    ClDevice(const ClCandidate& chosen, Opened opened, const ShaderFiles& files, Log log, const ClOptions& options);
    ~ClDevice() override;
    Backend backend() const override { return Backend::cl; }
    const DeviceInfo& info() const override { return info_; }
    GlShare glShare() const override { return share_; }
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override;
    Result<size_t> reload() override;
    std::vector<std::string> kernels() const override {
        std::vector<std::string> made;
        for (const Entry& e : kernels_) made.push_back(e.key);
        return made;
    }
    Result<Buffer> allocate(size_t bytes) override;
    void release(uint64_t handle, size_t bytes) override;
    void write(Buffer& to, std::span<const std::byte> bytes, size_t offset) override;
    void read(const Buffer& from, std::span<std::byte> bytes, size_t offset) override;
    void fill(Buffer& to, uint32_t word) override;
    void copy(const Buffer& from, Buffer& to, size_t bytes) override;
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) override;
    void poll() override;
    void dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) override;
    void finish() override;
    std::vector<PassTime> takeTimes() override;
    size_t bytesAllocated() const override { return bytesAllocated_; }

  private:
    struct Entry {
        std::string key;  // path and defines
        std::string path;
        Program program;
        cl::Kernel kernel;
        uint32_t localSize;
        cl_uint args;
        std::vector<Define> defines;  // with LOCAL_SIZE
        size_t text;                  // a hash of the source, to tell whether the files have changed
    };
    struct ParamSlot {
        Memory memory;
        std::vector<std::byte> bytes;  // its contents; also the source of a write that is still running
        Event written;
    };
    struct Upload {
        Event written;
        std::vector<std::byte> bytes;
    };
    struct Timed {
        Event done;
        uint32_t kernel;
    };
    struct PendingRead {
        Event done;
        std::vector<std::byte> bytes;
        std::function<void(std::span<const std::byte>)> then;
    };

    Program build(const KernelSource& source, std::string_view file, Error& why);
    Result<Entry> make(std::string key, std::string_view path, std::vector<Define> defines, uint32_t localSize, const KernelSource& source);
    Program cached(const std::string& key);
    void keep(const std::string& key, const Program& program);
    cl_mem params(std::span<const std::byte> bytes);
    void harvest();
    double hostTime(cl_ulong at);
    void dropUploads();
    static void giveUp(const Event& event, std::vector<std::byte>& bytes);
    bool succeeded(cl_int code, std::string_view what);
    // Calls the driver; a device that a test has declared lost returns an error instead.
    template <class Command>
    cl_int enqueue(const Command& command) {
        return dispatches_ < failAfter_ ? command() : CL_DEVICE_NOT_AVAILABLE;
    }
    static cl_mem memory(const Buffer& buffer) { return reinterpret_cast<cl_mem>(static_cast<uintptr_t>(buffer.handle())); }

    ShaderFiles files_;
    Log log_;
    cl_device_id device_;
    Context context_;
    Queue queue_;
    GlShare share_;
    DeviceInfo info_;
    std::string options_;
    std::string buildKey_;  // the part of a program's cache key beside its source: options, device and driver
    DiskCache cache_;
    size_t memoryLimit_;
    uint64_t failAfter_, eventFailsAfter_, dispatches_ = 0;
    size_t localSize_, maxLocalSize_;
    std::vector<Entry> kernels_;
    std::deque<ParamSlot> params_;  // oldest first
    std::deque<Upload> uploads_;    // in order: the front ends first
    std::deque<Timed> timed_;
    std::deque<PendingRead> pendingReads_;
    std::vector<PassTime> times_;
    size_t bytesAllocated_ = 0;
    uint32_t sinceFlush_ = 0;
    Queue clock_;                                  // a separate queue, so that reading the device's clock waits for no kernel
    Memory tick_;                                  // written to read the clock
    double clockOffset_ = 0, lastClockSync_ = -1;  // s: host clock minus device clock; host time of the last comparison
};

ClDevice::ClDevice(const ClCandidate& chosen, Opened opened, const ShaderFiles& files, Log log, const ClOptions& options)
    : files_(files),
      log_(std::move(log)),
      device_(chosen.device),
      context_(std::move(opened.context)),
      queue_(std::move(opened.queue)),
      share_(std::move(opened.share)),
      cache_(options.cache, log_),
      memoryLimit_(options.memoryLimit),
      failAfter_(options.failAfter),
      eventFailsAfter_(options.eventFailsAfter),
      localSize_(options.localSize) {
    const std::string version = clPlatformText(chosen.platform, CL_PLATFORM_VERSION), driver = clDeviceText(device_, CL_DRIVER_VERSION);
    info_.name = chosen.name;
    info_.driver = fmt::format("{}, driver {}", version, driver);
    info_.software = (chosen.type & CL_DEVICE_TYPE_CPU) != 0;
    info_.maxBufferBytes = std::min<size_t>(clDeviceValue<cl_ulong>(device_, CL_DEVICE_MAX_MEM_ALLOC_SIZE), options.mostBufferBytes);
    maxLocalSize_ = clDeviceValue<size_t>(device_, CL_DEVICE_MAX_WORK_GROUP_SIZE);
    options_ = "-cl-std=CL1.2";  // no fast-math, so that the backends agree up to rounding
    if (clDeviceValue<cl_device_fp_config>(device_, CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)
        options_ += " -cl-fp32-correctly-rounded-divide-sqrt";
    for (const std::string& part : {options_, info_.name, clDeviceText(device_, CL_DEVICE_VENDOR), clDeviceText(device_, CL_DEVICE_VERSION),
                                    driver, chosen.platformName, version})
        buildKey_ += part + '\n';
}

// Waits for a copy that the driver may still make after clFinish has failed. If that fails too, the memory of the copy is never freed.
void ClDevice::giveUp(const Event& event, std::vector<std::byte>& bytes) {
    const cl_event last = event.get();
    if (last == nullptr || stateOf(event) <= CL_COMPLETE || clWaitForEvents(1, &last) == CL_SUCCESS) return;
    static_cast<void>(new (std::nothrow) std::vector<std::byte>(std::move(bytes)));
}

ClDevice::~ClDevice() {
    if (clFinish(queue_.get()) == CL_SUCCESS) return;
    for (Upload& upload : uploads_) giveUp(upload.written, upload.bytes);
    for (ParamSlot& slot : params_) giveUp(slot.written, slot.bytes);
    for (PendingRead& pending : pendingReads_) giveUp(pending.done, pending.bytes);
}

// For calls without a Result: the first failure is logged; a broken queue would otherwise repeat it every frame.
bool ClDevice::succeeded(cl_int code, std::string_view what) {
    if (code == CL_SUCCESS) return true;
    if (health_.state != DeviceHealth::lost) {
        health_ = {DeviceHealth::lost, fmt::format("could not {}: {}", what, clErrorName(code))};
        log_.error(fmt::format("OpenCL on {} {}; try --backend cpu", info_.name, health_.why));
    }
    return false;
}

// The compiled program from the cache; null if there is none or the driver refuses it.
Program ClDevice::cached(const std::string& key) {
    const std::optional<std::vector<std::byte>> kept = cache_.find(key);
    if (!kept) return {};
    const size_t size = kept->size();
    const auto* bytes = reinterpret_cast<const unsigned char*>(kept->data());
    cl_int status = CL_SUCCESS, code = CL_SUCCESS;
    Program program(clCreateProgramWithBinary(context_.get(), 1, &device_, &size, &bytes, &status, &code));
    if (!program || code != CL_SUCCESS || status != CL_SUCCESS) return {};
    if (clBuildProgram(program.get(), 1, &device_, options_.c_str(), nullptr, nullptr) != CL_SUCCESS) return {};
    return program;
}

void ClDevice::keep(const std::string& key, const Program& program) {
    size_t size = 0;
    if (clGetProgramInfo(program.get(), CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) != CL_SUCCESS || size == 0) return;
    std::vector<std::byte> binary(size);
    auto* bytes = reinterpret_cast<unsigned char*>(binary.data());
    if (clGetProgramInfo(program.get(), CL_PROGRAM_BINARIES, sizeof bytes, static_cast<void*>(&bytes), nullptr) == CL_SUCCESS)
        cache_.keep(key, binary);
}

// Compiles a program. On failure it returns null and `why` holds the compiler's message.
Program ClDevice::build(const KernelSource& source, std::string_view file, Error& why) {
    const char* text = source.text.c_str();
    cl_int code = CL_SUCCESS;
    Program program(clCreateProgramWithSource(context_.get(), 1, &text, nullptr, &code));
    if (program) code = clBuildProgram(program.get(), 1, &device_, options_.c_str(), nullptr, nullptr);
    if (code == CL_SUCCESS) return program;
    const std::string log = !program ? std::string() : clText([&](size_t size, void* to, size_t* needed) {
        return clGetProgramBuildInfo(program.get(), device_, CL_PROGRAM_BUILD_LOG, size, to, needed);
    });
    why = failed(
        fmt::format("OpenCL on {} cannot compile {} ({}):\n{}", info_.name, file, clErrorName(code), shortLog(readableLog(log, source))));
    return {};
}

Result<Kernel> ClDevice::kernel(std::string_view path, std::span<const Define> defines) {
    std::vector<Define> sorted(defines.begin(), defines.end());
    std::sort(sorted.begin(), sorted.end(), [](const Define& a, const Define& b) { return a.name < b.name; });
    uint32_t localSize = 0;
    std::string key(path);
    for (const Define& d : sorted) {
        key += fmt::format(";{}={}", d.name, d.value);
        if (d.name == "LOCAL_SIZE") localSize = static_cast<uint32_t>(std::strtoul(d.value.c_str(), nullptr, 10));
    }
    const auto known = std::find_if(kernels_.begin(), kernels_.end(), [&](const Entry& e) { return e.key == key; });
    if (known != kernels_.end()) return Kernel{static_cast<uint32_t>(known - kernels_.begin())};
    if (localSize == 0) {
        localSize = static_cast<uint32_t>(std::min(localSize_, maxLocalSize_));
        sorted.push_back({"LOCAL_SIZE", std::to_string(localSize)});
    }

    const std::string file = fmt::format("shaders/{}.kernel", path);
    const Result<KernelSource> source = files_.flatten(file, sorted, Dialect::openclC);
    if (!source) return source.error();
    Result<Entry> made = make(std::move(key), path, std::move(sorted), localSize, *source);
    if (!made) return made.error();
    kernels_.push_back(std::move(*made));
    return Kernel{static_cast<uint32_t>(kernels_.size() - 1)};
}

Result<ClDevice::Entry> ClDevice::make(std::string key, std::string_view path, std::vector<Define> defines, uint32_t localSize,
                                       const KernelSource& source) {
    const std::string file = fmt::format("shaders/{}.kernel", path);
    const std::string programKey = buildKey_ + source.text;
    const std::string name(path.substr(path.rfind('/') + 1));
    cl_int code = CL_SUCCESS;
    Program program = cached(programKey);
    cl::Kernel object(program ? clCreateKernel(program.get(), name.c_str(), &code) : nullptr);
    if (!object) {
        Error why;
        program = build(source, file, why);
        if (!program) return why;
        object = cl::Kernel(clCreateKernel(program.get(), name.c_str(), &code));
        if (!object)
            return failed(fmt::format("{} has no kernel named {} ({}); write KERNEL({}, ...)", file, name, clErrorName(code), name));
        keep(programKey, program);
    }
    size_t allowed = 0;
    clGetKernelWorkGroupInfo(object.get(), device_, CL_KERNEL_WORK_GROUP_SIZE, sizeof allowed, &allowed, nullptr);
    // NVIDIA names 256 also for a kernel that was compiled for larger groups, as KERNEL demands.
    size_t compiled[3] = {};
    clGetKernelWorkGroupInfo(object.get(), device_, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof compiled, compiled, nullptr);
    if (compiled[0] == localSize) allowed = std::max(allowed, compiled[0]);
    if (localSize > std::min(allowed, maxLocalSize_))
        return failed(fmt::format("{} runs in work groups of {}, but {} allows it {}; try --backend cpu", file, localSize, info_.name,
                                  std::min(allowed, maxLocalSize_)));
    cl_uint args = 0;
    clGetKernelInfo(object.get(), CL_KERNEL_NUM_ARGS, sizeof args, &args, nullptr);
    return Entry{std::move(key),     std::string(path),
                 std::move(program), std::move(object),
                 localSize,          args,
                 std::move(defines), std::hash<std::string>()(source.text)};
}

Result<size_t> ClDevice::reload() {
    std::vector<std::pair<Entry*, Entry>> fresh;
    for (Entry& e : kernels_) {
        const Result<KernelSource> source = files_.flatten(fmt::format("shaders/{}.kernel", e.path), e.defines, Dialect::openclC);
        if (!source) return source.error();
        if (std::hash<std::string>()(source->text) == e.text) continue;
        Result<Entry> made = make(e.key, e.path, e.defines, e.localSize, *source);
        if (!made) return made.error();
        if (made->args != e.args)
            return failed(fmt::format("shaders/{}.kernel now has {} arguments, but the program passes {}; rebuild the program", e.path,
                                      made->args, e.args));
        fresh.emplace_back(&e, std::move(*made));
    }
    for (auto& [entry, made] : fresh) *entry = std::move(made);
    return fresh.size();
}

// OpenCL refuses buffers of 0 bytes, and fills are done in 4-byte words.
size_t paddedBytes(size_t bytes) { return std::max<size_t>((bytes + 15) / 16 * 16, 16); }

Result<Buffer> ClDevice::allocate(size_t bytes) {
    if (Status allowed = checkLimit(bytes); !allowed) return allowed.error();
    if (bytes > info_.maxBufferBytes) {
        if (health_.state == DeviceHealth::works) health_ = {DeviceHealth::full, fmt::format("allows no buffer of {} MiB", bytes >> 20U)};
        return noMemory(fmt::format("{} allows buffers of up to {} MiB, but {} MiB are needed; use fewer particles or coarser voxels",
                                    info_.name, info_.maxBufferBytes >> 20U, bytes >> 20U));
    }
    const size_t padded = paddedBytes(bytes);
    cl_int code = bytesAllocated_ + bytes > memoryLimit_ ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS;
    Memory memory(code != CL_SUCCESS ? nullptr : clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, padded, nullptr, &code));
    const cl_uint zero = 0;
    // Drivers that allocate late fail here, not above.
    if (memory)
        code = enqueue([&] { return clEnqueueFillBuffer(queue_.get(), memory.get(), &zero, sizeof zero, 0, padded, 0, nullptr, nullptr); });
    if (code != CL_SUCCESS) {
        const bool full = code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES || code == CL_OUT_OF_HOST_MEMORY ||
                          code == CL_INVALID_BUFFER_SIZE;
        if (!full) {
            succeeded(code, fmt::format("allocate {} MiB", bytes >> 20U));
            return failed(fmt::format("OpenCL on {} {}; use --backend cpu", info_.name, health_.why));
        }
        if (health_.state == DeviceHealth::works) health_ = {DeviceHealth::full, fmt::format("is out of memory: {}", clErrorName(code))};
        return noMemory(
            fmt::format("{} is out of memory: cannot allocate {} MiB, {} MiB are in use ({}); use fewer particles or coarser voxels",
                        info_.name, bytes >> 20U, bytesAllocated_ >> 20U, clErrorName(code)));
    }
    bytesAllocated_ += bytes;
    clRetainMemObject(memory.get());  // for the Buffer
    return Buffer(*this, reinterpret_cast<uintptr_t>(memory.get()), bytes);
}

void ClDevice::release(uint64_t handle, size_t bytes) {
    clReleaseMemObject(reinterpret_cast<cl_mem>(static_cast<uintptr_t>(handle)));
    bytesAllocated_ -= bytes;
}

void ClDevice::dropUploads() {
    while (!uploads_.empty() && stateOf(uploads_.front().written) <= CL_COMPLETE) uploads_.pop_front();
}

void ClDevice::write(Buffer& to, std::span<const std::byte> bytes, size_t offset) {
    ASSERT(offset + bytes.size() <= to.bytes(), "write inside the buffer");
    if (bytes.empty() || lost()) return;
    dropUploads();
    Upload upload{Event(), std::vector<std::byte>(bytes.begin(), bytes.end())};
    cl_event written = nullptr;
    const cl_int code = enqueue([&] {
        return clEnqueueWriteBuffer(queue_.get(), memory(to), CL_FALSE, offset, bytes.size(), upload.bytes.data(), 0, nullptr, &written);
    });
    if (!succeeded(code, fmt::format("write {} bytes", bytes.size()))) return;
    upload.written = Event(written);
    uploads_.push_back(std::move(upload));
}

void ClDevice::read(const Buffer& from, std::span<std::byte> bytes, size_t offset) {
    ASSERT(offset + bytes.size() <= from.bytes(), "read inside the buffer");
    if (bytes.empty()) return;
    if (!lost()) {
        const cl_int code = enqueue([&] {
            return clEnqueueReadBuffer(queue_.get(), memory(from), CL_TRUE, offset, bytes.size(), bytes.data(), 0, nullptr, nullptr);
        });
        succeeded(code, fmt::format("read {} bytes", bytes.size()));
    }
    if (lost()) std::ranges::fill(bytes, std::byte{0});
}

void ClDevice::fill(Buffer& to, uint32_t word) {
    if (to.bytes() == 0 || lost()) return;
    const cl_int code = enqueue([&] {
        return clEnqueueFillBuffer(queue_.get(), memory(to), &word, sizeof word, 0, (to.bytes() + 3) / 4 * 4, 0, nullptr, nullptr);
    });
    succeeded(code, fmt::format("fill {} bytes", to.bytes()));
}

void ClDevice::copy(const Buffer& from, Buffer& to, size_t bytes) {
    ASSERT(bytes <= from.bytes() && bytes <= to.bytes(), "copy inside both buffers");
    ASSERT(from.handle() != to.handle(), "copy from one buffer to another");
    if (bytes == 0 || lost()) return;
    const cl_int code =
        enqueue([&] { return clEnqueueCopyBuffer(queue_.get(), memory(from), memory(to), 0, 0, bytes, 0, nullptr, nullptr); });
    succeeded(code, fmt::format("copy {} bytes", bytes));
}

void ClDevice::readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) {
    ASSERT(offset <= from.bytes() && bytes <= from.bytes() - offset, "read inside the buffer");
    PendingRead pending{Event(), std::vector<std::byte>(bytes), std::move(then)};
    if (lost()) return;
    if (bytes > 0) {
        cl_event done = nullptr;
        const cl_int code = enqueue([&] {
            return clEnqueueReadBuffer(queue_.get(), memory(from), CL_FALSE, offset, bytes, pending.bytes.data(), 0, nullptr, &done);
        });
        if (!succeeded(code, fmt::format("read {} bytes", bytes))) return;
        pending.done = Event(done);
        clFlush(queue_.get());
        sinceFlush_ = 0;
    }
    pendingReads_.push_back(std::move(pending));
}

void ClDevice::poll() {
    clFlush(queue_.get());
    sinceFlush_ = 0;
    dropUploads();
    harvest();
    // Reads that a callback starts are left to the next poll().
    for (size_t left = pendingReads_.size(); left > 0 && stateOf(pendingReads_.front().done) <= CL_COMPLETE; --left) {
        const PendingRead ready = std::move(pendingReads_.front());
        pendingReads_.pop_front();
        if (succeeded(std::min(stateOf(ready.done), CL_SUCCESS), "read results back")) ready.then(ready.bytes);
    }
}

// The parameter block on the device. Most kernels of a step have the same block, which is written once. The queue is in order: a slot may
// be overwritten after the kernels that read it, once no earlier write still reads the host's copy.
cl_mem ClDevice::params(std::span<const std::byte> bytes) {
    const auto same = std::find_if(params_.rbegin(), params_.rend(), [&](const ParamSlot& slot) {
        return slot.bytes.size() == bytes.size() && std::memcmp(slot.bytes.data(), bytes.data(), bytes.size()) == 0;
    });
    if (same != params_.rend()) return same->memory.get();
    ParamSlot slot;
    if (params_.size() >= kParamSlots && stateOf(params_.front().written) <= CL_COMPLETE) {
        slot = std::move(params_.front());
        params_.pop_front();
    }
    if (!slot.memory || slot.bytes.size() != bytes.size()) {
        cl_int made = CL_SUCCESS;
        slot.memory = Memory(clCreateBuffer(context_.get(), CL_MEM_READ_ONLY, paddedBytes(bytes.size()), nullptr, &made));
        if (!succeeded(made, "allocate a parameter block")) return nullptr;
    }
    slot.bytes.assign(bytes.begin(), bytes.end());
    cl_event written = nullptr;
    const cl_int code = enqueue([&] {
        return clEnqueueWriteBuffer(queue_.get(), slot.memory.get(), CL_FALSE, 0, bytes.size(), slot.bytes.data(), 0, nullptr, &written);
    });
    if (!succeeded(code, "write a parameter block")) return nullptr;
    slot.written = Event(written);
    params_.push_back(std::move(slot));
    return params_.back().memory.get();
}

void ClDevice::dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) {
    ASSERT(kernel.index < kernels_.size(), "get the kernel from this device before dispatching it");
    const Entry& entry = kernels_[kernel.index];
    ASSERT(entry.args == buffers.size() + 1, "pass a buffer for every row of the kernel's ARGS");
    ASSERT(!params.empty() && params.size() % 16 == 0, "a parameter block's size must be a multiple of 16");
    if (threads == 0 || skips() || lost()) return;
    const cl_mem block = this->params(params);
    if (!block) return;
    clSetKernelArg(entry.kernel.get(), 0, sizeof(cl_mem), &block);
    for (size_t k = 0; k < buffers.size(); ++k) {
        const cl_mem bound = buffers[k] ? memory(*buffers[k]) : nullptr;
        clSetKernelArg(entry.kernel.get(), static_cast<cl_uint>(k + 1), sizeof(cl_mem), &bound);
    }
    const size_t local = entry.localSize;
    const size_t global = (threads + local - 1) / local * local;
    cl_event done = nullptr;
    const cl_int code =
        enqueue([&] { return clEnqueueNDRangeKernel(queue_.get(), entry.kernel.get(), 1, nullptr, &global, &local, 0, nullptr, &done); });
    if (!succeeded(code, fmt::format("run {}", entry.path))) return;
    timed_.push_back({Event(done), kernel.index});
    if (dispatches_++ == eventFailsAfter_) {
        cl_int made = CL_SUCCESS;
        timed_.back().done = Event(clCreateUserEvent(context_.get(), &made));
        clSetUserEventStatus(timed_.back().done.get(), CL_OUT_OF_RESOURCES);
    }
    if (++sinceFlush_ >= kFlushEvery) {
        clFlush(queue_.get());
        sinceFlush_ = 0;
    }
    if (timed_.size() > kHarvestAbove) harvest();
}

void ClDevice::finish() {
    succeeded(clFinish(queue_.get()), "finish its work");
    sinceFlush_ = 0;
    dropUploads();
    harvest();
}

// Adds up the times of finished dispatches. The queue is in order, so the first unfinished one ends the search.
void ClDevice::harvest() {
    while (!timed_.empty()) {
        const Timed& front = timed_.front();
        const cl_int state = stateOf(front.done);
        if (state > CL_COMPLETE) return;
        cl_ulong start = 0, end = 0;
        const std::string& path = kernels_[front.kernel].path;
        if (succeeded(std::min(state, CL_SUCCESS), fmt::format("run {}", path)) &&
            clGetEventProfilingInfo(front.done.get(), CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr) == CL_SUCCESS &&
            clGetEventProfilingInfo(front.done.get(), CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) == CL_SUCCESS) {
            auto time = std::find_if(times_.begin(), times_.end(), [&](const PassTime& t) { return t.name == path; });
            if (time == times_.end()) time = times_.insert(times_.end(), PassTime{path, 0, 0});
            time->ms += end > start ? static_cast<double>(end - start) * 1.0e-6 : 0.0;
            ++time->calls;
            if (span_) span_({path, hostTime(start), hostTime(end)});
        }
        timed_.pop_front();
    }
}

// Converts a device time to s of hostSeconds(). OpenCL 1.2 cannot read the device's clock: instead, the end of a small blocking write is
// taken as the present time.
double ClDevice::hostTime(cl_ulong at) {
    // The two clocks drift, so they are compared once a second.
    if (const double before = hostSeconds(); lastClockSync_ < 0 || before > lastClockSync_ + 1) {
        lastClockSync_ = before;
        cl_int code = CL_SUCCESS;
        if (!clock_) clock_ = Queue(clCreateCommandQueue(context_.get(), device_, CL_QUEUE_PROFILING_ENABLE, &code));
        if (!tick_) tick_ = Memory(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, paddedBytes(sizeof(uint32_t)), nullptr, &code));
        const uint32_t word = 0;
        cl_event written = nullptr;
        if (clock_ && tick_ &&
            clEnqueueWriteBuffer(clock_.get(), tick_.get(), CL_TRUE, 0, sizeof word, &word, 0, nullptr, &written) == CL_SUCCESS) {
            const double now = hostSeconds();
            const Event event(written);
            cl_ulong end = 0;
            if (clGetEventProfilingInfo(written, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) == CL_SUCCESS)
                clockOffset_ = now - 1.0e-9 * static_cast<double>(end);
        }
    }
    return clockOffset_ + 1.0e-9 * static_cast<double>(at);
}

std::vector<PassTime> ClDevice::takeTimes() {
    harvest();
    return std::exchange(times_, {});
}

Queue queueOf(const Context& context, cl_device_id device, cl_int& code) {
    return Queue(context ? clCreateCommandQueue(context.get(), device, CL_QUEUE_PROFILING_ENABLE, &code) : nullptr);
}

// Opens a context that shares with OpenGL if sharing passes its test, else a plain one.
Opened open(const ClCandidate& candidate, const ClOptions& options, cl_int& code) {
    const ClGlCalls calls = options.glCalls != nullptr ? *options.glCalls : driversGlCalls();
    Opened opened;
    Result<Context> shared = makeSharedContext(candidate, options.gl, calls);
    if (shared) {
        opened.queue = queueOf(*shared, candidate.device, code);
        auto proven = opened.queue ? proveSharing(shared->get(), opened.queue.get(), options.gl, calls)
                                   : failed(fmt::format("{} has no queue that shares with OpenGL: {}", candidate.name, clErrorName(code)));
        if (proven) {
            opened.context = std::move(*shared);
            opened.share.by = std::move(*proven);
            return opened;
        }
        opened.share.whyNot = proven.error().message;
    } else {
        opened.share.whyNot = shared.error().message;
    }
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(candidate.platform), 0};
    opened.context = Context(clCreateContext(properties, 1, &candidate.device, nullptr, nullptr, &code));
    opened.queue = queueOf(opened.context, candidate.device, code);
    return opened;
}

}  // namespace

Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles& files, Log log, const ClOptions& options) {
    size_t platforms = 0;
    const std::vector<ClCandidate> all = findClDevices(platforms);
    if (platforms == 0)
        return failed(
            "this machine has no working OpenCL driver; install one (on Debian: apt-get install pocl-opencl-icd) or use --backend cpu");
    if (all.empty()) return failed("OpenCL is installed but lists no device; use --backend cpu");
    const auto candidates = namedClDevices(all, options.device);
    if (!candidates) return candidates.error();
    std::string why;
    for (const ClCandidate& candidate : *candidates) {
        if (!candidate.usable) {
            why = fmt::format("{} is not available, cannot compile, or is older than OpenCL 1.2", candidate.name);
            continue;
        }
        cl_int code = CL_SUCCESS;
        Opened opened = open(candidate, options, code);
        if (!opened.queue) {
            why = fmt::format("{} cannot be opened: {}", candidate.name, clErrorName(code));
            continue;
        }
        if (!options.device.empty() && candidates->size() > 1)
            log.notice(fmt::format("'{}' matches {} OpenCL devices: using {} ({}); 'rivulet list devices' shows their numbers",
                                   options.device, candidates->size(), candidate.name, candidate.platformName));
        return std::unique_ptr<Device>(std::make_unique<ClDevice>(candidate, std::move(opened), files, std::move(log), options));
    }
    return failed(fmt::format("OpenCL is installed but has no usable device ({}); use --backend cpu", why));
}

}  // namespace rivulet
