// Surface tension (thesis (8)) from its normals (thesis (7)).
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;

namespace force_thesis_tension {

struct Params {
    float thesisTension = 0.0F;  // m/s^2 at a flat surface; < 0 pulls inward; 0 = none
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_thesis_tension
}  // namespace rivulet
