#include "fluid/sim/world/host_particles.h"

namespace rivulet {

HostParticles readParticles(const FluidWorld& world, bool pressures) {
    ParticleView view = world.particles();
    HostParticles host;
    if (view.count == 0) return host;
    Device& device = world.device();
    host.position = device.readAll<vec4>(*view.position, view.slots);
    host.velocity = device.readAll<vec4>(*view.velocity, view.slots);
    host.id = device.readAll<uint32_t>(*view.id, view.slots);
    if (pressures) {
        host.pressure = world.pressures();
        host.pressure.resize(view.slots);
    }
    for (const Buffer* attribute : view.attributes)
        if (attribute != nullptr) host.attributes.push_back(device.readAll<vec4>(*attribute, view.slots));
    // Free slots and samples on bodies are no particles.
    size_t kept = 0;
    for (size_t i = 0; i < host.id.size(); ++i) {
        if (host.position[i].w < 0) continue;
        host.position[kept] = host.position[i];
        host.velocity[kept] = host.velocity[i];
        if (pressures) host.pressure[kept] = host.pressure[i];
        for (std::vector<vec4>& attribute : host.attributes) attribute[kept] = attribute[i];
        host.id[kept++] = host.id[i];
    }
    host.position.resize(kept);
    host.velocity.resize(kept);
    host.id.resize(kept);
    for (std::vector<vec4>& attribute : host.attributes) attribute.resize(kept);
    if (pressures) host.pressure.resize(kept);
    host.mass.assign(kept, view.mass);
    if (view.matterOf != nullptr) {
        const std::vector<vec4> matter = device.readAll<vec4>(*view.matterOf, view.slots);
        for (size_t i = 0; i < kept; ++i) host.mass[i] = view.mass / matter[host.id[i]].y;
    }
    return host;
}

}  // namespace rivulet
