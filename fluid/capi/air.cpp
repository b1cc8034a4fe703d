// rivulet.h: skins and the drops in the air between them.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/skins.h"
#include "fluid/capi/versioned.h"

using namespace rivulet;
using namespace rivulet::capi;

namespace {

constexpr double kPicolitre = 1.0e-15;  // m^3

// Error (badInput): a skin is NULL, twice there or of another context.
Status checkSkins(const rivulet_world& world, std::span<rivulet_skin* const> skins) {
    for (size_t k = 0; k < skins.size(); ++k) {
        if (skins[k] == nullptr) return badInput(fmt::format("skins[{}] is NULL", k));
        if (skins[k]->context != world.context) return badInput(fmt::format("skins[{}] is of another context than the world", k));
        const auto here = skins.begin() + static_cast<std::ptrdiff_t>(k);
        if (std::find(skins.begin(), here, skins[k]) != here) return badInput(fmt::format("skins[{}] is there twice", k));
    }
    return ok();
}

// Drops in the air know their skin by its place in the list: they follow it to its new place, and are lost with a skin that is gone.
void follow(rivulet_world& world, std::span<rivulet_skin* const> skins) {
    std::vector<uint64_t> serials;
    serials.reserve(skins.size());
    for (const rivulet_skin* skin : skins) serials.push_back(skin->serial);
    if (serials == world.skins) return;
    std::vector<std::optional<uint32_t>> places;
    places.reserve(world.skins.size());
    for (const uint64_t serial : world.skins) {
        const auto at = std::find(serials.begin(), serials.end(), serial);
        places.push_back(at == serials.end() ? std::nullopt : std::optional(static_cast<uint32_t>(at - serials.begin())));
    }
    world.air.renumber(places);
    world.skins = std::move(serials);
}

// What all of them use.
Needs needsOfAll(const rivulet_skin_inputs* inputs, size_t count) {
    const auto* at = reinterpret_cast<const std::byte*>(inputs);
    for (size_t k = 0; inputs != nullptr && k < count; ++k) {
        const auto* one = reinterpret_cast<const rivulet_skin_inputs*>(at);
        if (needsOf(one) == Needs::drawing) return Needs::drawing;
        const Result<size_t> size = sizeOf(one, "rivulet_skin_inputs", "inputs");
        if (!size) break;  // reported by readInputs
        at += *size;
    }
    return Needs::device;
}

Result<std::vector<rivulet_skin_inputs>> readInputs(const rivulet_skin_inputs* inputs, size_t count) {
    std::vector<rivulet_skin_inputs> all(count);
    const auto* at = reinterpret_cast<const std::byte*>(inputs);
    for (size_t k = 0; inputs != nullptr && k < count; ++k) {
        const Result<rivulet_skin_inputs> one =
            readStruct(reinterpret_cast<const rivulet_skin_inputs*>(at), "rivulet_skin_inputs", fmt::format("inputs[{}]", k));
        if (!one) return one.error();
        all[k] = *one;
        at += one->size;
    }
    return all;
}

}  // namespace

rivulet_status rivulet_world_step_skins(rivulet_world* world, rivulet_skin* const* skins, const rivulet_skin_inputs* inputs, size_t count,
                                        double seconds, rivulet_air* air, rivulet_error* why) {
    return with(world, why, needsOfAll(inputs, count), [&]() -> Status {
        if (count == 0 || skins == nullptr) return badInput("skins is NULL or count is 0: give at least one skin");
        rivulet_air around{};
        if (air != nullptr) {
            const Result<rivulet_air> given = readStruct(air, "rivulet_air", "air");
            if (!given) return given.error();
            around = *given;
        }
        const std::span<rivulet_skin* const> all(skins, count);
        if (Status sound = checkSkins(*world, all); !sound) return sound;
        const Result<std::vector<rivulet_skin_inputs>> in = readInputs(inputs, count);
        if (!in) return in.error();
        for (size_t k = 0; k < count; ++k)
            if (Status sound = checkSkinStep(*all[k], (*in)[k], seconds); !sound) return sound;
        const vec3 gravity = around.gravity != nullptr ? vectorOf(around.gravity) : world->params.fluid.gravity;
        if (!isWithin(gravity, kMostGravity) || !isWithin(vec3(around.floor), kMostDistance))
            return badInput(fmt::format("air.gravity or air.floor is not finite, or beyond {} m/s^2 or {} m", kMostGravity, kMostDistance));
        if (seconds > 0) {
            follow(*world, all);
            std::vector<PlacedFlow*> placed;
            std::vector<vec3> winds;
            for (size_t k = 0; k < count; ++k) {
                all[k]->maps->leaveOutHanging(true);
                placeSkin(*all[k], (*in)[k], world->airTime, seconds);
                all[k]->placed->moveTo(world->airTime);
                placed.push_back(&*all[k]->placed);
                winds.push_back((*in)[k].wind != nullptr ? vectorOf((*in)[k].wind) : vec3(0.0F));
            }
            const AirDrops::Inputs to{.skins = placed,
                                      .world = world->exchanges ? world->world.get() : nullptr,
                                      .gravity = gravity,
                                      .winds = winds,
                                      .floor = double{around.floor},
                                      .time = world->airTime};
            if (Status fallen = world->air.step(to, seconds); !fallen) return fallen;
            world->airTime += seconds;
            for (size_t k = 0; k < count; ++k) {
                placed[k]->moveTo(world->airTime);
                if (Status stepped = stepSkin(*all[k], (*in)[k], gravity, seconds); !stepped) return stepped;
                const dmat4& toWorld = placed[k]->toWorld();
                for (const LeftDrop& d : all[k]->flow->takeLeft()) {
                    AirDrop drop{dvec3(toWorld * glm::dvec4(dvec3(d.position), 1)), glm::dmat3(toWorld) * dvec3(d.velocity), d.picolitres,
                                 static_cast<uint32_t>(k)};
                    if (d.hung) drop.hung = placed[k]->hung(*d.hung);
                    world->air.add(drop);
                }
            }
            world->fallingDrops = world->air.drawn();
            world->hangingDrops.clear();
            for (const PlacedFlow* skin : placed)
                for (const HungDrop& d : skin->hanging()) addPendant(d, vec3(0.0F), world->hangingDrops);
            for (const AirDrops::LetGo& d : world->air.letGo(placed)) addPendant(d.shape, vec3(0.0F), world->hangingDrops);
        }
        if (air == nullptr) return ok();
        const AirDrops::Counts counts = world->air.counts();
        around.drops = world->air.drops().size();
        around.in_air = kPicolitre * static_cast<double>(counts.air);
        around.lost = kPicolitre * static_cast<double>(counts.drained);
        around.into_water = kPicolitre * static_cast<double>(counts.poured);
        around.from_water = kPicolitre * static_cast<double>(counts.taken);
        return writeStruct(around, air, "rivulet_air", "air");
    });
}

rivulet_status rivulet_world_air_drops(const rivulet_world* world, float* drops, size_t capacity, size_t* count, rivulet_error* why) {
    return with(world, why, Needs::memory, [&]() -> Status {
        if (count == nullptr) return badInput("count is NULL: it receives the number of drops");
        const std::vector<AirDrop>& all = world->air.drops();
        const std::vector<vec4> claimed = world->air.claimed();
        *count = all.size() + claimed.size() / 2;
        for (size_t k = 0; drops != nullptr && k < std::min(capacity, all.size()); ++k) {
            put(vec3(all[k].position), drops + 4 * k);
            drops[4 * k + 3] = static_cast<float>(radiusOf(all[k]));
        }
        for (size_t k = all.size(); drops != nullptr && k < std::min(capacity, *count); ++k) {
            const vec4& ball = claimed[2 * (k - all.size())];
            put(vec3(ball), drops + 4 * k);
            drops[4 * k + 3] = ball.w;
        }
        return ok();
    });
}
