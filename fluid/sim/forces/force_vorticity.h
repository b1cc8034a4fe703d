// Vorticity confinement (Macklin and Mueller 2013).
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;

namespace force_vorticity {

struct Params {
    float vorticity = 0.0F;  // 1/s; 0 = none
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_vorticity
}  // namespace rivulet
