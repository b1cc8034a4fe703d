// Layer: a liquid that lies on a material, whichever it is. Drawn over the surface function's result, which knows nothing of it.
#pragma once

#include "engine/core/params.h"
#include "engine/gpu/texture.h"

namespace rivulet {

struct LayerLook {
    float refractiveIndex = 1.336F;
    vec3 absorption{0.5F, 0.15F, 0.1F};  // 1/m
    float roughness = 0.10F;             // of a drop's surface
    float filmRoughness = 0.22F;         // of what is wet, without a drop on it
    float darkening = 0.18F;             // how much darker and more saturated what is wet gets
    float scale = 1.0F;                  // of heights and slopes

    void visit(ParamVisitor& v) {
        v.value({"refractiveIndex", "", "of the liquid", 1, 2}, refractiveIndex);
        v.value({"absorption", "1/m", "of the liquid, red, green, blue", 0, 5000}, absorption);
        v.value({"roughness", "", "of a drop's surface", 0, 1}, roughness);
        v.value({"filmRoughness", "", "of what is wet, without a drop on it", 0, 1}, filmRoughness);
        v.value({"darkening", "", "how much darker what is wet gets", 0, 1}, darkening);
        v.value({"scale", "", "of heights: 1 is true", 0, 4}, scale);
    }
};

struct Layer {
    // rgba16f with all mips, over the mesh's uvs: x, y the slope of the liquid's height (m a unit of u, of v), z the height (mm), w how
    // wet: 1 under a drop or a full film. Lives as long as what it is drawn with. Null: dry.
    const gpu::Texture* texels = nullptr;
    LayerLook look;
};

}  // namespace rivulet
