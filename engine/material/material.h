// Material: a surface function's parameters. The function itself is shaders/material/surface.glsl.
#pragma once

#include "engine/core/params.h"

namespace rivulet {

struct Material {
    vec3 baseColour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;

    void visit(ParamVisitor& v) {
        v.colour({"baseColour", "", "reflectance, linear", 0, 1}, baseColour);
        v.value({"roughness", "", "0 mirror, 1 chalk", 0, 1}, roughness);
        v.value({"metallic", "", "0 dielectric, 1 metal", 0, 1}, metallic);
    }
};

}  // namespace rivulet
