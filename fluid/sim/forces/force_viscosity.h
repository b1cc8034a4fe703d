// Viscosity of methods that have none of their own, explicit or implicit, and drag of no-slip walls in every method.
#pragma once

#include <string>

#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;
struct FluidParams;

// The longest step (s) with which explicit viscosity is stable: 0.125 hs^2 / nu (Morris et al. 1997).
double explicitViscousLimit(const FluidParams& params);

namespace force_viscosity {

struct Params {
    std::string viscosity = "auto";    // auto | explicit | implicit | none
    float viscosityTolerance = 0.01F;  // of the implicit solver, a share
    int viscosityIterations = 100;     // at most, a step
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_viscosity
}  // namespace rivulet
