// An OpenCL driver for tests: PoCL with cl_khr_gl_sharing added, so that the path of drivers of GPUs runs where no GPU is. It transfers
// contents through the host, and is strict: the side that does not own a buffer sees kPoison in it, OpenGL gets the contents when OpenCL's
// event of the release is waited for, and a use that the extension does not allow, by a kernel, copy, read, write or fill, ends the process
// with a sentence. OCL_ICD_VENDORS names a file that names this library; POCL_ICD is the file that names PoCL's,
// /etc/OpenCL/vendors/pocl.icd by default.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl_icd.h>
#include <EGL/egl.h>
#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace {

constexpr unsigned char kPoison = 0xA5;

[[noreturn]] void fail(const char* why) {
    std::fprintf(stderr, "sharing_icd: %s\n", why);
    std::abort();
}
void require(bool holds, const char* otherwise) {
    if (!holds) fail(otherwise);
}

// OpenGL's functions, of the context that is current.
template <class... A>
void gl(const char* name, A... arguments) {
    const auto call = reinterpret_cast<void (*)(A...)>(eglGetProcAddress(name));
    require(call != nullptr, name);
    call(arguments...);
}
bool isBuffer(unsigned name) { return reinterpret_cast<unsigned char (*)(unsigned)>(eglGetProcAddress("glIsBuffer"))(name) != 0; }
void contextIsCurrent() { require(eglGetCurrentContext() != EGL_NO_CONTEXT, "no OpenGL context is current on this thread"); }

using Bytes = std::vector<unsigned char>;
Bytes fromGl(unsigned buffer, size_t size) {
    Bytes bytes(size);
    gl("glGetNamedBufferSubData", buffer, intptr_t{0}, static_cast<intptr_t>(size), static_cast<void*>(bytes.data()));
    return bytes;
}
void toGl(unsigned buffer, const Bytes& bytes) {
    gl("glNamedBufferSubData", buffer, intptr_t{0}, static_cast<intptr_t>(bytes.size()), static_cast<const void*>(bytes.data()));
}

struct Shared {
    unsigned buffer;
    size_t size;
    bool acquired = false;
};
struct Transfer {  // to OpenGL, of a release that nobody has waited for
    cl_event done;
    unsigned buffer;
    Bytes bytes;
};
cl_icd_dispatch pocl;  // its functions as they were
std::mutex access;     // of the two maps: PoCL reports the end of an object on a thread of its own
std::map<cl_mem, Shared> shared;
std::map<cl_kernel, std::map<cl_uint, cl_mem>> arguments;  // buffers that kernels were given
std::vector<Transfer*> transfers;

Shared* find(cl_mem memory) {
    const std::scoped_lock lock(access);
    const auto found = shared.find(memory);
    return found == shared.end() ? nullptr : &found->second;  // only the end of that object moves it
}

void transferWhatIsDone() {
    std::erase_if(transfers, [](Transfer* transfer) {
        cl_int state = CL_QUEUED;
        pocl.clGetEventInfo(transfer->done, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, nullptr);
        if (state != CL_COMPLETE) return false;
        contextIsCurrent();
        if (isBuffer(transfer->buffer)) toGl(transfer->buffer, transfer->bytes);
        pocl.clReleaseEvent(transfer->done);
        delete transfer;
        return true;
    });
}

void owned(cl_mem memory) {
    const Shared* found = find(memory);
    require(found == nullptr || found->acquired, "a command uses a buffer of OpenGL that is not acquired");
}

void poison(cl_command_queue queue, cl_mem memory, size_t size) {
    pocl.clEnqueueFillBuffer(queue, memory, &kPoison, 1, 0, size, 0, nullptr, nullptr);
}

// RIVULET_SHARING=ordered: with cl_khr_gl_event. A release is then complete before OpenGL's next command, without a wait of the program.
bool ordersItself() {
    const char* mode = std::getenv("RIVULET_SHARING");
    return mode != nullptr && std::string_view(mode) == "ordered";
}

cl_int CL_API_CALL getDeviceInfo(cl_device_id device, cl_device_info what, size_t size, void* value, size_t* needed) {
    if (what != CL_DEVICE_EXTENSIONS) return pocl.clGetDeviceInfo(device, what, size, value, needed);
    size_t own = 0;
    pocl.clGetDeviceInfo(device, what, 0, nullptr, &own);
    std::string text(own, '\0');
    pocl.clGetDeviceInfo(device, what, own, text.data(), nullptr);
    text = std::string(text.c_str()) + " cl_khr_gl_sharing" + (ordersItself() ? " cl_khr_gl_event" : "");
    if (needed != nullptr) *needed = text.size() + 1;
    if (value == nullptr) return CL_SUCCESS;
    if (size <= text.size()) return CL_INVALID_VALUE;
    std::memcpy(value, text.c_str(), text.size() + 1);
    return CL_SUCCESS;
}

// Properties without those of OpenGL, which must name the context that is current, if they name one.
std::vector<cl_context_properties> withoutGl(const cl_context_properties* properties, bool& named) {
    std::vector<cl_context_properties> left;
    named = false;
    for (; properties != nullptr && *properties != 0; properties += 2) {
        if (*properties == CL_GL_CONTEXT_KHR) {
            named = true;
            require(reinterpret_cast<EGLContext>(properties[1]) == eglGetCurrentContext(), "CL_GL_CONTEXT_KHR is not the current context");
        } else if (*properties == CL_EGL_DISPLAY_KHR) {
            require(reinterpret_cast<EGLDisplay>(properties[1]) == eglGetCurrentDisplay(), "CL_EGL_DISPLAY_KHR is not the current display");
        } else {
            left.insert(left.end(), properties, properties + 2);
        }
    }
    left.push_back(0);
    return left;
}

cl_context CL_API_CALL createContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* devices,
                                     void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*), void* user, cl_int* code) {
    bool named = false;
    const std::vector<cl_context_properties> left = withoutGl(properties, named);
    return pocl.clCreateContext(left.data(), count, devices, notify, user, code);
}

cl_int CL_API_CALL getGlContextInfo(const cl_context_properties* properties, cl_gl_context_info, size_t size, void* value, size_t* needed) {
    bool named = false;
    const std::vector<cl_context_properties> left = withoutGl(properties, named);
    if (!named) return CL_INVALID_GL_SHAREGROUP_REFERENCE_KHR;
    const auto platform = std::find(left.begin(), left.end(), CL_CONTEXT_PLATFORM);
    require(platform != left.end(), "the properties name no platform");
    cl_device_id device = nullptr;
    pocl.clGetDeviceIDs(reinterpret_cast<cl_platform_id>(platform[1]), CL_DEVICE_TYPE_ALL, 1, &device, nullptr);
    if (needed != nullptr) *needed = sizeof(void*);
    if (value != nullptr && size >= sizeof(void*)) std::memcpy(value, static_cast<const void*>(&device), sizeof(void*));
    return CL_SUCCESS;
}

void CL_CALLBACK gone(cl_mem memory, void*) {
    const std::scoped_lock lock(access);
    const Shared& ends = shared.at(memory);
    require(!ends.acquired, "a buffer is released while it is acquired");
    if (eglGetCurrentContext() != EGL_NO_CONTEXT) require(isBuffer(ends.buffer), "OpenGL's buffer was deleted before OpenCL's object");
    shared.erase(memory);
}

cl_mem CL_API_CALL wrap(cl_context context, cl_mem_flags flags, cl_GLuint buffer, cl_int* code) {
    contextIsCurrent();
    require(isBuffer(buffer), "clCreateFromGLBuffer of what is no buffer of OpenGL");
    int64_t size = 0;
    gl("glGetNamedBufferParameteri64v", static_cast<unsigned>(buffer), 0x8764U /* GL_BUFFER_SIZE */, &size);
    const Bytes bytes(static_cast<size_t>(size), kPoison);
    cl_mem memory =
        pocl.clCreateBuffer(context, flags | CL_MEM_COPY_HOST_PTR, bytes.size(), const_cast<unsigned char*>(bytes.data()), code);
    if (memory == nullptr) return nullptr;
    {
        const std::scoped_lock lock(access);
        shared[memory] = {buffer, bytes.size()};
    }
    pocl.clSetMemObjectDestructorCallback(memory, gone, nullptr);
    return memory;
}

cl_int CL_API_CALL acquire(cl_command_queue queue, cl_uint count, const cl_mem* all, cl_uint, const cl_event*, cl_event* done) {
    contextIsCurrent();
    for (cl_uint k = 0; k < count; ++k) {
        Shared* found = find(all[k]);
        if (found == nullptr) return CL_INVALID_GL_OBJECT;
        require(!found->acquired, "a buffer is acquired twice");
        found->acquired = true;
        const Bytes bytes = fromGl(found->buffer, found->size);
        pocl.clEnqueueWriteBuffer(queue, all[k], CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, nullptr);
        toGl(found->buffer, Bytes(bytes.size(), kPoison));
    }
    return done != nullptr ? pocl.clEnqueueMarkerWithWaitList(queue, 0, nullptr, done) : CL_SUCCESS;
}

cl_int CL_API_CALL release(cl_command_queue queue, cl_uint count, const cl_mem* all, cl_uint, const cl_event*, cl_event* done) {
    for (cl_uint k = 0; k < count; ++k) {
        Shared* found = find(all[k]);
        if (found == nullptr) return CL_INVALID_GL_OBJECT;
        require(found->acquired, "a buffer is released that is not acquired");
        found->acquired = false;
        auto* transfer = new Transfer{nullptr, found->buffer, Bytes(found->size)};
        pocl.clEnqueueReadBuffer(queue, all[k], CL_FALSE, 0, transfer->bytes.size(), transfer->bytes.data(), 0, nullptr, &transfer->done);
        poison(queue, all[k], found->size);
        transfers.push_back(transfer);
    }
    if (ordersItself()) {
        pocl.clFinish(queue);
        transferWhatIsDone();
    }
    return done != nullptr ? pocl.clEnqueueMarkerWithWaitList(queue, 0, nullptr, done) : CL_SUCCESS;
}

cl_int CL_API_CALL waitForEvents(cl_uint count, const cl_event* events) {
    require(!ordersItself(), "the program waits for events, although the driver orders the commands itself");
    const cl_int code = pocl.clWaitForEvents(count, events);
    transferWhatIsDone();
    return code;
}

cl_int CL_API_CALL copyBuffer(cl_command_queue queue, cl_mem from, cl_mem to, size_t at, size_t there, size_t size, cl_uint count,
                              const cl_event* events, cl_event* done) {
    owned(from);
    owned(to);
    return pocl.clEnqueueCopyBuffer(queue, from, to, at, there, size, count, events, done);
}

cl_int CL_API_CALL readBuffer(cl_command_queue queue, cl_mem from, cl_bool blocking, size_t at, size_t size, void* to, cl_uint count,
                              const cl_event* events, cl_event* done) {
    owned(from);
    return pocl.clEnqueueReadBuffer(queue, from, blocking, at, size, to, count, events, done);
}

cl_int CL_API_CALL writeBuffer(cl_command_queue queue, cl_mem to, cl_bool blocking, size_t at, size_t size, const void* from, cl_uint count,
                               const cl_event* events, cl_event* done) {
    owned(to);
    return pocl.clEnqueueWriteBuffer(queue, to, blocking, at, size, from, count, events, done);
}

cl_int CL_API_CALL fillBuffer(cl_command_queue queue, cl_mem to, const void* pattern, size_t patternSize, size_t at, size_t size,
                              cl_uint count, const cl_event* events, cl_event* done) {
    owned(to);
    return pocl.clEnqueueFillBuffer(queue, to, pattern, patternSize, at, size, count, events, done);
}

cl_int CL_API_CALL setKernelArgument(cl_kernel kernel, cl_uint index, size_t size, const void* value) {
    cl_mem memory = nullptr;
    if (size == sizeof memory && value != nullptr) std::memcpy(static_cast<void*>(&memory), value, size);
    const bool ofGl = memory != nullptr && find(memory) != nullptr;
    const std::scoped_lock lock(access);
    arguments[kernel].erase(index);
    if (ofGl) arguments[kernel][index] = memory;
    return pocl.clSetKernelArg(kernel, index, size, value);
}

cl_int CL_API_CALL runKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset, const size_t* global,
                             const size_t* local, cl_uint count, const cl_event* events, cl_event* done) {
    std::map<cl_uint, cl_mem> given;
    {
        const std::scoped_lock lock(access);
        given = arguments[kernel];
    }
    for (const auto& [index, memory] : given) owned(memory);
    return pocl.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, count, events, done);
}

void* CL_API_CALL extensionFunction(cl_platform_id platform, const char* name) {
    if (std::string_view(name) == "clGetGLContextInfoKHR") return reinterpret_cast<void*>(getGlContextInfo);
    return pocl.clGetExtensionFunctionAddressForPlatform(platform, name);
}

// All of PoCL's objects point to one table of functions: it is changed in place.
void change(cl_icd_dispatch& table) {
    if (pocl.clCreateContext != nullptr) return;
    pocl = table;
    const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
    const uintptr_t first = reinterpret_cast<uintptr_t>(&table) / page * page, last = reinterpret_cast<uintptr_t>(&table + 1);
    require(mprotect(reinterpret_cast<void*>(first), last - first, PROT_READ | PROT_WRITE) == 0, "PoCL's functions cannot be replaced");
    table.clGetDeviceInfo = getDeviceInfo;
    table.clCreateContext = createContext;
    table.clGetGLContextInfoKHR = getGlContextInfo;
    table.clGetExtensionFunctionAddressForPlatform = extensionFunction;
    table.clCreateFromGLBuffer = wrap;
    table.clEnqueueAcquireGLObjects = acquire;
    table.clEnqueueReleaseGLObjects = release;
    table.clWaitForEvents = waitForEvents;
    table.clEnqueueCopyBuffer = copyBuffer;
    table.clEnqueueReadBuffer = readBuffer;
    table.clEnqueueWriteBuffer = writeBuffer;
    table.clEnqueueFillBuffer = fillBuffer;
    table.clSetKernelArg = setKernelArgument;
    table.clEnqueueNDRangeKernel = runKernel;
}

void* poclFunction(const char* name) {
    static void* const library = [] {
        const char* list = std::getenv("POCL_ICD");
        std::ifstream file(list != nullptr ? list : "/etc/OpenCL/vendors/pocl.icd");
        std::string path;
        std::getline(file, path);
        void* opened = path.empty() ? nullptr : dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        require(opened != nullptr, "PoCL is not installed");
        return opened;
    }();
    const auto find = reinterpret_cast<void* (*)(const char*)>(dlsym(library, "clGetExtensionFunctionAddress"));
    require(find != nullptr, "PoCL is no driver for the ICD loader");
    return find(name);
}

}  // namespace

extern "C" {

__attribute__((visibility("default"))) cl_int CL_API_CALL clIcdGetPlatformIDsKHR(cl_uint count, cl_platform_id* platforms, cl_uint* found) {
    const auto ask = reinterpret_cast<decltype(&clIcdGetPlatformIDsKHR)>(poclFunction("clIcdGetPlatformIDsKHR"));
    const cl_int code = ask(count, platforms, found);
    if (code == CL_SUCCESS && platforms != nullptr && count > 0) change(**reinterpret_cast<cl_icd_dispatch**>(platforms[0]));
    return code;
}

__attribute__((visibility("default"))) void* CL_API_CALL clGetExtensionFunctionAddress(const char* name) {
    if (std::string_view(name) == "clIcdGetPlatformIDsKHR") return reinterpret_cast<void*>(clIcdGetPlatformIDsKHR);
    return poclFunction(name);
}
}
