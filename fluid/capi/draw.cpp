// rivulet.h: drawing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "fluid/capi/call.h"
#include "fluid/capi/convert.h"
#include "fluid/capi/drawing.h"
#include "fluid/capi/versioned.h"
#include "fluid/render/renderers.h"

namespace rivulet::capi {

Status drawable(const rivulet_context& context) {
    if (context.water) return stillThere(context, Needs::drawing);
    return badInput("the context has no OpenGL: set rivulet_context_options.find");
}

namespace {

// Values are checked by WaterRenderer::draw.
Status setLighting(const rivulet_lighting* lighting, WaterDraw& draw) {
    const Result<rivulet_lighting> l = readStruct(lighting, "rivulet_lighting", "view.lighting");
    if (!l) return l.error();
    if (l->lights == nullptr && l->lights_count > 0)
        return badInput(fmt::format("lighting.lights is NULL, and lights_count is {}", l->lights_count));
    if (l->lights_count > kMostHostLights)
        return badInput(fmt::format("lighting.lights_count is {}: give {} at most, the brightest", l->lights_count, kMostHostLights));
    draw.lights.reserve(l->lights_count);
    for (size_t k = 0; k < l->lights_count; ++k) {
        const rivulet_light& light = l->lights[k];
        if (!areWithin(light.direction, kBrightest) || !areWithin(light.colour, kBrightest))
            return badInput(fmt::format("lights[{}]: the direction or the colour is not finite, or beyond {}", k, kBrightest));
        draw.lights.push_back({vectorOf(light.direction), vectorOf(light.colour)});
    }
    const Result<rivulet_shadow> shadow = readStruct(l->shadow, "rivulet_shadow", "lighting.shadow");
    if (!shadow) return shadow.error();
    if (l->shadow != nullptr) {
        if (shadow->texture == 0 || shadow->projection == nullptr)
            return badInput("lighting.shadow has no texture or no projection: give both, or set lighting.shadow to NULL");
        draw.shadow = {.texture = shadow->texture,
                       .projection = matrixOf(shadow->projection),
                       .zeroToOne = shadow->zero_to_one != 0,
                       .reversed = shadow->reversed != 0,
                       .bias = shadow->bias};
    }
    const Result<rivulet_fog> fog = readStruct(l->fog, "rivulet_fog", "lighting.fog");
    if (!fog) return fog.error();
    if (fog->kind < RIVULET_NO_FOG || fog->kind > RIVULET_LINEAR_FOG)
        return badInput(fmt::format("lighting.fog.kind is {}: use a rivulet_fog_kind, 0 to 3", fog->kind));
    draw.fog = {.kind = static_cast<HostFog::Kind>(fog->kind),
                .colour = vectorOf(fog->colour),
                .density = fog->density,
                .start = fog->start,
                .end = fog->end,
                .alongView = fog->along_view != 0,
                .display = fog->display != 0};
    return ok();
}

}  // namespace

Result<WaterDraw> waterDraw(const FluidLookParams& params, const std::string& liquid, const rivulet_view* view,
                            const rivulet_target* target) {
    const Result<rivulet_view> viewing = readStruct(view, "rivulet_view", "view");
    if (!viewing) return viewing.error();
    const Result<rivulet_target> drawing = readStruct(target, "rivulet_target", "target");
    if (!drawing) return drawing.error();
    const rivulet_view& v = *viewing;
    const rivulet_target& t = *drawing;
    if (t.colours < RIVULET_AUTOMATIC || t.colours > RIVULET_SRGB)
        return badInput(fmt::format("target.colours is {}: use RIVULET_AUTOMATIC, RIVULET_LINEAR or RIVULET_SRGB", t.colours));
    if (v.view == nullptr || v.projection == nullptr) return badInput("view.view or view.projection is NULL: 16 floats each");
    if (!areWithin({v.view, 16}, kMostDistance) || !areWithin({v.projection, 16}, kMostDistance))
        return badInput(fmt::format("view.view or view.projection is not finite, or beyond {}", kMostDistance));
    if (!areWithin(v.light_direction, kBrightest) || !areWithin(v.light_colour, kBrightest))
        return badInput(fmt::format("view.light_direction or view.light_colour is not finite, or beyond {}", kBrightest));
    Result<FluidLook> look = fluidLookOf(params, liquid);
    if (!look) return look.error();
    WaterDraw draw{.view = {}, .look = *look, .target = {}, .row = renderers().find(params.renderer)};
    FrameView& frame = draw.view;
    frame.view = matrixOf(v.view);
    frame.projection = matrixOf(v.projection);
    frame.nearPlane = v.near_plane;
    frame.farPlane = v.far_plane;
    if (v.units_per_metre != 0) frame.unitsPerMetre = v.units_per_metre;
    frame.width = t.width;
    frame.height = t.height;
    if (isSet(v.light_direction)) frame.lightDirWorld = vectorOf(v.light_direction);
    frame.lightColour = isSet(v.light_colour) ? vectorOf(v.light_colour) : vec3(1.0F);
    draw.target = {.framebuffer = t.framebuffer,
                   .x = t.x,
                   .y = t.y,
                   .width = t.width,
                   .height = t.height,
                   .colours = static_cast<HostTarget::Colours>(t.colours)};
    if (Status lit = setLighting(v.lighting, draw); !lit) return lit.error();
    const Result<rivulet_renderer> own = readStruct(v.renderer, "rivulet_renderer", "view.renderer");
    if (!own) return own.error();
    if (v.renderer != nullptr) {
        Result<HostRenderer> renderer = HostRenderer::of(*own, *draw.row);
        if (!renderer) return renderer.error();
        draw.renderer = std::move(*renderer);
    }
    return draw;
}

Status drawWater(WaterRenderer& water, const gpu::HostState& scope, const FluidView& fluid, WaterDraw& draw) {
    if (!draw.renderer) return water.draw(scope, draw.view, fluid, draw.look, draw.target, draw.row, draw.lighting());
    const RendererRow row = draw.renderer->row();
    if (Status drawn = water.draw(scope, draw.view, fluid, draw.look, draw.target, &row, draw.lighting()); !drawn) return drawn;
    return draw.renderer->outcome();
}

FluidLookParams plainLook(FluidLookParams look) {
    look.quality = "fine";
    look.colourBy = "speed";
    return look;
}

rivulet_buffers buffersOf(const FluidView& fluid) {
    return {.size = 0,
            .position = fluid.position,
            .velocity = fluid.velocity,
            .id = fluid.id,
            .count = fluid.count,
            .radius = fluid.radius,
            .wet_cells = fluid.wetCells,
            .wetness = fluid.wetness,
            .attributes = {fluid.attributes[0], fluid.attributes[1], fluid.attributes[2], fluid.attributes[3]}};
}

}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_world_draw(rivulet_world* world, const rivulet_view* view, const rivulet_target* target, rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (world == nullptr) return badInput("world is NULL");
        if (Status there = drawable(*world->context); !there) return there;
        if (Status can = ready(*world->context, Needs::drawing); !can) return can;
        Result<WaterDraw> draw = waterDraw(world->params.look, world->params.fluid.liquid, view, target);
        if (!draw) return draw.error();
        const CallScope scope(*world->context, Needs::drawing);
        const Result<FluidView> fluid = world->upload.view(*world->world, world->params.look, world->fallingDrops, world->hangingDrops);
        if (!fluid) return fluid.error();
        return drawWater(*world->context->water, *world->context->hostGl, *fluid, *draw);
    });
    if (world != nullptr) world->context->hostLog.deliver(world->context->callback);
    return status;
}

rivulet_status rivulet_context_set_surroundings(rivulet_context* context, const rivulet_surroundings* surroundings, rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (context == nullptr) return badInput("context is NULL");
        if (Status there = drawable(*context); !there) return there;
        if (Status can = ready(*context, Needs::drawing); !can) return can;
        if (surroundings == nullptr) return badInput("surroundings is NULL");
        const Result<rivulet_surroundings> given = readStruct(surroundings, "rivulet_surroundings", "surroundings");
        if (!given) return given.error();
        HostSurroundings from{.texture = given->texture};
        if (given->pixels != nullptr) {
            constexpr int32_t kLargest = 1 << 15;  // texels
            if (given->width < 1 || given->height < 1 || given->width > kLargest || given->height > kLargest)
                return badInput(
                    fmt::format("surroundings.pixels are {} x {}: give 1 to {} each way", given->width, given->height, kLargest));
            static_assert(sizeof(vec3) == 3 * sizeof(float));
            const size_t count = static_cast<size_t>(given->width) * static_cast<size_t>(given->height);
            from.image = {given->width, given->height, {reinterpret_cast<const vec3*>(given->pixels), count}};
        }
        if (given->turn != nullptr) std::memcpy(&from.turn[0][0], given->turn, sizeof from.turn);
        const CallScope scope(*context, Needs::drawing);
        return context->water->setSurroundings(*context->hostGl, from);
    });
    if (context != nullptr) context->hostLog.deliver(context->callback);
    return status;
}

rivulet_status rivulet_world_buffers(rivulet_world* world, rivulet_buffers* buffers, rivulet_error* why) {
    return with(world, why, Needs::drawing, [&]() -> Status {
        if (Status there = drawable(*world->context); !there) return there;
        Result<FluidView> fluid = world->upload.view(*world->world, plainLook(world->params.look));
        if (!fluid) return fluid.error();
        return writeStruct(buffersOf(*fluid), buffers, "rivulet_buffers", "buffers");
    });
}

rivulet_status rivulet_world_wet_solid(const rivulet_world* world, int32_t solid, size_t index, rivulet_wet_solid* wet,
                                       rivulet_error* why) {
    return with(world, why, Needs::device, [&]() -> Status {
        const WetnessView view = world->world->wetness();
        if (!view.surface) return badInput("fluid.wetness.on is off: nothing gets wet");
        if (solid != RIVULET_WALL && solid != RIVULET_BODY)
            return badInput(fmt::format("solid is {}: use RIVULET_WALL or RIVULET_BODY", solid));
        const bool wall = solid == RIVULET_WALL;
        const std::vector<SolidRef> walls = world->walls.solids().colliders;
        if (wall && index >= walls.size()) return badInput(fmt::format("there is no wall {}: the world has {}", index, walls.size()));
        SolidRef ref = wall ? walls[index] : SolidRef{};
        if (!wall) {
            const Result<std::optional<size_t>> place =
                world->bodies.placeOf(*world->world, static_cast<uint32_t>(std::min<size_t>(index, UINT32_MAX)));
            if (!place) return place.error();
            if (!*place) return badInput(fmt::format("body {} is not in the world yet", index));
            ref = {ProbeOn::body, static_cast<uint32_t>(**place)};
        }
        const WetSolid* found = view.surface->find(ref);
        if (found == nullptr && wall)
            return badInput(fmt::format("wall {} does not get wet: none of its surface is inside fluid.box", index));
        if (found == nullptr) return badInput(fmt::format("body {} does not get wet: set rivulet_body.mesh", index));
        const mat4 m = found->cellsFromWorld(found->poseAmong(world->world->drawnPoses(), world->world->bodies()));
        rivulet_wet_solid full{
            .size = 0, .from_world = {}, .cells = {found->size.x, found->size.y, found->size.z}, .first_cell = found->firstCell};
        std::memcpy(full.from_world, &m[0][0], sizeof full.from_world);
        return writeStruct(full, wet, "rivulet_wet_solid", "wet");
    });
}
