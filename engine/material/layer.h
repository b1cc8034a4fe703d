// Layer: a liquid on any material. The shader applies it to the result of the surface function, which does not depend on the layer.
#pragma once

#include "engine/core/params.h"
#include "engine/gpu/texture.h"

namespace rivulet {

struct LayerLook {
    float refractiveIndex = 1.336F;
    vec3 absorption{0.5F, 0.15F, 0.1F};  // 1/m
    float roughness = 0.10F;             // of the surface of a drop
    float filmRoughness = 0.22F;         // of a wet surface without a drop
    float darkening = 0.18F;             // how much darker and more saturated a wet surface is
    float scale = 1.0F;                  // factor of the heights and slopes of the liquid

    void visit(ParamVisitor& v) {
        v.value({"refractiveIndex", "", "refractive index of the liquid", 1, 2}, refractiveIndex);
        v.value({"absorption", "1/m", "absorption coefficient of the liquid for red, green and blue", 0, 100000}, absorption);
        v.value({"roughness", "", "roughness of the surface of a drop", 0, 1}, roughness);
        v.value({"filmRoughness", "", "roughness of a wet surface without a drop", 0, 1}, filmRoughness);
        v.value({"darkening", "", "how much darker and more saturated a wet surface is; 0: as dry", 0, 1}, darkening);
        v.value({"scale", "", "factor of the heights and slopes of the liquid; 1: as simulated", 0, 4}, scale);
    }
};

struct Layer {
    // rgba16f with all mips, over the mesh's uvs: x, y the slope of the liquid's height (m per unit of u and v), z the height (mm), w the
    // wetness: 1 under a drop or a full film. The texture must outlive the drawing. Null: dry.
    const gpu::Texture* texels = nullptr;
    LayerLook look;
};

}  // namespace rivulet
