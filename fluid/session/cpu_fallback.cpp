#include "fluid/session/cpu_fallback.h"

#include <fmt/format.h>

#include "fluid/render/backend.h"

namespace rivulet {

namespace {

// Replaces values that the cpu does not support. Returns the end of a notice about it; "": nothing changed.
const char* fitToCpu(FluidParams& fluid) {
    if (fluid.grid != "linked_list") return "";
    fluid.grid = "sorted";
    return "; fluid.grid is sorted there, because linked_list needs the atomics of a GPU";
}

}  // namespace

Result<OpenedSession> openSession(SceneFile scene, Device& device, const Log& log, std::string_view asked, const OpeningSteps& steps) {
    OpenedSession opened;
    const bool replaces = device.backend() == Backend::cpu && asked != "cpu";
    const char* changed = replaces ? fitToCpu(scene.fluid) : "";
    auto session = Session::create(scene, device, log, steps);
    const bool fails = device.health().state != DeviceHealth::works || (!session && session.error().fault == Fault::failed);
    if (device.backend() != Backend::cl || !fails) {
        if (!session) return session.error();
        opened.session = std::move(*session);
        if (*changed != '\0') log.notice(fmt::format("{}: the cpu simulates{}", scene.name, changed));
        return opened;
    }
    const std::string why = session ? fmt::format("{} {}", device.info().name, device.health().why) : session.error().message;
    changed = fitToCpu(scene.fluid);
    opened.instead = makeCpu();
    opened.instead->stopOn(device.stopFlag());
    auto other = Session::create(scene, *opened.instead, log, steps);
    if (!other) {
        device.forgiveFull();  // other sessions on it continue
        return other.error();
    }
    opened.session = std::move(*other);
    log.notice(fmt::format("{}: the cpu simulates instead of OpenCL ({}){}", scene.name, why, changed));
    return opened;
}

Result<bool> keepRunning(Session& session, std::unique_ptr<Device>& device, const Log& log) {
    if (!session.replayed()) return session.replayed().error();
    const DeviceHealth health = device->health();
    if (health.state == DeviceHealth::works) {
        if (Status stepped = session.world().lastStep(); !stepped)
            return Error{fmt::format("{} cannot go on from {:.3f} s: {}", session.scene().name, session.time(), stepped.error().message),
                         stepped.error().fault};
        return false;
    }
    if (device->backend() == Backend::gl)
        return failed(fmt::format("{} cannot go on from {:.3f} s: OpenGL on {} {}; run it again, or use --backend cpu",
                                  session.scene().name, session.time(), device->info().name, health.why));
    const double reached = session.world().time();
    FluidParams before = session.scene().fluid;
    std::unique_ptr<Device> cpu = makeCpu();
    cpu->stopOn(device->stopFlag());
    if (Status moved = session.moveTo(*cpu); !moved) {
        session.hold(std::move(cpu));
        return Error{
            fmt::format("OpenCL on {} {}, and the cpu cannot continue: {}", device->info().name, health.why, moved.error().message),
            moved.error().fault};
    }
    const double from = session.world().time();
    const std::string back = reached - from > 1.0e-9 ? fmt::format(", {:.3g} s earlier", reached - from) : std::string();
    log.notice(
        fmt::format("OpenCL on {} {}: the cpu continues from {:.3f} s{}{}", device->info().name, health.why, from, back, fitToCpu(before)));
    device = std::move(cpu);
    return true;
}

Status stillWorks(const Device& device) {
    const DeviceHealth health = device.health();
    if (health.state == DeviceHealth::works) return ok();
    std::string why = fmt::format("{} on {} {}: its results are invalid; use another backend, or fewer particles",
                                  device.backend() == Backend::gl ? "OpenGL" : "OpenCL", device.info().name, health.why);
    return health.state == DeviceHealth::full ? noMemory(std::move(why)) : failed(std::move(why));
}

}  // namespace rivulet
