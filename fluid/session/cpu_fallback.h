// Where an OpenCL device has no memory for a scene, or is lost while it runs, the cpu takes over.
#pragma once

#include <memory>
#include <string_view>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "fluid/session/session.h"

namespace rivulet {

struct OpenedSession {
    std::unique_ptr<Device> instead;  // the cpu that the session is on, where `device` failed; else null
    std::unique_ptr<Session> session;
};
// The scene on `device`, or on the cpu where that is of cl and cannot: the log says so. `asked`: as --backend. Where the cpu stands in for
// another backend, what it does not know of the scene (fluid.grid linked_list) becomes what it does, and the log says so. Error: as
// Session::create.
Result<OpenedSession> openSession(SceneFile scene, Device& device, const Log& log, std::string_view asked = "cpu",
                                  const OpeningSteps& steps = {});

// To be asked after each step. Where `device`, which the session is on, has failed, it becomes the cpu, and the session goes on there: the
// log says from which simulated time on. Whether that is so: session.world() is another then. Error: out of memory (failed); a recorded
// frame is damaged (badInput).
Result<bool> keepRunning(Session& session, std::unique_ptr<Device>& device, const Log& log);

// For figures, which another device must not finish. Error (failed): the device has failed, and what it has found means nothing.
Status stillWorks(const Device& device);

}  // namespace rivulet
