// cl_khr_gl_sharing: OpenCL contexts that share buffers with OpenGL. Only for device_cl*.cpp and tests, because it includes OpenCL.
#pragma once

#include <CL/cl.h>
#include <CL/cl_gl.h>

#include <memory>
#include <string>

#include "engine/compute/cl_devices.h"
#include "engine/compute/cl_owned.h"
#include "engine/compute/gl_sharing.h"

namespace rivulet {

// The driver functions that sharing uses. Tests replace them by functions that fail.
struct ClGlCalls {
    std::string (*extensions)(cl_device_id device);
    // The device that drives the OpenGL context in `properties`; null: none.
    cl_device_id (*driving)(cl_platform_id platform, const cl_context_properties* properties);
    cl_context (*createContext)(const cl_context_properties* properties, cl_device_id device, cl_int* code);
    decltype(&clCreateFromGLBuffer) wrap;
    decltype(&clEnqueueAcquireGLObjects) acquire;
    decltype(&clEnqueueReleaseGLObjects) release;
};
// The driver's functions. Except for `extensions`, call them only for a device with cl_khr_gl_sharing: PoCL has not, and its functions end
// the process.
ClGlCalls driversGlCalls();

// A context in which `chosen` and `gl` should share buffers; proveSharing() tests it. Error (failed): the driver creates none.
Result<cl::Context> makeSharedContext(const ClCandidate& chosen, const GlContext& gl, const ClGlCalls& calls);

// Tests sharing in such a context: each API must read from a shared buffer what the other has written. Error (failed): the test failed, and
// sharing must not be used.
Result<std::shared_ptr<const GlSharing>> proveSharing(cl_context context, cl_command_queue queue, const GlContext& gl,
                                                      const ClGlCalls& calls);

}  // namespace rivulet
