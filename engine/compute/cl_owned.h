// Owners of OpenCL objects. Only for device_cl*.cpp and cl_*.cpp, as cl_devices.h.
#pragma once

#include <CL/cl.h>

#include <utility>

namespace rivulet::cl {

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
using Kernel = Owned<cl_kernel, clReleaseKernel>;
using Event = Owned<cl_event, clReleaseEvent>;
using Memory = Owned<cl_mem, clReleaseMemObject>;

// The state of an event: > 0 running, CL_COMPLETE (0) finished, < 0 failed.
inline cl_int stateOf(const Event& event) {
    cl_int state = CL_COMPLETE;
    if (event) clGetEventInfo(event.get(), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, nullptr);
    return state;
}

}  // namespace rivulet::cl
