// rivulet.h: drawing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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
    frame.lightDirWorld = glm::normalize(frame.lightDirWorld);
    frame.lightColour = isSet(v.light_colour) ? vectorOf(v.light_colour) : vec3(1.0F);
    draw.target = {.framebuffer = t.framebuffer,
                   .x = t.x,
                   .y = t.y,
                   .width = t.width,
                   .height = t.height,
                   .colours = static_cast<HostTarget::Colours>(t.colours)};
    return draw;
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
            .wetness = fluid.wetness};
}

}  // namespace rivulet::capi

using namespace rivulet;
using namespace rivulet::capi;

rivulet_status rivulet_world_draw(rivulet_world* world, const rivulet_view* view, const rivulet_target* target, rivulet_error* why) {
    const rivulet_status status = guarded(why, [&]() -> Status {
        if (world == nullptr) return badInput("world is NULL");
        if (Status there = drawable(*world->context); !there) return there;
        if (Status can = ready(*world->context, Needs::drawing); !can) return can;
        const Result<WaterDraw> draw = waterDraw(world->params.look, world->params.fluid.liquid, view, target);
        if (!draw) return draw.error();
        const CallScope scope(*world->context, Needs::drawing);
        const Result<FluidView> fluid = world->upload.view(*world->world, world->params.look, world->fallingDrops, world->hangingDrops);
        if (!fluid) return fluid.error();
        return world->context->water->draw(*world->context->hostGl, draw->view, *fluid, draw->look, draw->target, draw->row);
    });
    if (world != nullptr) world->context->hostLog.deliver(world->context->callback);
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
    return with(world, why, Needs::memory, [&]() -> Status {
        const WetnessView view = world->world->wetness();
        if (!view.surface) return badInput("fluid.wetness.on is off: nothing gets wet");
        if (solid != RIVULET_WALL && solid != RIVULET_BODY)
            return badInput(fmt::format("solid is {}: use RIVULET_WALL or RIVULET_BODY", solid));
        const bool wall = solid == RIVULET_WALL;
        const std::vector<SolidRef> walls = world->walls.solids().colliders;
        if (wall && index >= walls.size()) return badInput(fmt::format("there is no wall {}: the world has {}", index, walls.size()));
        SolidRef ref = wall ? walls[index] : SolidRef{};
        if (!wall) {
            const Result<std::optional<size_t>> place = world->bodies.placeOf(static_cast<uint32_t>(std::min<size_t>(index, UINT32_MAX)));
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
