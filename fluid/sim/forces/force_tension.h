// Surface tension as a stress along the surface, and adhesion to walls and bodies (Akinci et al. 2013).
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;
struct FluidParams;

// The longest step (s) with which surface tension is stable: 0.25 sqrt(rho hs^3 / (2 pi sigma)) (Brackbill et al. 1992).
double capillaryLimit(const FluidParams& params);

namespace force_tension {

struct Params {
    float tension = 0.0F;   // N/m; 0 = none
    float adhesion = 0.0F;  // N/m, to walls and bodies; 0 = none
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_tension
}  // namespace rivulet
