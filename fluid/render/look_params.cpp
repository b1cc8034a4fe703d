#include "fluid/render/look_params.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "engine/core/assert.h"
#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

void FluidLookParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> rendererNames = renderers().names(), colourNames = colourings().names();
    v.choice({.name = "renderer", .doc = "water renderer; rivulet list renderers describes each"}, renderer, rendererNames);
    v.choice(
        {.name = "colourBy",
         .doc =
             "quantity shown by the colour of points; normal: its x, y, z as red, green, blue; surface: blue for particles of the surface"},
        colourBy, colourNames);
    static const std::vector<std::string> splatKinds = {"spheres", "ellipsoids"}, qualities = {"auto", "fast", "fine"};
    static const std::vector<std::string> viewNames = waterViews().names();
    v.choice(
        {.name = "splats",
         .doc = "shape of a drawn particle of the surface; ellipsoids lie along the surface and cost one pass over neighbours per frame"},
        splats, splatKinds);
    v.choice({.name = "view", .doc = "the finished water, or one of the images that its surface is made from"}, view, viewNames);
    static const std::vector<std::string> splitNames = renderers().namesOrNone();
    v.choice({.name = "split", .doc = "renderer of the picture's right half, for comparison; empty = look.renderer for the whole picture"},
             split, splitNames);
    v.choice({.name = "quality",
              .doc = "fast: spheres, the surface at half the resolution, coarser light in the water, no screen-space reflection; fine: "
                     "full quality; auto: in a window by the frame time, else fine"},
             quality, qualities);
    v.value({.name = "caustics", .doc = "the water refracts the key light onto what lies behind it; off: it only absorbs it"}, caustics);
    v.value({"radiusSpacings", "", "drawn radius of a particle, in spacings", 0.1, 3}, radiusSpacings);
    static const std::vector<std::string> filterNames = filters().names();
    v.choice({.name = "filter", .doc = "filter that smooths the particles' depth to a surface; rivulet list filters describes each"},
             filter, filterNames);
    v.value({"smoothing", "m", "width of the surface filter, two standard deviations; 0 = 1.8 spacings", 0, 10}, smoothing);
    v.value({"smoothingRange", "m", "largest depth difference within one surface; 0 = 4.2 spacings", 0, 100}, smoothingRange);
    v.value({"detail", "pixels",
             "level of detail: the radius in the picture below which only some of the particles are drawn, each larger; 0 = all are drawn",
             0, 100},
            detail);
    v.value(
        {"absorption", "1/m",
         "absorption coefficient for red, green and blue (Beer-Lambert); -1 = that of fluid.liquid, of water if it is empty", -1, 1.0e5},
        absorption);
    v.value({"scattering", "1/m",
             "reduced scattering coefficient for red, green and blue; -1 = that of fluid.liquid, of water if it is empty", -1, 1.0e5},
            scattering);
    v.value({"refractiveIndex", "", "refractive index of the fluid; 0 = that of fluid.liquid, of water if it is empty", 0, 3},
            refractiveIndex);
}

bool FluidLookParams::showsNormals() const {
    const ColourRow* row = colourings().find(colourBy);
    return row != nullptr && row->normals;
}

bool FluidLookParams::showsEllipsoids() const {
    const auto draws = [](const std::string& name) {
        const RendererRow* row = renderers().find(name);
        return row != nullptr && row->ellipsoids;
    };
    return splats == "ellipsoids" && quality != "fast" && (draws(renderer) || draws(split));
}

std::string contradiction(const FluidLookParams& params) {
    if (params.refractiveIndex == 0 || params.refractiveIndex >= 1) return "";
    return fmt::format("look.refractiveIndex is {}: give 1 or more, or 0 for the liquid's", params.refractiveIndex);
}

Result<FluidLook> fluidLookOf(const FluidLookParams& params, const std::string& liquidName) {
    const ColourRow* colour = colourings().find(params.colourBy);
    if (colour == nullptr)
        return badInput(
            fmt::format("look.colourBy '{}' is unknown; choose one of {}", params.colourBy, fmt::join(colourings().names(), ", ")));
    const FilterRow* filter = filters().find(params.filter);
    if (filter == nullptr) return badInput(fmt::format("look.filter '{}' is unknown", params.filter));
    FluidLook look{.colourBy = colour->colourBy, .filter = filter, .smoothing = params.smoothing, .smoothingRange = params.smoothingRange};
    const ViewRow* view = waterViews().find(params.view);
    if (view == nullptr) return badInput(fmt::format("look.view '{}' is unknown", params.view));
    look.view = view->view;
    look.fast = params.quality == "fast";
    look.detail = params.detail;
    look.caustics = params.caustics;
    const LiquidRow* liquid = liquids().find(liquidName);
    if (liquid == nullptr) liquid = liquids().find("water");
    ASSERT(liquid != nullptr, "keep the row of water");
    const auto given = [](const vec3& v) { return glm::all(glm::greaterThanEqual(v, vec3(0.0F))); };
    look.absorption = given(params.absorption) ? params.absorption : liquid->absorption;
    look.scattering = given(params.scattering) ? params.scattering : liquid->scattering;
    look.refractiveIndex = params.refractiveIndex > 0 ? params.refractiveIndex : liquid->refractiveIndex;
    return look;
}

FluidParams fluidForLook(FluidParams fluid, const FluidLookParams& look) {
    if (look.showsNormals() && fluid.forces.normals == "none") fluid.forces.normals = "thesis";
    fluid.ellipsoids = fluid.ellipsoids || look.showsEllipsoids();
    return fluid;
}

}  // namespace rivulet
