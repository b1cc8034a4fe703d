// OpenCL.
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include "tests/faults/interposer.h"

using namespace faults;

namespace {

template <class Handle>
Handle none(cl_int* code, cl_int why) {
    if (code != nullptr) *code = why;
    return nullptr;
}

}  // namespace

// A command that fails: with KIND:N+ the device is lost.
#define FAULTS_COMMAND(name, arguments, ...)                              \
    cl_int name arguments {                                               \
        if (fails(kClCommand, FAULTS_CALLER)) return CL_OUT_OF_RESOURCES; \
        return FAULTS_NEXT(name)(__VA_ARGS__);                            \
    }

extern "C" {

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void* host, cl_int* code) {
    if (fails(kClMemory, FAULTS_CALLER)) return none<cl_mem>(code, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    return FAULTS_NEXT(clCreateBuffer)(context, flags, bytes, host, code);
}
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void(CL_CALLBACK* then)(cl_program, void*), void* with) {
    if (fails(kClBuild, FAULTS_CALLER)) return CL_OUT_OF_HOST_MEMORY;
    return FAULTS_NEXT(clBuildProgram)(program, count, devices, options, then, with);
}
cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* code) {
    if (fails(kClBuild, FAULTS_CALLER)) return none<cl_kernel>(code, CL_OUT_OF_HOST_MEMORY);
    return FAULTS_NEXT(clCreateKernel)(program, name, code);
}
cl_context clCreateContext(const cl_context_properties* properties, cl_uint count, const cl_device_id* devices,
                           void(CL_CALLBACK* report)(const char*, const void*, size_t, void*), void* with, cl_int* code) {
    if (fails(kClOpen, FAULTS_CALLER)) return none<cl_context>(code, CL_OUT_OF_HOST_MEMORY);
    return FAULTS_NEXT(clCreateContext)(properties, count, devices, report, with, code);
}
cl_command_queue clCreateCommandQueue(cl_context context, cl_device_id device, cl_command_queue_properties properties, cl_int* code) {
    if (fails(kClOpen, FAULTS_CALLER)) return none<cl_command_queue>(code, CL_OUT_OF_HOST_MEMORY);
    return FAULTS_NEXT(clCreateCommandQueue)(context, device, properties, code);
}

FAULTS_COMMAND(clFinish, (cl_command_queue queue), queue)
FAULTS_COMMAND(clEnqueueNDRangeKernel,
               (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset, const size_t* global,
                const size_t* local, cl_uint events, const cl_event* before, cl_event* done),
               queue, kernel, dimensions, offset, global, local, events, before, done)
FAULTS_COMMAND(clEnqueueReadBuffer,
               (cl_command_queue queue, cl_mem from, cl_bool blocks, size_t offset, size_t bytes, void* to, cl_uint events,
                const cl_event* before, cl_event* done),
               queue, from, blocks, offset, bytes, to, events, before, done)
FAULTS_COMMAND(clEnqueueWriteBuffer,
               (cl_command_queue queue, cl_mem to, cl_bool blocks, size_t offset, size_t bytes, const void* from, cl_uint events,
                const cl_event* before, cl_event* done),
               queue, to, blocks, offset, bytes, from, events, before, done)
FAULTS_COMMAND(clEnqueueFillBuffer,
               (cl_command_queue queue, cl_mem to, const void* pattern, size_t patternBytes, size_t offset, size_t bytes, cl_uint events,
                const cl_event* before, cl_event* done),
               queue, to, pattern, patternBytes, offset, bytes, events, before, done)
FAULTS_COMMAND(clEnqueueCopyBuffer,
               (cl_command_queue queue, cl_mem from, cl_mem to, size_t fromOffset, size_t toOffset, size_t bytes, cl_uint events,
                const cl_event* before, cl_event* done),
               queue, from, to, fromOffset, toOffset, bytes, events, before, done)

}  // extern "C"
