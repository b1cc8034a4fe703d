#include "fluid/sim/world/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/state_check.h"

namespace rivulet {

namespace {

constexpr const char* kLost = "particles.lost";
std::string attributeSection(size_t k) { return fmt::format("particles.attribute{}", k); }
constexpr float kAnywhere = 1.0e12F;                      // m, m/s: bounds of values that every step computes anew
constexpr float kDenser = 1.0e6F, kMostViscous = 1.0e7F;  // ratio of two rest densities; Pa s: more than params allow

// By id: first those of the fluid, then the samples. A row is that of a liquid, or names the body that a sample is on.
Status checkMatter(std::span<const vec4> matter, std::span<const vec4> samples) {
    const auto rows = static_cast<float>(liquids().rows.size());
    const size_t fluid = matter.size() - std::min(samples.size(), matter.size());
    for (size_t k = 0; k < matter.size(); ++k) {
        const vec4& m = matter[k];
        // A sample of a body must have the values that this world gives it.
        const bool sound = k < fluid ? m.x == 1.0F && m.y >= 1.0F / kDenser && m.y <= kDenser && m.z >= 0 && m.z <= kMostViscous &&
                                           m.w >= 0 && m.w <= rows && m.w == std::floor(m.w)
                                     : std::abs(m.x - samples[k - fluid].x) <= 1.0e-3F * samples[k - fluid].x &&
                                           m.y == samples[k - fluid].y && m.z == samples[k - fluid].z && m.w == samples[k - fluid].w;
        if (!sound)
            return badInput(
                fmt::format("section particles.matter of the saved state gives particle {} a liquid or a body that this scene does "
                            "not have: save it again",
                            k));
    }
    return ok();
}

// Whether a position is roughly within the grid.
bool mayBeSorted(const vec4& position, const Bounds& inside) {
    return glm::all(glm::greaterThanEqual(vec3(position), inside.min)) && glm::all(glm::lessThanEqual(vec3(position), inside.max));
}

// Those of `lost` may have any values. Free slots and samples are somewhere.
Status checkMotion(const Particles::Saved& saved, const Bounds& inside, const std::vector<bool>& lost, size_t fluid) {
    for (size_t i = 0; i < saved.id.size(); ++i) {
        if (lost[saved.id[i]]) continue;
        const vec4 &x = saved.position[i], &v = saved.velocity[i];
        const bool particle = !(x.w < 0) && saved.id[i] < fluid;
        if (particle ? !mayBeSorted(x, inside) : !isWithin(vec3(x), kAnywhere))
            return badInput(
                fmt::format("section particles.position of the saved state has particle {} at ({}, {}, {}) m, outside the box: "
                            "save it again",
                            saved.id[i], x.x, x.y, x.z));
        if (!(x.w >= -1 && x.w <= kDensest)) return outOfRange("particles.position", 4 * i + 3, double{x.w}, -1, double{kDensest});
        if (!isWithin(vec3(v), particle ? kMostSpeed : kAnywhere) || !(std::abs(v.w) <= 1))
            return badInput(
                fmt::format("section particles.velocity of the saved state has particle {} with ({}, {}, {}) m/s and a mark of {}, "
                            "which is not possible: save it again",
                            saved.id[i], v.x, v.y, v.z, v.w));
    }
    return ok();
}

}  // namespace

Result<Particles> Particles::create(Device& device, uint32_t count, bool matter, bool absorption, size_t attributes) {
    Particles p;
    p.count = count;
    p.attributesOf.resize(attributes);
    p.attributes.resize(attributes);
    const size_t vector = size_t{count} * 16, scalar = size_t{count} * 4;
    std::vector<std::pair<Buffer*, size_t>> wanted = {
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
    for (std::vector<Buffer>* tables : {&p.attributesOf, &p.attributes})
        for (Buffer& table : *tables) wanted.emplace_back(&table, vector);
    for (auto [buffer, bytes] : wanted) {
        Result<Buffer> made = device.allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    return p;
}

void Particles::save(Device& device, WorldState& state, const Bounds& inside, uint32_t samples) const {
    const std::vector<vec4> position = device.readAll<vec4>(positionNext, count), velocity = device.readAll<vec4>(velocityNext, count);
    const std::vector<uint32_t> ids = device.readAll<uint32_t>(id, count);
    std::vector<uint32_t> lost;
    for (size_t i = 0; i < ids.size(); ++i) {
        const vec4 &x = position[i], &v = velocity[i];
        if (x.w < 0 || ids[i] >= count - samples) continue;
        if (!mayBeSorted(x, inside) || !(x.w <= kDensest) || !isWithin(vec3(v), kMostSpeed)) lost.push_back(ids[i]);
    }
    state.put<vec4>("particles.position", position);
    state.put<vec4>("particles.velocity", velocity);
    state.put<uint32_t>("particles.id", ids);
    if (!lost.empty()) state.put<uint32_t>(kLost, lost);
    if (matterOf.bytes() > 0) state.put<vec4>("particles.matter", device.readAll<vec4>(matterOf, count));
    if (absorptionOf.bytes() > 0) state.put<vec4>("particles.absorption", device.readAll<vec4>(absorptionOf, count));
    for (size_t k = 0; k < attributesOf.size(); ++k) state.put<vec4>(attributeSection(k), device.readAll<vec4>(attributesOf[k], count));
}

Result<Particles::Saved> Particles::take(WorldState& state, const Bounds& inside, std::span<const vec4> samples) const {
    Saved saved;
    std::vector<bool> lost(count);
    if (const auto section = state.sections().find(kLost); section != state.sections().end()) {
        Result<std::vector<uint32_t>> ids = state.take<uint32_t>(kLost, std::min<size_t>(section->second.size() / sizeof(uint32_t), count));
        if (!ids) return ids.error();
        for (size_t k = 0; k < ids->size(); ++k) {
            if ((*ids)[k] >= count) return outOfRange(kLost, k, static_cast<double>((*ids)[k]), 0, static_cast<double>(count) - 1);
            lost[(*ids)[k]] = true;
        }
    }
    for (auto [name, values] : {std::pair("particles.position", &saved.position), std::pair("particles.velocity", &saved.velocity),
                                std::pair("particles.matter", &saved.matter), std::pair("particles.absorption", &saved.absorption)}) {
        if (values == &saved.matter && matterOf.bytes() == 0) continue;
        if (values == &saved.absorption && absorptionOf.bytes() == 0) continue;
        Result<std::vector<vec4>> taken = state.take<vec4>(name, count);
        if (!taken) return taken.error();
        *values = std::move(*taken);
    }
    for (size_t k = 0; k < attributesOf.size() && state.sections().contains(attributeSection(k)); ++k) {
        Result<std::vector<vec4>> taken = state.take<vec4>(attributeSection(k), count);
        if (!taken) return taken.error();
        constexpr float kMost = std::numeric_limits<float>::max();
        if (Status sound = checkRange(attributeSection(k), *taken, kMost, -kMost, kMost); !sound) return sound.error();
        saved.attributes.push_back(std::move(*taken));
    }
    Result<std::vector<uint32_t>> ids = state.take<uint32_t>("particles.id", count);
    if (!ids) return ids.error();
    saved.id = std::move(*ids);
    std::vector<bool> seen(count);  // kernels write to where ids say
    for (const uint32_t one : saved.id) {
        if (one >= count || seen[one]) return badInput("section particles.id of the saved state has an id twice or none: save it again");
        seen[one] = true;
    }
    if (Status sound = checkMotion(saved, inside, lost, count - std::min<size_t>(samples.size(), count)); !sound) return sound.error();
    if (Status sound = checkMatter(saved.matter, samples); !sound) return sound.error();
    constexpr float kDarkest = 1.0e9F;  // 1/m
    if (Status sound = checkRange("particles.absorption", saved.absorption, kDarkest, -kDarkest, kDarkest); !sound) return sound.error();
    return saved;
}

void Particles::restore(Device& device, const Saved& saved) {
    device.writeAll<vec4>(positionNext, saved.position);
    device.writeAll<vec4>(velocityNext, saved.velocity);
    device.writeAll<uint32_t>(id, saved.id);
    if (matterOf.bytes() > 0) device.writeAll<vec4>(matterOf, saved.matter);
    if (absorptionOf.bytes() > 0) device.writeAll<vec4>(absorptionOf, saved.absorption);
    for (size_t k = 0; k < saved.attributes.size(); ++k) device.writeAll<vec4>(attributesOf[k], saved.attributes[k]);
}

}  // namespace rivulet
