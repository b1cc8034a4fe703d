// Drag of the air and push of the wind on particles that are open to them (Gissler et al. 2017, simplified).
#pragma once

#include "engine/core/math.h"
#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;

namespace force_air {

struct Params {
    float airDrag = 0.0F;  // drag coefficient; 0 = no air
    vec3 wind{0.0F};       // m/s
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_air
}  // namespace rivulet
