// CPU fallback: if an OpenCL device is out of memory for a scene, or is lost during a run, the cpu simulates instead.
#pragma once

#include <memory>
#include <string_view>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "fluid/session/session.h"

namespace rivulet {

struct OpenedSession {
    std::unique_ptr<Device> instead;  // the cpu that the session runs on after `device` failed; else null
    std::unique_ptr<Session> session;
};
// Opens the scene on `device`; if that is of cl and fails, on the cpu, and the log reports it. `asked`: as --backend. Where the cpu
// replaces another backend, fluid.grid linked_list, which needs a GPU, becomes sorted, and the log reports it. Error: as Session::create.
Result<OpenedSession> openSession(SceneFile scene, Device& device, const Log& log, std::string_view asked = "cpu",
                                  const OpeningSteps& steps = {});

// Call after each step. If `device`, which the session runs on, has failed, it is replaced by the cpu and the session continues there; the
// log reports the simulated time it continues from. Returns whether that happened: session.world() is then another object. Error: out of
// memory (failed), as FluidWorld::lastStep on the cpu; a recorded frame is damaged (badInput).
Result<bool> keepRunning(Session& session, std::unique_ptr<Device>& device, const Log& log);

// For measurements, which must not continue on another device. Error: the device has failed and its results are invalid; out of memory
// (Error::memory), or lost (failed).
Status stillWorks(const Device& device);

}  // namespace rivulet
