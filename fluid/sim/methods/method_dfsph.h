// DFSPH (Bender and Koschier 2015): pressures solved for, so that neither the density nor the flow compresses, to a tolerance.
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct MethodRow;

struct DfsphParams {
    float tolerance = 3.0e-4F;  // mean compression that a step adds where the fastest goes as far as it may, a fraction
    float correction = 0.2F;    // of a density that is off, a step
    int maxIterations = 100;
    float warmStart = 1.0F;   // 0..1
    float relaxation = 0.6F;  // of an iteration
    float momentum = 0.7F;
    float reach = 0.3F;             // spacings a step
    int minSubsteps = 8;            // a frame of 1/60 s
    bool negativePressure = false;  // inside the fluid
    void visit(ParamVisitor& v);
};

MethodRow dfsphMethod();

}  // namespace rivulet
