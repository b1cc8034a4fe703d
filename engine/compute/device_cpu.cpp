#include "engine/compute/device_cpu.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <optional>

#include "engine/core/assert.h"
#include "engine/core/large_pages.h"
#include "engine/core/parallel.h"

namespace rivulet {

const char* isaName(Isa isa) {
    switch (isa) {
        case Isa::generic:
            return "generic";
        case Isa::avx2:
            return "avx2";
        case Isa::avx512:
            return "avx512";
    }
    return "generic";
}

namespace {

Isa machineIsa() {
#if defined(__x86_64__) && !defined(__MINGW32__)  // for which the others are not compiled: fluid/CMakeLists.txt
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2")) return Isa::generic;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw"))
        return Isa::avx512;
    return Isa::avx2;
#else
    return Isa::generic;
#endif
}

// What RIVULET_ISA names; empty: it is not set, or names none.
std::optional<Isa> wantedIsa() {
    const char* name = std::getenv("RIVULET_ISA");
    for (const Isa isa : {Isa::generic, Isa::avx2, Isa::avx512})
        if (name != nullptr && std::string_view(name) == isaName(isa)) return isa;
    return {};
}

}  // namespace

Isa bestIsa() { return std::min(machineIsa(), wantedIsa().value_or(Isa::avx512)); }

Status checkIsa() {
    const char* name = std::getenv("RIVULET_ISA");
    if (name == nullptr || *name == 0) return ok();
    const std::optional<Isa> wanted = wantedIsa();
    if (!wanted) return badInput("RIVULET_ISA in the environment must be generic, avx2 or avx512: set it to one of them, or unset it");
    if (*wanted > machineIsa())
        return badInput(fmt::format("RIVULET_ISA in the environment is {}, which this processor lacks: set it to {}, or unset it",
                                    isaName(*wanted), isaName(machineIsa())));
    return ok();
}

namespace {

std::string processorName() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);)
        if (line.rfind("model name", 0) == 0) {
            size_t colon = line.find(": ");
            if (colon != std::string::npos) return line.substr(colon + 2);
        }
    return "CPU";
}

std::string joined(std::vector<std::string> parts) {
    std::sort(parts.begin(), parts.end());
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ";") + part;
    return all;
}

std::string joinDefines(std::span<const Define> defines) {
    std::vector<std::string> parts;
    for (const Define& d : defines) parts.push_back(d.name + "=" + d.value);
    return joined(std::move(parts));
}

// "B=2;A=1;" as "A=1;B=2".
std::string inOrder(std::string_view defines) {
    std::vector<std::string> parts;
    while (!defines.empty()) {
        const size_t end = std::min(defines.find(';'), defines.size());
        if (end > 0) parts.emplace_back(defines.substr(0, end));
        defines.remove_prefix(std::min(end + 1, defines.size()));
    }
    return joined(std::move(parts));
}

// A cache line, and the widest vector.
constexpr size_t kAlignment = 64;
constexpr size_t kMostParams = 1024;  // bytes

// Memory from calloc, with what stands in front of the aligned address of a buffer.
struct Block {
    void* from = nullptr;
    size_t bytes = 0;
};
static_assert(alignof(std::max_align_t) >= sizeof(Block), "room for it before the aligned address");

uintptr_t placeIn(const Block& block) {
    const uintptr_t at = (reinterpret_cast<uintptr_t>(block.from) / kAlignment + 1) * kAlignment;
    std::memcpy(reinterpret_cast<std::byte*>(at) - sizeof block, &block, sizeof block);
    return at;
}

}  // namespace

struct CpuDevice::Impl {
    std::vector<CpuKernelRow> rows;
    std::vector<CpuKernelRow> kernels;  // those requested; Kernel::index is an index into it
    std::optional<Workers> own;
    Jobs jobs;
    HostMemory memory;
    std::vector<PassTime> times;
    std::vector<void*> bindings;
    std::multimap<size_t, void*> kept;  // released blocks by their bytes, see keepReleased

    // `bytes` zeros at the begin of a kept or a new block. Null: out of memory.
    Block take(size_t bytes) {
        // Not one of more than twice the size: a later request would have to be met by a new block.
        if (const auto found = kept.lower_bound(bytes); found != kept.end() && found->first <= 2 * bytes) {
            const Block block{found->second, found->first};
            kept.erase(found);
            std::memset(block.from, 0, bytes);
            return block;
        }
        if (memory.allocate != nullptr) {
            const Block block{memory.allocate(memory.user, bytes, kAlignment), bytes};
            if (block.from != nullptr) std::memset(block.from, 0, bytes);
            return block;
        }
        // calloc clears nothing that the system has just cleared: pages of large buffers are first touched by the kernels, on all cores.
        const Block block{std::calloc(1, bytes), bytes};
        if (block.from != nullptr) useLargePages(block.from, bytes);
        return block;
    }

    void giveBack(const Block& block) {
        if (memory.release != nullptr)
            memory.release(memory.user, block.from, block.bytes);
        else
            std::free(block.from);
    }

    PassTime& timeOf(std::string_view name) {
        for (PassTime& t : times)
            if (t.name == name) return t;
        return times.emplace_back(PassTime{std::string(name), 0, 0});
    }
};

std::unique_ptr<CpuDevice> makeCpuDevice(std::span<const CpuKernelRow> rows, const CpuOptions& options) {
    return std::make_unique<CpuDevice>(rows, options);
}

CpuDevice::CpuDevice(std::span<const CpuKernelRow> rows, const CpuOptions& options) : impl_(std::make_unique<Impl>()), isa_(options.isa) {
    impl_->rows.assign(rows.begin(), rows.end());
    ASSERT((options.memory.allocate == nullptr) == (options.memory.release == nullptr), "give both functions of HostMemory, or neither");
    impl_->memory = options.memory;
    impl_->jobs = options.jobs;
    if (options.jobs.run == nullptr)
        impl_->jobs = impl_->own.emplace(options.threads).jobs();
    else if (options.threads > 0)
        impl_->jobs.workers = std::min(options.threads, options.jobs.workers);
    info_.name = fmt::format("{}, {} thread{}, {}", processorName(), threads(), threads() == 1 ? "" : "s", isaName(isa_));
}

CpuDevice::~CpuDevice() {
    for (const auto& [bytes, block] : impl_->kept) impl_->giveBack({block, bytes});
}

int CpuDevice::threads() const {
    const JobsScope scope(jobs());
    return jobWorkers();
}

Jobs CpuDevice::jobs() const { return impl_->jobs.run != nullptr ? impl_->jobs : currentJobs(); }

Result<Kernel> CpuDevice::kernel(std::string_view path, std::span<const Define> defines) {
    std::string wanted = joinDefines(defines);
    // The best instruction set that the kernel was compiled for and that this device may use.
    const CpuKernelRow* best = nullptr;
    for (const CpuKernelRow& row : impl_->rows)
        if (path == row.path && wanted == inOrder(row.defines) && row.isa <= isa_ && (best == nullptr || row.isa > best->isa)) best = &row;
    if (best == nullptr)
        return failed(
            fmt::format("the kernel {} with defines '{}' was not compiled for the cpu: the \"// cpu\" line in shaders/{}.kernel "
                        "lists the forms that are",
                        path, wanted, path));
    for (uint32_t i = 0; i < impl_->kernels.size(); ++i)
        if (impl_->kernels[i].run == best->run) return Kernel{i};
    impl_->kernels.push_back(*best);
    return Kernel{static_cast<uint32_t>(impl_->kernels.size() - 1)};
}

std::vector<std::string> CpuDevice::kernels() const {
    std::vector<std::string> made;
    for (const CpuKernelRow& row : impl_->kernels)
        made.push_back(fmt::format("{}{}{}", row.path, *row.defines == '\0' ? "" : ";", row.defines));
    return made;
}

Result<Buffer> CpuDevice::allocate(size_t bytes) {
    if (Status allowed = checkLimit(bytes); !allowed) return allowed.error();
    // More than half of all addresses is a size that overflowed.
    const Block block =
        bytes > SIZE_MAX / 2 ? Block{} : impl_->take((std::max<size_t>(bytes, 1) + kAlignment - 1) / kAlignment * kAlignment + kAlignment);
    if (block.from == nullptr)
        return noMemory(fmt::format("out of memory: cannot allocate {} MiB; use fewer particles or coarser voxels", bytes >> 20U));
    bytesAllocated_ += bytes;
    return Buffer(*this, placeIn(block), bytes);
}

void CpuDevice::release(uint64_t handle, size_t bytes) {
    Block block;
    std::memcpy(&block, reinterpret_cast<const std::byte*>(static_cast<uintptr_t>(handle)) - sizeof block, sizeof block);
    bytesAllocated_ -= bytes;
    if (keepsReleased_) {
        try {
            impl_->kept.emplace(block.bytes, block.from);
            return;
        } catch (const std::bad_alloc&) {  // a destructor calls this
        }
    }
    impl_->giveBack(block);
}

void CpuDevice::write(Buffer& to, std::span<const std::byte> bytes, size_t offset) {
    ASSERT(offset + bytes.size() <= to.bytes(), "write inside the buffer");
    if (!bytes.empty()) std::memcpy(hostPointer<std::byte>(to) + offset, bytes.data(), bytes.size());
}

void CpuDevice::read(const Buffer& from, std::span<std::byte> bytes, size_t offset) {
    ASSERT(offset + bytes.size() <= from.bytes(), "read inside the buffer");
    if (!bytes.empty()) std::memcpy(bytes.data(), hostPointer<std::byte>(from) + offset, bytes.size());
}

void CpuDevice::fill(Buffer& to, uint32_t word) {
    uint32_t* words = hostPointer<uint32_t>(to);
    std::fill(words, words + to.bytes() / 4, word);
}

void CpuDevice::copy(const Buffer& from, Buffer& to, size_t bytes) {
    ASSERT(bytes <= from.bytes() && bytes <= to.bytes(), "copy inside both buffers");
    if (bytes > 0) std::memcpy(hostPointer<std::byte>(to), hostPointer<std::byte>(from), bytes);
}

void CpuDevice::readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) {
    ASSERT(offset <= from.bytes() && bytes <= from.bytes() - offset, "read inside the buffer");
    then(std::span(hostPointer<const std::byte>(from) + offset, bytes));
}

void CpuDevice::parallelFor(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
    if (count == 0 || skips()) return;
    if (count <= grain) {
        body(0, count);
        return;
    }
    const JobsScope scope(jobs());
    if (jobWorkers() == 1) {
        // One call, unless a stop may come in between.
        const size_t piece = stopFlag() != nullptr ? grain : count;
        for (size_t begin = 0; begin < count && !skips(); begin += piece) body(begin, std::min(begin + piece, count));
        return;
    }
    parallelParts(count, grain, [&](size_t begin, size_t end) {
        if (!skips()) body(begin, end);
    });
}

void CpuDevice::dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) {
    ASSERT(kernel.index < impl_->kernels.size(), "get the kernel from this device before dispatching it");
    if (threads == 0 || skips()) return;
    const double started = hostSeconds();
    const CpuKernelRow& row = impl_->kernels[kernel.index];
    impl_->bindings.clear();
    for (const Buffer* b : buffers) impl_->bindings.push_back(b != nullptr ? hostPointer<void>(*b) : nullptr);
    void* const* bindings = impl_->bindings.data();
    // Kernels read the block with aligned vector loads; the caller's struct need not be aligned.
    alignas(kAlignment) std::byte block[kMostParams];
    ASSERT(params.size() <= kMostParams, "keep a parameter block at 1 KiB or less: put larger data in a buffer");
    std::memcpy(block, params.data(), params.size());
    parallelFor(threads, row.grain,
                [&](size_t begin, size_t end) { row.run(static_cast<uint32_t>(begin), static_cast<uint32_t>(end), block, bindings); });
    const double done = hostSeconds();
    addTime(row.path, 1000 * (done - started));
    if (span_) span_({row.path, started, done});
}

void CpuDevice::addTime(std::string_view name, double ms) {
    PassTime& time = impl_->timeOf(name);
    time.ms += ms;
    ++time.calls;
}

std::vector<PassTime> CpuDevice::takeTimes() {
    std::vector<PassTime> taken = impl_->times;
    for (PassTime& t : impl_->times) t = PassTime{t.name, 0, 0};
    std::erase_if(taken, [](const PassTime& t) { return t.calls == 0; });
    return taken;
}

}  // namespace rivulet
