// Position Based Fluids (Macklin and Mueller 2013): a few corrections of predicted positions a step. Fast, unconditionally bounded, a
// little soft.
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct MethodRow;

struct PbfParams {
    int iterations = 3;       // a step, where tolerance is 0
    float tolerance = 0.0F;   // mean compression, a fraction; 0 = none
    int maxIterations = 20;   // where there is one
    float relaxation = 1.0F;  // factor of the corrections' weights, which are Chebyshev's
    float reach = 0.6F;       // spacings a step
    int minSubsteps = 4;      // a frame of 1/60 s
    void visit(ParamVisitor& v);
};

MethodRow pbfMethod();

}  // namespace rivulet
