#include "engine/compute/device_cl.h"

#include <CL/cl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <optional>

namespace rivulet {
namespace {

std::string errorName(cl_int code) {
    switch (code) {
        case CL_DEVICE_NOT_FOUND:
            return "CL_DEVICE_NOT_FOUND";
        case CL_DEVICE_NOT_AVAILABLE:
            return "CL_DEVICE_NOT_AVAILABLE";
        case CL_COMPILER_NOT_AVAILABLE:
            return "CL_COMPILER_NOT_AVAILABLE";
        case CL_MEM_OBJECT_ALLOCATION_FAILURE:
            return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
        case CL_OUT_OF_RESOURCES:
            return "CL_OUT_OF_RESOURCES";
        case CL_OUT_OF_HOST_MEMORY:
            return "CL_OUT_OF_HOST_MEMORY";
        case CL_BUILD_PROGRAM_FAILURE:
            return "CL_BUILD_PROGRAM_FAILURE";
        case CL_INVALID_BUFFER_SIZE:
            return "CL_INVALID_BUFFER_SIZE";
        case CL_INVALID_KERNEL_ARGS:
            return "CL_INVALID_KERNEL_ARGS";
        case CL_INVALID_WORK_GROUP_SIZE:
            return "CL_INVALID_WORK_GROUP_SIZE";
        default:
            return fmt::format("OpenCL error {}", code);
    }
}

// Owns one OpenCL object.
template <class T, cl_int (*kRelease)(T)>
class Owned {
  public:
    Owned() = default;
    explicit Owned(T object) : object_(object) {}
    Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
    Owned& operator=(Owned&& other) noexcept {
        std::swap(object_, other.object_);
        return *this;
    }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    ~Owned() {
        if (object_) kRelease(object_);
    }
    T get() const { return object_; }
    explicit operator bool() const { return object_ != nullptr; }

  private:
    T object_ = nullptr;
};
using Context = Owned<cl_context, clReleaseContext>;
using Queue = Owned<cl_command_queue, clReleaseCommandQueue>;
using Program = Owned<cl_program, clReleaseProgram>;
using ClKernel = Owned<cl_kernel, clReleaseKernel>;
using Event = Owned<cl_event, clReleaseEvent>;
using Memory = Owned<cl_mem, clReleaseMemObject>;

// An event's state: > 0 under way, CL_COMPLETE (0) done, < 0 failed.
cl_int stateOf(const Event& event) {
    cl_int state = CL_COMPLETE;
    if (event) clGetEventInfo(event.get(), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, nullptr);
    return state;
}

template <class T>
T deviceValue(cl_device_id device, cl_device_info what) {
    T value{};
    clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
    return value;
}

// What clGet*Info gives as text, without the blanks and line ends that some drivers put around it.
template <class Get>
std::string infoText(Get get) {
    constexpr const char* kBlank = " \n\r\t";
    size_t size = 0;
    if (get(size_t{0}, nullptr, &size) != CL_SUCCESS || size == 0) return {};
    std::string text(size, '\0');
    if (get(size, text.data(), nullptr) != CL_SUCCESS) return {};
    text.resize(std::strlen(text.c_str()));
    const size_t first = text.find_first_not_of(kBlank);
    return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}
std::string deviceText(cl_device_id device, cl_device_info what) {
    return infoText([&](size_t size, void* to, size_t* needed) { return clGetDeviceInfo(device, what, size, to, needed); });
}
std::string platformText(cl_platform_id platform, cl_platform_info what) {
    return infoText([&](size_t size, void* to, size_t* needed) { return clGetPlatformInfo(platform, what, size, to, needed); });
}

struct Candidate {
    cl_platform_id platform;
    cl_device_id device;
    cl_device_type type;
    bool usable;  // there now, with a compiler, OpenCL 1.2
};

// Every device, the best first: usable GPUs, other usable ones, the rest. `platforms` receives how many drivers were found.
std::vector<Candidate> findDevices(size_t& platforms) {
    // A driver file that names a missing library is skipped by the loader; with no other driver the call fails, which means none too.
    cl_uint count = 0;
    platforms = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return {};
    std::vector<cl_platform_id> platformIds(count);
    if (clGetPlatformIDs(count, platformIds.data(), nullptr) != CL_SUCCESS) return {};
    platforms = count;
    std::vector<Candidate> found;
    for (const cl_platform_id platform : platformIds) {
        cl_uint devices = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS || devices == 0) continue;
        std::vector<cl_device_id> ids(devices);
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, devices, ids.data(), nullptr) != CL_SUCCESS) continue;
        for (const cl_device_id id : ids) {
            const bool usable = deviceValue<cl_bool>(id, CL_DEVICE_AVAILABLE) && deviceValue<cl_bool>(id, CL_DEVICE_COMPILER_AVAILABLE) &&
                                deviceValue<cl_bool>(id, CL_DEVICE_ENDIAN_LITTLE) &&
                                !deviceText(id, CL_DEVICE_VERSION).starts_with("OpenCL 1.0") &&
                                !deviceText(id, CL_DEVICE_VERSION).starts_with("OpenCL 1.1");
            found.push_back({platform, id, deviceValue<cl_device_type>(id, CL_DEVICE_TYPE), usable});
        }
    }
    const auto rank = [](const Candidate& c) { return !c.usable ? 2 : (c.type & CL_DEVICE_TYPE_GPU) ? 0 : 1; };
    std::stable_sort(found.begin(), found.end(), [&](const Candidate& a, const Candidate& b) { return rank(a) < rank(b); });
    return found;
}

const char* typeName(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "GPU";
    if (type & CL_DEVICE_TYPE_CPU) return "CPU";
    return "accelerator";
}

constexpr uint32_t kDefaultLocalSize = 64;
constexpr size_t kParamSlots = 32;      // parameter blocks kept on the device
constexpr uint32_t kFlushEvery = 16;    // dispatches handed to the driver at once
constexpr size_t kHarvestAbove = 1024;  // timed dispatches that may wait for takeTimes()

class ClDevice final : public Device {
  public:
    ClDevice(const Candidate& chosen, Context context, Queue queue, const ShaderFiles& files, Log log);
    ~ClDevice() override;
    Backend backend() const override { return Backend::cl; }
    const DeviceInfo& info() const override { return info_; }
    Result<Kernel> kernel(std::string_view path, std::span<const Define> defines) override;
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
    void readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then) override;
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
        ClKernel kernel;
        uint32_t localSize;
        cl_uint args;
    };
    struct ParamSlot {
        Memory memory;
        std::vector<std::byte> bytes;  // what it holds, and what the write in flight reads
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
    struct Awaited {
        Event done;
        std::vector<std::byte> bytes;
        std::function<void(std::span<const std::byte>)> then;
    };

    cl_mem params(std::span<const std::byte> bytes);
    void harvest();
    double hostTime(cl_ulong at);
    void dropUploads();
    bool succeeded(cl_int code, std::string_view what);
    static cl_mem memory(const Buffer& buffer) { return reinterpret_cast<cl_mem>(static_cast<uintptr_t>(buffer.handle())); }

    ShaderFiles files_;
    Log log_;
    cl_device_id device_;
    Context context_;
    Queue queue_;
    DeviceInfo info_;
    std::string options_;
    size_t maxLocalSize_;
    std::vector<Entry> kernels_;
    std::deque<ParamSlot> params_;  // oldest first
    std::deque<Upload> uploads_;    // in order: the front ends first
    std::deque<Timed> timed_;
    std::deque<Awaited> awaited_;
    std::vector<PassTime> times_;
    size_t bytesAllocated_ = 0;
    uint32_t sinceFlush_ = 0;
    bool troubleTold_ = false;
    std::optional<double> ahead_;  // s, the host's clock before the device's
};

ClDevice::ClDevice(const Candidate& chosen, Context context, Queue queue, const ShaderFiles& files, Log log)
    : files_(files), log_(std::move(log)), device_(chosen.device), context_(std::move(context)), queue_(std::move(queue)) {
    info_.name = deviceText(device_, CL_DEVICE_NAME);
    info_.driver = fmt::format("{}, driver {}", platformText(chosen.platform, CL_PLATFORM_VERSION), deviceText(device_, CL_DRIVER_VERSION));
    info_.software = (chosen.type & CL_DEVICE_TYPE_CPU) != 0;
    info_.maxBufferBytes = deviceValue<cl_ulong>(device_, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    maxLocalSize_ = deviceValue<size_t>(device_, CL_DEVICE_MAX_WORK_GROUP_SIZE);
    options_ = "-cl-std=CL1.2";  // no fast-math: the backends agree to rounding
    if (deviceValue<cl_device_fp_config>(device_, CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT)
        options_ += " -cl-fp32-correctly-rounded-divide-sqrt";
}

ClDevice::~ClDevice() { clFinish(queue_.get()); }

// Calls that have no Result say their trouble once: after the first, a broken queue would repeat it every frame.
bool ClDevice::succeeded(cl_int code, std::string_view what) {
    if (code == CL_SUCCESS) return true;
    if (!troubleTold_) log_.error(fmt::format("OpenCL on {} could not {}: {}; try --backend cpu", info_.name, what, errorName(code)));
    troubleTold_ = true;
    return false;
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
        localSize = static_cast<uint32_t>(std::min<size_t>(kDefaultLocalSize, maxLocalSize_));
        sorted.push_back({"LOCAL_SIZE", std::to_string(localSize)});
    }

    const std::string file = fmt::format("shaders/{}.kernel", path);
    Result<KernelSource> source = files_.flatten(file, sorted, Dialect::openclC);
    if (!source) return source.error();
    const char* text = source->text.c_str();
    cl_int code = CL_SUCCESS;
    Program program(clCreateProgramWithSource(context_.get(), 1, &text, nullptr, &code));
    if (program) code = clBuildProgram(program.get(), 1, &device_, options_.c_str(), nullptr, nullptr);
    if (code != CL_SUCCESS) {
        const std::string log = !program ? std::string() : infoText([&](size_t size, void* to, size_t* needed) {
            return clGetProgramBuildInfo(program.get(), device_, CL_PROGRAM_BUILD_LOG, size, to, needed);
        });
        return failed(
            fmt::format("OpenCL on {} cannot compile {} ({}):\n{}", info_.name, file, errorName(code), readableLog(log, *source)));
    }
    const std::string name(path.substr(path.rfind('/') + 1));
    ClKernel object(clCreateKernel(program.get(), name.c_str(), &code));
    if (!object) return failed(fmt::format("{} holds no kernel named {} ({}): write KERNEL({}, ...)", file, name, errorName(code), name));
    size_t allowed = 0;
    clGetKernelWorkGroupInfo(object.get(), device_, CL_KERNEL_WORK_GROUP_SIZE, sizeof allowed, &allowed, nullptr);
    if (localSize > std::min(allowed, maxLocalSize_))
        return failed(fmt::format("{} runs in work groups of {}, but {} allows it {}; try --backend cpu", file, localSize, info_.name,
                                  std::min(allowed, maxLocalSize_)));
    cl_uint args = 0;
    clGetKernelInfo(object.get(), CL_KERNEL_NUM_ARGS, sizeof args, &args, nullptr);
    kernels_.push_back({std::move(key), std::string(path), std::move(program), std::move(object), localSize, args});
    return Kernel{static_cast<uint32_t>(kernels_.size() - 1)};
}

// OpenCL has no buffers of 0 bytes, and fills whole words.
size_t paddedBytes(size_t bytes) { return std::max<size_t>((bytes + 15) / 16 * 16, 16); }

Result<Buffer> ClDevice::allocate(size_t bytes) {
    if (bytes > info_.maxBufferBytes)
        return failed(fmt::format("{} allows buffers of {} MiB, but {} MiB were asked for; use fewer particles or coarser voxels",
                                  info_.name, info_.maxBufferBytes >> 20U, bytes >> 20U));
    const size_t padded = paddedBytes(bytes);
    cl_int code = CL_SUCCESS;
    Memory memory(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, padded, nullptr, &code));
    const cl_uint zero = 0;
    // Drivers that allocate late fail here, not above.
    if (memory) code = clEnqueueFillBuffer(queue_.get(), memory.get(), &zero, sizeof zero, 0, padded, 0, nullptr, nullptr);
    if (code != CL_SUCCESS)
        return failed(
            fmt::format("{} is out of memory: {} MiB were asked for while {} MiB are in use ({}); use fewer particles or coarser voxels",
                        info_.name, bytes >> 20U, bytesAllocated_ >> 20U, errorName(code)));
    bytesAllocated_ += bytes;
    clRetainMemObject(memory.get());  // the Buffer's
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
    if (bytes.empty()) return;
    dropUploads();
    Upload upload{Event(), std::vector<std::byte>(bytes.begin(), bytes.end())};
    cl_event written = nullptr;
    if (!succeeded(
            clEnqueueWriteBuffer(queue_.get(), memory(to), CL_FALSE, offset, bytes.size(), upload.bytes.data(), 0, nullptr, &written),
            fmt::format("write {} bytes", bytes.size())))
        return;
    upload.written = Event(written);
    uploads_.push_back(std::move(upload));
}

void ClDevice::read(const Buffer& from, std::span<std::byte> bytes, size_t offset) {
    ASSERT(offset + bytes.size() <= from.bytes(), "read inside the buffer");
    if (bytes.empty()) return;
    succeeded(clEnqueueReadBuffer(queue_.get(), memory(from), CL_TRUE, offset, bytes.size(), bytes.data(), 0, nullptr, nullptr),
              fmt::format("read {} bytes", bytes.size()));
}

void ClDevice::fill(Buffer& to, uint32_t word) {
    if (to.bytes() == 0) return;
    succeeded(clEnqueueFillBuffer(queue_.get(), memory(to), &word, sizeof word, 0, (to.bytes() + 3) / 4 * 4, 0, nullptr, nullptr),
              fmt::format("fill {} bytes", to.bytes()));
}

void ClDevice::copy(const Buffer& from, Buffer& to, size_t bytes) {
    ASSERT(bytes <= from.bytes() && bytes <= to.bytes(), "copy inside both buffers");
    ASSERT(from.handle() != to.handle(), "copy from one buffer to another");
    if (bytes == 0) return;
    succeeded(clEnqueueCopyBuffer(queue_.get(), memory(from), memory(to), 0, 0, bytes, 0, nullptr, nullptr),
              fmt::format("copy {} bytes", bytes));
}

void ClDevice::readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then) {
    ASSERT(bytes <= from.bytes(), "read inside the buffer");
    Awaited awaited{Event(), std::vector<std::byte>(bytes), std::move(then)};
    if (bytes > 0) {
        cl_event done = nullptr;
        if (!succeeded(clEnqueueReadBuffer(queue_.get(), memory(from), CL_FALSE, 0, bytes, awaited.bytes.data(), 0, nullptr, &done),
                       fmt::format("read {} bytes", bytes)))
            return;
        awaited.done = Event(done);
        clFlush(queue_.get());
        sinceFlush_ = 0;
    }
    awaited_.push_back(std::move(awaited));
}

void ClDevice::poll() {
    clFlush(queue_.get());
    sinceFlush_ = 0;
    dropUploads();
    harvest();
    // What a callback asks for waits for another poll().
    for (size_t left = awaited_.size(); left > 0 && stateOf(awaited_.front().done) <= CL_COMPLETE; --left) {
        const Awaited ready = std::move(awaited_.front());
        awaited_.pop_front();
        if (succeeded(std::min(stateOf(ready.done), CL_SUCCESS), "read results back")) ready.then(ready.bytes);
    }
}

// The block on the device. Kernels of a step mostly share theirs, so that it is written once. The queue is in order: a slot may be written
// anew behind the kernels that read it, once the host's copy is no longer read by an earlier write.
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
        cl_int code = CL_SUCCESS;
        slot.memory = Memory(clCreateBuffer(context_.get(), CL_MEM_READ_ONLY, paddedBytes(bytes.size()), nullptr, &code));
        if (!succeeded(code, "allocate a parameter block")) return nullptr;
    }
    slot.bytes.assign(bytes.begin(), bytes.end());
    cl_event written = nullptr;
    if (!succeeded(
            clEnqueueWriteBuffer(queue_.get(), slot.memory.get(), CL_FALSE, 0, bytes.size(), slot.bytes.data(), 0, nullptr, &written),
            "write a parameter block"))
        return nullptr;
    slot.written = Event(written);
    params_.push_back(std::move(slot));
    return params_.back().memory.get();
}

void ClDevice::dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) {
    ASSERT(kernel.index < kernels_.size(), "ask this device for the kernel before dispatching it");
    const Entry& entry = kernels_[kernel.index];
    ASSERT(entry.args == buffers.size() + 1, "hand a buffer for every row of the kernel's ARGS");
    ASSERT(!params.empty() && params.size() % 16 == 0, "a parameter block's size must be a multiple of 16");
    if (threads == 0) return;
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
    if (!succeeded(clEnqueueNDRangeKernel(queue_.get(), entry.kernel.get(), 1, nullptr, &global, &local, 0, nullptr, &done),
                   fmt::format("run {}", entry.path)))
        return;
    timed_.push_back({Event(done), kernel.index});
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

// Adds up what is done: the queue is in order, so that the first unfinished one ends the search.
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

// s of hostSeconds(). OpenCL 1.2 cannot ask for the device's time: a small write that is waited for ends about now.
double ClDevice::hostTime(cl_ulong at) {
    if (!ahead_) {
        ahead_ = 0;
        cl_int code = CL_SUCCESS;
        const Memory small(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, 16, nullptr, &code));
        const uint32_t word = 0;
        cl_event written = nullptr;
        if (small && clEnqueueWriteBuffer(queue_.get(), small.get(), CL_TRUE, 0, sizeof word, &word, 0, nullptr, &written) == CL_SUCCESS) {
            const double now = hostSeconds();
            const Event event(written);
            cl_ulong end = 0;
            if (clGetEventProfilingInfo(written, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr) == CL_SUCCESS)
                ahead_ = now - 1.0e-9 * static_cast<double>(end);
        }
    }
    return *ahead_ + 1.0e-9 * static_cast<double>(at);
}

std::vector<PassTime> ClDevice::takeTimes() {
    harvest();
    return std::exchange(times_, {});
}

}  // namespace

Result<std::unique_ptr<Device>> makeClDevice(const ShaderFiles& files, Log log) {
    size_t platforms = 0;
    const std::vector<Candidate> candidates = findDevices(platforms);
    if (platforms == 0)
        return failed(
            "this machine has no working OpenCL driver; install one (on Debian: apt-get install pocl-opencl-icd) or use --backend cpu");
    std::string why = "it lists no device";
    for (const Candidate& candidate : candidates) {
        const std::string name = deviceText(candidate.device, CL_DEVICE_NAME);
        if (!candidate.usable) {
            why = fmt::format("{} is not available, cannot compile, or is older than OpenCL 1.2", name);
            continue;
        }
        cl_int code = CL_SUCCESS;
        const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, reinterpret_cast<cl_context_properties>(candidate.platform), 0};
        Context context(clCreateContext(properties, 1, &candidate.device, nullptr, nullptr, &code));
        Queue queue(context ? clCreateCommandQueue(context.get(), candidate.device, CL_QUEUE_PROFILING_ENABLE, &code) : nullptr);
        if (queue)
            return std::unique_ptr<Device>(
                std::make_unique<ClDevice>(candidate, std::move(context), std::move(queue), files, std::move(log)));
        why = fmt::format("{} cannot be opened: {}", name, errorName(code));
    }
    return failed(fmt::format("OpenCL is installed but has no device to run on ({}); use --backend cpu", why));
}

std::vector<std::string> describeClDevices() {
    size_t platforms = 0;
    std::vector<std::string> sentences;
    for (const Candidate& c : findDevices(platforms))
        sentences.push_back(
            fmt::format("{} ({}, {} compute units, {} MiB, buffers up to {} MiB; {}; driver {}){}", deviceText(c.device, CL_DEVICE_NAME),
                        typeName(c.type), deviceValue<cl_uint>(c.device, CL_DEVICE_MAX_COMPUTE_UNITS),
                        deviceValue<cl_ulong>(c.device, CL_DEVICE_GLOBAL_MEM_SIZE) >> 20U,
                        deviceValue<cl_ulong>(c.device, CL_DEVICE_MAX_MEM_ALLOC_SIZE) >> 20U, platformText(c.platform, CL_PLATFORM_VERSION),
                        deviceText(c.device, CL_DRIVER_VERSION), c.usable ? "" : ", which cannot run kernels here"));
    return sentences;
}

}  // namespace rivulet
