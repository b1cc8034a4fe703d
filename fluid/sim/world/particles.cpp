#include "fluid/sim/world/particles.h"

#include <array>
#include <utility>

namespace rivulet {

Result<Particles> Particles::create(Device& device, uint32_t count, bool matter, bool absorption) {
    Particles p;
    p.count = count;
    const size_t vector = size_t{count} * 16, scalar = size_t{count} * 4;
    const std::pair<Buffer*, size_t> wanted[] = {
        {&p.position, vector},
        {&p.velocity, vector},
        {&p.positionNext, vector},
        {&p.velocityNext, vector},
        {&p.acceleration, vector},
        {&p.boundary, vector},
        {&p.id, scalar},
        {&p.idNext, scalar},
        {&p.density, scalar},
        {&p.pressure, scalar},
        {&p.matterOf, matter ? vector : 0},
        {&p.matter, matter ? vector : 0},
        {&p.absorptionOf, absorption ? vector : 0},
        {&p.absorption, absorption ? vector : 0},
    };
    for (auto [buffer, bytes] : wanted) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return p;
}

void Particles::save(Device& device, WorldState& state) const {
    state.put<vec4>("particles.position", device.readAll<vec4>(positionNext, count));
    state.put<vec4>("particles.velocity", device.readAll<vec4>(velocityNext, count));
    state.put<uint32_t>("particles.id", device.readAll<uint32_t>(id, count));
    if (matterOf.bytes() > 0) state.put<vec4>("particles.matter", device.readAll<vec4>(matterOf, count));
    if (absorptionOf.bytes() > 0) state.put<vec4>("particles.absorption", device.readAll<vec4>(absorptionOf, count));
}

Result<Particles::Saved> Particles::take(WorldState& state) const {
    Saved saved;
    for (auto [name, values] : {std::pair("particles.position", &saved.position), std::pair("particles.velocity", &saved.velocity),
                                std::pair("particles.matter", &saved.matter), std::pair("particles.absorption", &saved.absorption)}) {
        if (values == &saved.matter && matterOf.bytes() == 0) continue;
        if (values == &saved.absorption && absorptionOf.bytes() == 0) continue;
        Result<std::vector<vec4>> taken = state.take<vec4>(name, count);
        if (!taken) return taken.error();
        *values = std::move(*taken);
    }
    Result<std::vector<uint32_t>> ids = state.take<uint32_t>("particles.id", count);
    if (!ids) return ids.error();
    saved.id = std::move(*ids);
    std::vector<bool> seen(count);  // kernels write to where ids say
    for (const uint32_t one : saved.id) {
        if (one >= count || seen[one]) return badInput("the saved state's particles are not each there once: save it again");
        seen[one] = true;
    }
    return saved;
}

void Particles::restore(Device& device, const Saved& saved) {
    device.writeAll<vec4>(positionNext, saved.position);
    device.writeAll<vec4>(velocityNext, saved.velocity);
    device.writeAll<uint32_t>(id, saved.id);
    if (matterOf.bytes() > 0) device.writeAll<vec4>(matterOf, saved.matter);
    if (absorptionOf.bytes() > 0) device.writeAll<vec4>(absorptionOf, saved.absorption);
}

}  // namespace rivulet
