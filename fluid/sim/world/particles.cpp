#include "fluid/sim/world/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "fluid/sim/sources/liquids.h"

namespace rivulet {

namespace {

// By id: first those of the fluid, then the samples. A row is that of a liquid, or names the body that a sample is on.
Status checkMatter(std::span<const vec4> matter, std::span<const vec4> samples) {
    const auto rows = static_cast<float>(liquids().rows.size());
    const size_t fluid = matter.size() - std::min(samples.size(), matter.size());
    for (size_t k = 0; k < matter.size(); ++k) {
        const vec4& m = matter[k];
        const bool finite = isFinite(vec3(m)) && std::isfinite(m.w);
        const bool ofFluid = finite && m.x > 0 && m.y > 0 && m.z >= 0 && m.w >= 0 && m.w <= rows && m.w == std::floor(m.w);
        if (k < fluid ? !ofFluid : !finite || m.w != samples[k - fluid].w)
            return badInput(
                fmt::format("the saved state gives particle {} a liquid or a body that this scene does not have: save it again", k));
    }
    return ok();
}

}  // namespace

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
        {&p.nearWalls, 4 * vector},
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

Result<Particles::Saved> Particles::take(WorldState& state, std::span<const vec4> samples) const {
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
        if (one >= count || seen[one]) return badInput("the saved state's particle ids are not unique: save it again");
        seen[one] = true;
    }
    if (Status sound = checkMatter(saved.matter, samples); !sound) return sound.error();
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
