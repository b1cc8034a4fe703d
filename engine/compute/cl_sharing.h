// cl_khr_gl_sharing: OpenCL contexts that share buffers with OpenGL. For device_cl*.cpp and tests alone: it shows OpenCL's own types.
#pragma once

#include <CL/cl.h>
#include <CL/cl_gl.h>

#include <memory>
#include <string>

#include "engine/compute/cl_devices.h"
#include "engine/compute/cl_owned.h"
#include "engine/compute/gl_sharing.h"

namespace rivulet {

// What is asked of the driver. Tests hand in what lies.
struct ClGlCalls {
    std::string (*extensions)(cl_device_id device);
    // The device that drives the OpenGL context which the properties name; null: none.
    cl_device_id (*driving)(cl_platform_id platform, const cl_context_properties* properties);
    cl_context (*createContext)(const cl_context_properties* properties, cl_device_id device, cl_int* code);
    decltype(&clCreateFromGLBuffer) wrap;
    decltype(&clEnqueueAcquireGLObjects) acquire;
    decltype(&clEnqueueReleaseGLObjects) release;
};
// The driver's own. All but `extensions` only for a device that names cl_khr_gl_sharing: PoCL does not, and ends the process when called.
ClGlCalls driversGlCalls();

// A context in which `chosen` and `gl` see the same buffers, if the driver keeps its word. Error (failed), half a sentence: it has none.
Result<cl::Context> makeSharedContext(const ClCandidate& chosen, const GlContext& gl, const ClGlCalls& calls);

// Sharing in such a context, proven: what each of the two writes into a buffer of the other, the other reads. Error (failed), half a
// sentence: it is not so, and nothing may be shared.
Result<std::shared_ptr<const GlSharing>> proveSharing(cl_context context, cl_command_queue queue, const GlContext& gl,
                                                      const ClGlCalls& calls);

}  // namespace rivulet
