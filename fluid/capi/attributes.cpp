// rivulet.h: volumes, attributes of particles, and particles where the cpu has them.
#include <fmt/format.h>

#include <span>
#include <vector>

#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/versioned.h"

namespace rivulet::capi {

Result<Volume> volumeOf(const rivulet_volume& v, const std::string& name) {
    if (v.shape != RIVULET_BOX && v.shape != RIVULET_SPHERE)
        return badInput(fmt::format("{}.shape is {}: use RIVULET_BOX or RIVULET_SPHERE", name, static_cast<int>(v.shape)));
    return Volume{.id = v.id,
                  .shape = v.shape == RIVULET_BOX ? Volume::box : Volume::sphere,
                  .position = vectorOf(v.position),
                  .size = vectorOf(v.size),
                  .radius = v.radius};
}

}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_world_set_attribute(rivulet_world* world, uint32_t attribute, const uint32_t* ids, const float* values, size_t count,
                                           rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (count > 0 && (ids == nullptr || values == nullptr)) return badInput("ids or values is NULL, and count is not 0");
        std::vector<vec4> all;
        all.reserve(count);
        for (size_t k = 0; k < count; ++k) all.emplace_back(values[4 * k], values[4 * k + 1], values[4 * k + 2], values[4 * k + 3]);
        return world->world->setAttribute(attribute, std::span(ids, count), all);
    });
}

rivulet_status rivulet_world_paint(rivulet_world* world, uint32_t attribute, const rivulet_volume* volume, const float* value,
                                   rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        if (volume == nullptr || value == nullptr) return badInput("volume or value is NULL");
        const Result<Volume> inside = volumeOf(*volume, "volume");
        if (!inside) return inside.error();
        return world->world->paint(attribute, *inside, vec4(value[0], value[1], value[2], value[3]));
    });
}

rivulet_status rivulet_world_rows(const rivulet_world* world, rivulet_rows* rows, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (world->world->device().backend() != Backend::cpu)
            return badInput("the particles are in the memory of a GPU: copy them with rivulet_world_particles, or use backend cpu");
        const auto memory = [](const Buffer* buffer) {
            return buffer == nullptr ? nullptr : reinterpret_cast<const void*>(buffer->handle());
        };
        const ParticleView view = world->world->particles();
        rivulet_rows full{.size = 0,
                          .count = view.count == 0 ? 0 : view.slots,
                          .positions = static_cast<const float*>(memory(view.position)),
                          .velocities = static_cast<const float*>(memory(view.velocity)),
                          .ids = static_cast<const uint32_t*>(memory(view.id)),
                          .attributes = {}};
        for (size_t k = 0; k < view.attributes.size(); ++k) full.attributes[k] = static_cast<const float*>(memory(view.attributes[k]));
        return writeStruct(full, rows, "rivulet_rows", "rows");
    });
}
