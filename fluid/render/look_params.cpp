#include "fluid/render/look_params.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

void FluidLookParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> rendererNames = renderers().names(), colourNames = colourings().names();
    v.choice({.name = "renderer", .doc = "how the water is drawn; rivulet list renderers says what each is"}, renderer, rendererNames);
    v.choice({.name = "colourBy",
              .doc = "what the colour of points shows; normal: its parts along x, y, z as red, green, blue; surface: blue what lies there"},
             colourBy, colourNames);
    static const std::vector<std::string> splatKinds = {"spheres", "ellipsoids"}, qualities = {"auto", "fast", "fine"};
    static const std::vector<std::string> viewNames = waterViews().names();
    v.choice(
        {.name = "splats",
         .doc = "what a particle of the surface is drawn as; ellipsoids lie along the surface, and cost a sweep over neighbours a frame"},
        splats, splatKinds);
    v.choice({.name = "view", .doc = "the water, or what its surface is made from"}, view, viewNames);
    v.value({.name = "split", .doc = "the renderer of the picture's right half, to compare; none = the whole picture is look.renderer's"},
            split);
    v.choice(
        {.name = "quality",
         .doc = "fast: spheres, the surface at half the resolution, coarser light in the water, no reflection of the picture in itself; "
                "auto: in a window as its frames allow, else fine"},
        quality, qualities);
    v.value({"radiusSpacings", "", "drawn radius of a particle, in spacings", 0.1, 3}, radiusSpacings);
    static const std::vector<std::string> filterNames = filters().names();
    v.choice({.name = "filter", .doc = "how a surface is made of the particles' depth; rivulet list filters says what each is"}, filter,
             filterNames);
    v.value({"smoothing", "m", "reach of the surface's smoothing, two standard deviations; 0 = 1.8 spacings", 0, 10}, smoothing);
    v.value({"smoothingRange", "m", "how far apart depths of one surface may be; 0 = 4.2 spacings", 0, 100}, smoothingRange);
    v.value({"absorption", "1/m",
             "how fast red, green and blue fade in the fluid (Beer-Lambert); -1 = as the row of fluid.liquid says, or 4.5, 1.1, 0.5 where "
             "none is named",
             -1, 1.0e5},
            absorption);
    v.value({"scattering", "1/m",
             "how much of red, green and blue is thrown to all sides on its way (reduced); -1 = as the row of fluid.liquid says, or 0.05, "
             "0.3, 0.27 where none is named",
             -1, 1.0e5},
            scattering);
    v.value({"refractiveIndex", "", "of the fluid; 0 = as the row of fluid.liquid says, or 1.333 where none is named", 0, 3},
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

Result<FluidLook> fluidLookOf(const FluidLookParams& params, const std::string& liquidName) {
    const ColourRow* colour = colourings().find(params.colourBy);
    if (colour == nullptr)
        return badInput(
            fmt::format("look.colourBy '{}' is not known; there are: {}", params.colourBy, fmt::join(colourings().names(), ", ")));
    const FilterRow* filter = filters().find(params.filter);
    if (filter == nullptr) return badInput(fmt::format("look.filter '{}' is not known", params.filter));
    FluidLook look{.colourBy = colour->colourBy, .filter = filter, .smoothing = params.smoothing, .smoothingRange = params.smoothingRange};
    const ViewRow* view = waterViews().find(params.view);
    if (view == nullptr) return badInput(fmt::format("look.view '{}' is not known", params.view));
    look.view = view->view;
    look.fast = params.quality == "fast";
    const LiquidRow* liquid = liquids().find(liquidName);
    const bool own = glm::all(glm::greaterThanEqual(params.absorption, vec3(0.0F)));
    if (own) look.absorption = params.absorption;
    if (!own && liquid != nullptr) look.absorption = liquid->absorption;
    if (params.refractiveIndex > 0 || liquid != nullptr)
        look.refractiveIndex = params.refractiveIndex > 0 ? params.refractiveIndex : liquid->refractiveIndex;
    if (glm::all(glm::greaterThanEqual(params.scattering, vec3(0.0F))))
        look.scattering = params.scattering;
    else if (liquid != nullptr)
        look.scattering = liquid->scattering;
    return look;
}

FluidParams fluidForLook(FluidParams fluid, const FluidLookParams& look) {
    if (look.showsNormals() && fluid.forces.normals == "none") fluid.forces.normals = "thesis";
    fluid.ellipsoids = fluid.ellipsoids || look.showsEllipsoids();
    return fluid;
}

}  // namespace rivulet
