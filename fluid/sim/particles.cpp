#include "fluid/sim/particles.h"

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

}  // namespace rivulet
