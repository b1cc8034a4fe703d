#include "tests/unit/cl_waits.h"

#ifdef RIVULET_HAS_OPENCL

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>

#include <mutex>

namespace {

std::mutex counting;  // a scene may be loaded by another thread meanwhile
std::map<std::string, size_t> waits;

void count(const char* name) {
    const std::lock_guard lock(counting);
    ++waits[name];
}

template <class F>
F* next(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

cl_int clFinish(cl_command_queue queue) {
    static auto* const driver = next<decltype(clFinish)>("clFinish");
    count("clFinish");
    return driver(queue);
}

cl_int clWaitForEvents(cl_uint number, const cl_event* events) {
    static auto* const driver = next<decltype(clWaitForEvents)>("clWaitForEvents");
    count("clWaitForEvents");
    return driver(number, events);
}

cl_int clEnqueueReadBuffer(cl_command_queue queue, cl_mem from, cl_bool blocks, size_t offset, size_t bytes, void* to, cl_uint number,
                           const cl_event* events, cl_event* done) {
    static auto* const driver = next<decltype(clEnqueueReadBuffer)>("clEnqueueReadBuffer");
    if (blocks != CL_FALSE) count("clEnqueueReadBuffer");
    return driver(queue, from, blocks, offset, bytes, to, number, events, done);
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem to, cl_bool blocks, size_t offset, size_t bytes, const void* from,
                            cl_uint number, const cl_event* events, cl_event* done) {
    static auto* const driver = next<decltype(clEnqueueWriteBuffer)>("clEnqueueWriteBuffer");
    if (blocks != CL_FALSE) count("clEnqueueWriteBuffer");
    return driver(queue, to, blocks, offset, bytes, from, number, events, done);
}

void* clEnqueueMapBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocks, cl_map_flags flags, size_t offset, size_t bytes,
                         cl_uint number, const cl_event* events, cl_event* done, cl_int* code) {
    static auto* const driver = next<decltype(clEnqueueMapBuffer)>("clEnqueueMapBuffer");
    if (blocks != CL_FALSE) count("clEnqueueMapBuffer");
    return driver(queue, memory, blocks, flags, offset, bytes, number, events, done, code);
}

}  // extern "C"

namespace rivulet::testing {

void startClWaits() {
    const std::lock_guard lock(counting);
    waits.clear();
}

std::map<std::string, size_t> clWaits() {
    const std::lock_guard lock(counting);
    return waits;
}

}  // namespace rivulet::testing

#else

namespace rivulet::testing {

void startClWaits() {}
std::map<std::string, size_t> clWaits() { return {}; }

}  // namespace rivulet::testing

#endif
