#include "fluid/bridge/takeover.h"

#include <fmt/format.h>

#include "fluid/bridge/backend.h"

namespace rivulet {

Result<OpenedSession> openSession(const SceneFile& scene, Device& device, const Log& log) {
    OpenedSession opened;
    auto session = Session::create(scene, device, log);
    const bool fails = device.health().state != DeviceHealth::works || (!session && session.error().fault == Fault::failed);
    if (device.backend() != Backend::cl || !fails) {
        if (!session) return session.error();
        opened.session = std::move(*session);
        return opened;
    }
    const std::string why = session ? fmt::format("{} {}", device.info().name, device.health().why) : session.error().message;
    opened.instead = makeCpu();
    auto other = Session::create(scene, *opened.instead, log);
    if (!other) return other.error();
    opened.session = std::move(*other);
    log.notice(fmt::format("{}: the cpu simulates instead of OpenCL ({})", scene.name, why));
    return opened;
}

Result<bool> keepRunning(Session& session, std::unique_ptr<Device>& device, const Log& log) {
    const DeviceHealth health = device->health();
    if (health.state == DeviceHealth::works) return false;
    const double reached = session.world().time();
    std::unique_ptr<Device> cpu = makeCpu();
    if (Status moved = session.moveTo(*cpu); !moved) {
        session.hold(std::move(cpu));
        return Error{fmt::format("OpenCL on {} {}, and the cpu cannot go on: {}", device->info().name, health.why, moved.error().message),
                     moved.error().fault};
    }
    const double from = session.world().time();
    const std::string back = reached - from > 1.0e-9 ? fmt::format(", {:.3g} s back", reached - from) : std::string();
    log.notice(fmt::format("OpenCL on {} {}: the cpu goes on from {:.3f} s{}", device->info().name, health.why, from, back));
    device = std::move(cpu);
    return true;
}

}  // namespace rivulet
