#include "engine/compute/cl_sharing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/assert.h"
#include "engine/core/extension_list.h"

namespace rivulet {

struct GlSharing::Impl {
    cl::Context context;
    cl::Queue queue;  // the Device's own: copies are in order with its kernels
    GlContext gl;
    ClGlCalls calls;
    bool ordered;  // cl_khr_gl_event: the driver orders both with the commands of the context that is current
};

namespace {

constexpr const char* kExtension = "cl_khr_gl_sharing";
constexpr const char* kOrders = "cl_khr_gl_event";
constexpr size_t kHandleBytes = sizeof(void*);  // of a cl_device_id

std::string extensionsOf(cl_device_id device) { return clDeviceText(device, CL_DEVICE_EXTENSIONS); }

cl_device_id deviceDriving(cl_platform_id platform, const cl_context_properties* properties) {
    const auto ask =
        reinterpret_cast<clGetGLContextInfoKHR_fn>(clGetExtensionFunctionAddressForPlatform(platform, "clGetGLContextInfoKHR"));
    cl_device_id device = nullptr;
    size_t size = 0;
    if (!ask || ask(properties, CL_CURRENT_DEVICE_FOR_GL_CONTEXT_KHR, kHandleBytes, static_cast<void*>(&device), &size) != CL_SUCCESS)
        return nullptr;
    return size == kHandleBytes ? device : nullptr;
}

cl_context contextOf(const cl_context_properties* properties, cl_device_id device, cl_int* code) {
    return clCreateContext(properties, 1, &device, nullptr, nullptr, code);
}

Error couldNot(const char* what, cl_int code) { return failed(fmt::format("OpenCL could not {}: {}", what, clErrorName(code))); }

GlSharing::Wrapped ownerOf(cl_mem memory) {
    return {memory, [](void* kept) { clReleaseMemObject(static_cast<cl_mem>(kept)); }};
}

// Waits for OpenGL, acquires the buffers, lets `work` enqueue its commands, releases the buffers and waits for OpenCL; where the driver
// orders them, nothing waits here: acquiring comes after OpenGL's commands so far, and its later ones come after the release.
template <class Work>
Status acquired(const GlSharing::Impl& with, std::span<const cl_mem> all, const Work& work) {
    const auto count = static_cast<cl_uint>(all.size());
    if (!with.ordered) with.gl.finish();
    if (const cl_int code = with.calls.acquire(with.queue.get(), count, all.data(), 0, nullptr, nullptr); code != CL_SUCCESS)
        return couldNot("acquire OpenGL's buffers", code);
    const Status worked = work();
    cl_event last = nullptr;
    if (const cl_int code = with.calls.release(with.queue.get(), count, all.data(), 0, nullptr, &last); code != CL_SUCCESS) {
        clFinish(with.queue.get());
        return couldNot("release OpenGL's buffers", code);
    }
    const cl::Event released(last);
    if (with.ordered) {
        clFlush(with.queue.get());
        return worked;
    }
    if (const cl_int code = clWaitForEvents(1, &last); code != CL_SUCCESS) return couldNot("release OpenGL's buffers", code);
    return worked;
}

// Data that differs from a cleared buffer and from the other turn.
std::vector<uint32_t> pattern(uint32_t turn, size_t words) {
    std::vector<uint32_t> made(words);
    for (size_t k = 0; k < words; ++k) made[k] = 0x9e3779b9U * (static_cast<uint32_t>(k) + 1) + turn;
    return made;
}

// Transfers data in both directions, twice: a driver that copies only when the buffer is wrapped would pass the first time.
Status proveWith(const GlSharing::Impl& with) {
    constexpr size_t kWords = 1024, kHalf = kWords / 2;
    constexpr size_t kBytes = kWords * sizeof(uint32_t), kHalfBytes = kHalf * sizeof(uint32_t);
    const struct Named {
        const GlContext& gl;
        unsigned name;
        ~Named() {
            if (name != 0) gl.destroy(name);
        }
    } buffer{with.gl, with.gl.create(kBytes)};
    if (buffer.name == 0) return failed("OpenGL has no memory for the test of sharing");
    cl_int code = CL_SUCCESS;
    const cl::Memory wrapped(with.calls.wrap(with.context.get(), CL_MEM_READ_WRITE, buffer.name, &code));
    if (!wrapped || code != CL_SUCCESS) return couldNot("wrap an OpenGL buffer", code);
    const cl::Memory own(clCreateBuffer(with.context.get(), CL_MEM_READ_WRITE, kBytes, nullptr, &code));
    if (!own) return couldNot("allocate memory for the test of sharing", code);
    for (uint32_t turn = 0; turn < 2; ++turn) {
        const std::vector<uint32_t> sent = pattern(2 * turn, kWords), answer = pattern(2 * turn + 1, kHalf);
        std::vector<uint32_t> there(kWords), back(kWords);
        with.gl.write(buffer.name, std::as_bytes(std::span(sent)));
        const cl_mem all[] = {wrapped.get()};
        const Status done = acquired(with, all, [&]() -> Status {
            const cl_command_queue queue = with.queue.get();
            cl_int result = clEnqueueReadBuffer(queue, wrapped.get(), CL_TRUE, 0, kBytes, there.data(), 0, nullptr, nullptr);
            if (result == CL_SUCCESS)
                result = clEnqueueWriteBuffer(queue, own.get(), CL_TRUE, 0, kHalfBytes, answer.data(), 0, nullptr, nullptr);
            if (result == CL_SUCCESS)
                result = clEnqueueCopyBuffer(queue, own.get(), wrapped.get(), 0, kHalfBytes, kHalfBytes, 0, nullptr, nullptr);
            return result == CL_SUCCESS ? ok() : couldNot("read or write an OpenGL buffer", result);
        });
        if (!done) return done;
        if (there != sent) return failed("OpenCL does not read what OpenGL wrote");
        std::vector<uint32_t> expected = sent;
        std::copy(answer.begin(), answer.end(), expected.begin() + kHalf);
        with.gl.read(buffer.name, std::as_writable_bytes(std::span(back)));
        if (back != expected) return failed("OpenGL does not read what OpenCL wrote");
    }
    return ok();
}

}  // namespace

ClGlCalls driversGlCalls() {
    return {extensionsOf, deviceDriving, contextOf, clCreateFromGLBuffer, clEnqueueAcquireGLObjects, clEnqueueReleaseGLObjects};
}

Result<cl::Context> makeSharedContext(const ClCandidate& chosen, const GlContext& gl, const ClGlCalls& calls) {
    if (!gl.context) return failed("no OpenGL context is current");
    if (!hasExtension(calls.extensions(chosen.device), kExtension))
        return failed(fmt::format("{} offers no {}", chosen.platformName, kExtension));
    const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                                reinterpret_cast<cl_context_properties>(chosen.platform),
                                                CL_GL_CONTEXT_KHR,
                                                reinterpret_cast<cl_context_properties>(gl.context),
                                                gl.egl ? CL_EGL_DISPLAY_KHR : CL_GLX_DISPLAY_KHR,
                                                reinterpret_cast<cl_context_properties>(gl.display),
                                                0};
    if (calls.driving(chosen.platform, properties) != chosen.device)
        return failed(fmt::format("{} does not drive the OpenGL context", chosen.name));
    cl_int code = CL_SUCCESS;
    cl::Context context(calls.createContext(properties, chosen.device, &code));
    if (!context || code != CL_SUCCESS) return couldNot("create a context that shares with OpenGL", code);
    return context;
}

Result<std::shared_ptr<const GlSharing>> proveSharing(cl_context context, cl_command_queue queue, const GlContext& gl,
                                                      const ClGlCalls& calls) {
    clRetainContext(context);
    clRetainCommandQueue(queue);
    cl_device_id device = nullptr;
    clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof(cl_device_id), static_cast<void*>(&device), nullptr);
    const bool ordered = hasExtension(calls.extensions(device), kOrders);
    auto impl = std::make_unique<GlSharing::Impl>(GlSharing::Impl{cl::Context(context), cl::Queue(queue), gl, calls, ordered});
    if (const Status proven = proveWith(*impl); !proven) return proven.error();
    return std::shared_ptr<const GlSharing>(std::make_shared<GlSharing>(std::move(impl)));
}

GlSharing::GlSharing(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GlSharing::~GlSharing() = default;

Result<GlSharing::Wrapped> GlSharing::wrap(unsigned buffer) const {
    cl_int code = CL_SUCCESS;
    const cl_mem memory = impl_->calls.wrap(impl_->context.get(), CL_MEM_READ_WRITE, buffer, &code);
    if (!memory || code != CL_SUCCESS) return couldNot("wrap an OpenGL buffer", code);
    return ownerOf(memory);
}

Status GlSharing::copy(std::span<const Copy> copies) const {
    std::vector<cl_mem> all;
    for (const Copy& c : copies)
        if (c.bytes > 0) all.push_back(static_cast<cl_mem>(c.to->get()));
    if (all.empty()) return ok();
    std::vector<cl::Event> done;
    const Status copied = acquired(*impl_, all, [&]() -> Status {
        for (const Copy& c : copies) {
            if (c.bytes == 0) continue;
            ASSERT(c.bytes <= c.from->bytes(), "copy what the buffer holds");
            const auto from = reinterpret_cast<cl_mem>(static_cast<uintptr_t>(c.from->handle()));
            cl_event event = nullptr;
            const cl_int code =
                clEnqueueCopyBuffer(impl_->queue.get(), from, static_cast<cl_mem>(c.to->get()), 0, 0, c.bytes, 0, nullptr, &event);
            if (code != CL_SUCCESS) return couldNot("copy into OpenGL's buffers", code);
            done.emplace_back(event);
        }
        return ok();
    });
    if (!copied) return copied;
    for (const cl::Event& event : done)
        if (const cl_int state = stateOf(event); state < CL_COMPLETE || (state > CL_COMPLETE && !impl_->ordered))
            return couldNot("copy into OpenGL's buffers", state);
    return ok();
}

}  // namespace rivulet
