#include "engine/gpu/device_gl.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <utility>

#include "engine/core/assert.h"
#include "engine/gpu/buffer.h"
#include "engine/gpu/fence.h"
#include "engine/gpu/gl_error.h"
#include "engine/gpu/program.h"
#include "engine/gpu/timer.h"

namespace rivulet {
namespace {

constexpr size_t kBlockPage = size_t{64} << 10U;  // bytes per page, at least
// NVIDIA's driver 580 lets glNamedBufferSubData overtake dispatches that still read the buffer, whatever the barriers. So what is written
// is copied by the GPU, in order, in parts of this size.
constexpr size_t kWritePage = size_t{4} << 20U;
constexpr size_t kFreePages = 3;        // kept for later
constexpr size_t kHarvestAbove = 1024;  // timed dispatches above which times are collected without takeTimes()

// Makes the results of a dispatch visible to every use of a Buffer, in kernels and in drawing.
constexpr GLbitfield kReaders = GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT | GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT |
                                GL_TEXTURE_FETCH_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT | GL_UNIFORM_BARRIER_BIT |
                                GL_COMMAND_BARRIER_BIT;

using gpu::Fence;

GLint64 deviceLimit(GLenum which) {
    GLint64 value = 0;
    glGetInteger64v(which, &value);
    return value;
}
std::string text(GLenum which) {
    const auto* value = reinterpret_cast<const char*>(glGetString(which));
    return value ? value : "";
}
GLuint nameOf(const Buffer& buffer) { return static_cast<GLuint>(buffer.handle()); }
size_t roundedUp(size_t value, size_t step) { return (value + step - 1) / step * step; }

class GlDevice final : public Device {
  public:
    GlDevice(const ShaderFiles& files, Log log, const GlOptions& options);
    ~GlDevice() override = default;
    Backend backend() const override { return Backend::gl; }
    const DeviceInfo& info() const override { return info_; }
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
    void contextChanged() {
        timer_.contextChanged();
        times_.clear();
    }

  private:
    struct Entry {
        std::string key;  // path and defines
        std::string path;
        gpu::Program program;
        uint32_t localSize;
        size_t bindings = 0;   // SSBO bindings that the compiled kernel uses: those below this number
        GLint groupBase = -1;  // location of lang.h's groupBase_; -1: the kernel does not use THREAD_ID
        size_t passed = 0;     // buffers passed by the last dispatch; 0: there was none
        void link();           // finds bindings and groupBase
    };
    // Parameter blocks, or data for write(), put down one after the other by the host. A page is reused when the GPU has finished with all
    // of it.
    struct Page {
        gpu::Buffer buffer;
        size_t used = 0;
        Fence done;
    };
    struct PendingRead {
        gpu::Buffer staging;
        size_t bytes = 0;
        Fence copied;
        std::function<void(std::span<const std::byte>)> then;
    };

    bool bindParams(std::span<const std::byte> bytes);
    Status roomIn(std::deque<Page>& pages, size_t bytes);  // in the last page, which is a new one if need be
    gpu::Buffer stagingFor(size_t bytes);
    void harvest();
    bool isLost();                     // asks OpenGL, and updates health_
    void lose(std::string_view what);  // for want of memory: results after it are invalid

    ShaderFiles files_;
    Log log_;
    DeviceInfo info_;
    uint32_t localSize_;
    size_t maxLocalSize_, maxBindings_, maxGroups_, blockAlignment_;
    std::vector<Entry> kernels_;
    std::deque<Page> pages_, writes_;  // the oldest first; the last is being written
    std::vector<std::byte> lastBlock_;
    size_t lastBlockAt_ = 0;
    std::deque<PendingRead> pendingReads_;
    std::vector<gpu::Buffer> staging_;  // free
    gpu::Timer timer_;
    std::vector<PassTime> times_;
    size_t bytesAllocated_ = 0;
};

size_t deviceLimit(GLenum which, size_t most) { return std::min(static_cast<size_t>(deviceLimit(which)), most); }

GlDevice::GlDevice(const ShaderFiles& files, Log log, const GlOptions& options)
    : files_(files),
      log_(std::move(log)),
      localSize_(options.localSize),
      maxLocalSize_(deviceLimit(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, SIZE_MAX)),
      maxBindings_(
          deviceLimit(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, deviceLimit(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, options.mostBindings))),
      blockAlignment_(std::max<size_t>(static_cast<size_t>(deviceLimit(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT)), 16)) {
    GLint groups = 0;
    glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
    maxGroups_ = std::min(static_cast<size_t>(std::max(groups, 65535)), options.mostGroups);
    info_.name = text(GL_RENDERER);
    info_.driver = text(GL_VERSION);
    info_.software = isSoftwareRenderer(info_.name);
    info_.maxBufferBytes = deviceLimit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, options.mostBufferBytes);
}

void GlDevice::lose(std::string_view what) {
    if (!isLost()) health_ = {DeviceHealth::lost, fmt::format("has no memory left to {}", what)};
}

bool GlDevice::isLost() {
    if (health_.state != DeviceHealth::lost && gpu::contextLost())
        health_ = {DeviceHealth::lost, "lost its OpenGL context: the driver was restarted, or the GPU was removed"};
    return health_.state == DeviceHealth::lost;
}

// SSBO bindings that the compiled kernel uses are below this number.
size_t bindingsOf(GLuint name) {
    GLint blocks = 0;
    glGetProgramInterfaceiv(name, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &blocks);
    GLint bindings = 0;
    for (GLint k = 0; k < blocks; ++k) {
        const GLenum property = GL_BUFFER_BINDING;
        GLint binding = 0;
        glGetProgramResourceiv(name, GL_SHADER_STORAGE_BLOCK, static_cast<GLuint>(k), 1, &property, 1, nullptr, &binding);
        bindings = std::max(bindings, binding + 1);
    }
    return static_cast<size_t>(bindings);
}

Result<Kernel> GlDevice::kernel(std::string_view path, std::span<const Define> defines) {
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
        localSize = localSize_;
        sorted.push_back({"LOCAL_SIZE", std::to_string(localSize)});
    }
    const std::string file = fmt::format("shaders/{}.kernel", path);
    if (localSize > maxLocalSize_)
        return failed(fmt::format("{} needs work groups of {} threads, but {} allows {}; try --backend cpu", file, localSize, info_.name,
                                  maxLocalSize_));
    Result<gpu::Program> program = gpu::Program::create(files_, {file}, sorted);
    if (!program) return program.error();
    if (const size_t needed = bindingsOf(program->name()); needed > maxBindings_)
        return failed(
            fmt::format("{} needs {} storage buffers, but {} allows {}; try --backend cpu", file, needed, info_.name, maxBindings_));
    kernels_.push_back({std::move(key), std::string(path), std::move(*program), localSize});
    kernels_.back().link();
    return Kernel{static_cast<uint32_t>(kernels_.size() - 1)};
}

void GlDevice::Entry::link() {
    bindings = bindingsOf(program.name());
    groupBase = glGetUniformLocation(program.name(), "groupBase_");
}

Result<size_t> GlDevice::reload() {
    std::vector<gpu::Program*> programs;
    for (Entry& e : kernels_) programs.push_back(&e.program);
    const Result<size_t> changed = gpu::Program::reload(programs, [this](size_t k, GLuint name) {
        const Entry& e = kernels_[k];
        const size_t wanted = bindingsOf(name);
        if (e.passed == 0 || wanted <= e.passed) return ok();
        return Status(failed(fmt::format("shaders/{}.kernel now reads {} buffers, but the program passes {}; rebuild the program", e.path,
                                         wanted, e.passed)));
    });
    if (!changed) return changed.error();
    for (Entry& e : kernels_) e.link();
    return changed;
}

Result<Buffer> GlDevice::allocate(size_t bytes) {
    if (Status allowed = checkLimit(bytes); !allowed) return allowed.error();
    if (bytes > info_.maxBufferBytes)
        return noMemory(fmt::format(
            "a buffer of {} bytes ({:.1f} MiB) is needed, but {} allows {} bytes ({:.1f} MiB); use fewer particles or coarser voxels",
            bytes, static_cast<double>(bytes) / 1048576.0, info_.name, info_.maxBufferBytes,
            static_cast<double>(info_.maxBufferBytes) / 1048576.0));
    Result<gpu::Buffer> buffer = gpu::Buffer::create(bytes);
    if (!buffer && isLost()) return failed(fmt::format("{} {}", info_.name, health_.why));
    if (!buffer)
        return noMemory(
            fmt::format("{} ({:.1f} MiB are in use)", buffer.error().message, static_cast<double>(bytesAllocated_) / 1048576.0));
    bytesAllocated_ += bytes;
    return Buffer(*this, buffer->release(), bytes);
}

void GlDevice::release(uint64_t handle, size_t bytes) {
    const gpu::BufferName ends(static_cast<GLuint>(handle));
    bytesAllocated_ -= bytes;
}

void GlDevice::write(Buffer& to, std::span<const std::byte> bytes, size_t offset) {
    ASSERT(offset <= to.bytes() && bytes.size() <= to.bytes() - offset, "write inside the buffer");
    if (bytes.empty() || lost()) return;
    for (size_t done = 0; done < bytes.size();) {
        const std::span<const std::byte> part = bytes.subspan(done, std::min(kWritePage, bytes.size() - done));
        const auto at = static_cast<GLintptr>(offset + done), size = static_cast<GLsizeiptr>(part.size());
        if (roomIn(writes_, part.size())) {
            Page& page = writes_.back();
            std::memcpy(page.buffer.mapped().data() + page.used, part.data(), part.size());
            glCopyNamedBufferSubData(page.buffer.name(), nameOf(to), static_cast<GLintptr>(page.used), at, size);
            page.used += roundedUp(part.size(), 16);
        } else {  // no memory for a page
            glFinish();
            glNamedBufferSubData(nameOf(to), at, size, part.data());
        }
        done += part.size();
    }
}

void GlDevice::read(const Buffer& from, std::span<std::byte> bytes, size_t offset) {
    ASSERT(offset <= from.bytes() && bytes.size() <= from.bytes() - offset, "read inside the buffer");
    if (bytes.empty()) return;
    glGetNamedBufferSubData(nameOf(from), static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes.size()), bytes.data());
    if (isLost()) std::ranges::fill(bytes, std::byte{0});
}

void GlDevice::fill(Buffer& to, uint32_t word) {
    if (to.bytes() == 0 || lost()) return;
    glClearNamedBufferData(nameOf(to), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

void GlDevice::copy(const Buffer& from, Buffer& to, size_t bytes) {
    ASSERT(bytes <= from.bytes() && bytes <= to.bytes(), "copy inside both buffers");
    ASSERT(from.handle() != to.handle(), "copy from one buffer to another");
    if (bytes == 0 || lost()) return;
    glCopyNamedBufferSubData(nameOf(from), nameOf(to), 0, 0, static_cast<GLsizeiptr>(bytes));
}

// A free staging buffer of at least this size, or a new one: the number of buffers grows instead of waiting for the GPU.
gpu::Buffer GlDevice::stagingFor(size_t bytes) {
    const auto fits = std::find_if(staging_.begin(), staging_.end(), [&](const gpu::Buffer& b) { return b.bytes() >= bytes; });
    if (fits != staging_.end()) {
        gpu::Buffer found = std::move(*fits);
        staging_.erase(fits);
        return found;
    }
    Result<gpu::Buffer> made = gpu::Buffer::create(roundedUp(std::max<size_t>(bytes, 1), 4096), gpu::BufferKind::mapped);
    if (made) return std::move(*made);
    lose("read results back");
    return {};
}

void GlDevice::readLater(const Buffer& from, size_t bytes, std::function<void(std::span<const std::byte>)> then, size_t offset) {
    ASSERT(offset <= from.bytes() && bytes <= from.bytes() - offset, "read inside the buffer");
    PendingRead pending{stagingFor(bytes), bytes, {}, std::move(then)};
    if (!pending.staging) return;
    if (bytes > 0)
        glCopyNamedBufferSubData(nameOf(from), pending.staging.name(), static_cast<GLintptr>(offset), 0, static_cast<GLsizeiptr>(bytes));
    pending.copied = Fence::now();
    pendingReads_.push_back(std::move(pending));
}

void GlDevice::poll() {
    if (isLost()) pendingReads_.clear();  // nothing was copied
    // A frame's steps begin with poll(): they may write buffers that a host's own shaders have read.
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    // Reads that a callback starts are left to the next poll().
    for (size_t left = pendingReads_.size(); left > 0 && pendingReads_.front().copied.passed(); --left) {
        PendingRead ready = std::move(pendingReads_.front());
        pendingReads_.pop_front();
        ready.then(ready.staging.mapped().first(ready.bytes));
        staging_.push_back(std::move(ready.staging));
    }
    harvest();
}

Status GlDevice::roomIn(std::deque<Page>& pages, size_t bytes) {
    if (!pages.empty() && pages.back().used + bytes <= pages.back().buffer.bytes()) return ok();
    if (!pages.empty()) pages.back().done = Fence::now();
    Page page;
    const auto free = std::ranges::find_if(pages, [&](const Page& p) { return p.buffer.bytes() >= bytes && p.done.passed(); });
    if (free != pages.end()) {
        page = std::move(*free);
        pages.erase(free);
        page.used = 0;
        page.done = {};
    } else {
        Result<gpu::Buffer> made = gpu::Buffer::create(std::max(kBlockPage, bytes), gpu::BufferKind::mapped);
        if (!made) return made.error();
        page.buffer = std::move(*made);
    }
    pages.push_back(std::move(page));
    while (pages.size() > kFreePages && pages.front().done.passed()) pages.pop_front();
    return ok();
}

// Most kernels of a step have the same parameter block, which is written once.
bool GlDevice::bindParams(std::span<const std::byte> bytes) {
    const bool same = lastBlock_.size() == bytes.size() && std::memcmp(lastBlock_.data(), bytes.data(), bytes.size()) == 0;
    if (!same) {
        lastBlock_.clear();
        if (Status room = roomIn(pages_, bytes.size()); !room) {
            lose("run a kernel");
            return false;
        }
        Page& page = pages_.back();
        std::memcpy(page.buffer.mapped().data() + page.used, bytes.data(), bytes.size());
        lastBlock_.assign(bytes.begin(), bytes.end());
        lastBlockAt_ = page.used;
        page.used += roundedUp(bytes.size(), blockAlignment_);
    }
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, pages_.back().buffer.name(), static_cast<GLintptr>(lastBlockAt_),
                      static_cast<GLsizeiptr>(bytes.size()));
    return true;
}

void GlDevice::dispatch(Kernel kernel, std::span<const std::byte> params, std::span<const Buffer* const> buffers, uint32_t threads) {
    ASSERT(kernel.index < kernels_.size(), "get the kernel from this device before dispatching it");
    Entry& entry = kernels_[kernel.index];
    ASSERT(entry.bindings <= buffers.size(), "pass a buffer for every row of the kernel's ARGS");
    ASSERT(!params.empty() && params.size() % 16 == 0, "a parameter block's size must be a multiple of 16");
    entry.passed = buffers.size();
    if (threads == 0 || skips() || lost() || !bindParams(params)) return;
    for (size_t k = 0; k < buffers.size(); ++k)
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, static_cast<GLuint>(k), buffers[k] ? nameOf(*buffers[k]) : 0);
    if (timer_.pending() > kHarvestAbove) harvest();
    entry.program.use();
    timer_.begin(kernel.index);
    const size_t groups = (static_cast<size_t>(threads) + entry.localSize - 1) / entry.localSize;
    for (size_t base = 0; base < groups; base += maxGroups_) {  // one iteration, except for millions of threads
        if (groups > maxGroups_) glProgramUniform1ui(entry.program.name(), entry.groupBase, static_cast<GLuint>(base));
        glDispatchCompute(static_cast<GLuint>(std::min(maxGroups_, groups - base)), 1, 1);
    }
    if (groups > maxGroups_) glProgramUniform1ui(entry.program.name(), entry.groupBase, 0);
    glMemoryBarrier(kReaders);
    timer_.end();
}

void GlDevice::finish() {
    // zink of Mesa 22.3: where nothing was issued since the last flush, which passed() does, glFinish() returns too early.
    if (!pendingReads_.empty()) pendingReads_.back().copied.wait();
    glFinish();
    (void)isLost();
    harvest();
}

void GlDevice::harvest() {
    timer_.collect([&](uint64_t index, const gpu::Timer::Times& times) {
        const std::string& path = kernels_[index].path;
        auto time = std::find_if(times_.begin(), times_.end(), [&](const PassTime& t) { return t.name == path; });
        if (time == times_.end()) time = times_.insert(times_.end(), PassTime{path, 0, 0});
        time->ms += times.ms();
        ++time->calls;
        if (span_) span_({path, times.begin, times.end});
    });
}

std::vector<PassTime> GlDevice::takeTimes() {
    harvest();
    return std::exchange(times_, {});
}

}  // namespace

std::unique_ptr<Device> makeGlDevice(const ShaderFiles& files, Log log, const GlOptions& options) {
    return std::make_unique<GlDevice>(files, std::move(log), options);
}

void contextChanged(Device& gl) {
    ASSERT(gl.backend() == Backend::gl, "ask backend() first");
    static_cast<GlDevice&>(gl).contextChanged();
}

bool isSoftwareRenderer(std::string_view renderer) {
    for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"})
        if (renderer.find(name) != std::string_view::npos) return true;
    return false;
}

}  // namespace rivulet
