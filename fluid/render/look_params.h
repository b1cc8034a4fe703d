// FluidLookParams: the appearance of a fluid, as a scene or a host sets it.
#pragma once

#include <string>

#include "engine/core/params.h"
#include "engine/core/result.h"
#include "fluid/render/fluid_look.h"

namespace rivulet {

struct FluidParams;

// How the fluid is drawn.
struct FluidLookParams {
    std::string renderer = "screen_space";  // a row of renderers()
    std::string colourBy = "speed";         // of points: a row of colourings()
    std::string splats = "ellipsoids";      // shape of a drawn particle: spheres | ellipsoids
    std::string view = "water";             // a row of waterViews()
    std::string split;                      // a row of renderers(), for the picture's right half; "" = none
    std::string quality = "auto";           // auto | fast | fine
    float radiusSpacings = 0.6F;            // drawn radius over spacing
    std::string filter = "narrow_range";    // a row of filters()
    bool caustics = true;                   // the water refracts the key light
    float smoothing = 0.0F;                 // m, reach of the smoothing, two standard deviations; 0 = 1.8 spacings
    float smoothingRange = 0.0F;            // m, largest difference of depths on one surface; 0 = 4.2 spacings
    float detail = 0.5F;                    // pixels: below this radius only some particles are drawn, each larger; 0 = all
    vec3 absorption{-1.0F};                 // 1/m, Beer-Lambert per channel; -1 = of the liquid
    vec3 scattering{-1.0F};                 // 1/m, reduced, per channel; -1 = of the liquid
    float refractiveIndex = 0.0F;           // 0 = of the liquid
    void visit(ParamVisitor& v);
    bool showsNormals() const;     // FluidView::velocity holds normals instead of velocities
    bool showsEllipsoids() const;  // particles are drawn as ellipsoids, in the whole picture or in its right half
};

// "", or a value that is in its range and makes no sense.
std::string contradiction(const FluidLookParams& params);

// Returns the look of these params; values of -1 or 0 come from the liquid (a row of liquids(), or ""). Error (badInput): an unknown name.
Result<FluidLook> fluidLookOf(const FluidLookParams& params, const std::string& liquid);

// Returns `fluid` with the results that this look needs enabled: normals of the surface, ellipsoids.
FluidParams fluidForLook(FluidParams fluid, const FluidLookParams& look);

}  // namespace rivulet
