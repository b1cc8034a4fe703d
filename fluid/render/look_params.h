// FluidLookParams: how a fluid is to look, as a scene or a host says it.
#pragma once

#include <string>

#include "engine/core/params.h"
#include "engine/core/result.h"
#include "fluid/render/fluid_look.h"

namespace rivulet {

// How the fluid is drawn.
struct FluidLookParams {
    std::string renderer = "screen_space";  // a row of renderers()
    std::string colourBy = "speed";         // of points: a row of colourings()
    std::string splats = "ellipsoids";      // what a particle is drawn as: spheres | ellipsoids
    std::string view = "water";             // a row of waterViews()
    std::string split;                      // a row of renderers(), for the picture's right half; "" = none
    std::string quality = "auto";           // auto | fast | fine
    float radiusSpacings = 0.6F;            // drawn radius = this * spacing
    std::string filter = "narrow_range";    // a row of filters(): how the surface is found
    float smoothing = 0.0F;                 // m, reach of the smoothing, two deviations; 0 = from the spacing
    float smoothingRange = 0.0F;            // m, how far apart depths of one surface may be; 0 = from the spacing
    vec3 absorption{-1.0F};                 // 1/m, Beer-Lambert per channel; -1 = as the liquid's
    vec3 scattering{-1.0F};                 // 1/m, reduced, per channel; -1 = as the liquid's
    float refractiveIndex = 0.0F;           // 0 = as the liquid's
    void visit(ParamVisitor& v);
    bool showsNormals() const;     // FluidView::velocity holds normals instead of velocities
    bool showsEllipsoids() const;  // particles are drawn as ellipsoids, in the whole picture or in its right half
};

// How it looks: what it leaves to the liquid (a row of liquids(), or "") as that says. Error (badInput): an unknown name.
Result<FluidLook> fluidLookOf(const FluidLookParams& params, const std::string& liquid);

}  // namespace rivulet
