// Material: a surface function's parameters. The functions themselves are shaders/material/*.glsl.
#pragma once

#include <memory>

#include "engine/core/params.h"
#include "engine/material/image.h"

namespace rivulet {

// Skin: light goes in, spreads and comes out elsewhere, red furthest; two lobes of gloss, stronger where it is oily.
struct SkinLook {
    vec3 scatter{3.7e-3F, 1.4e-3F, 0.7e-3F};  // m, how far red, green and blue spread
    float translucency = 1.0F;                // of thin parts with the light behind them
    float pores = 1.0F;                       // strength of what is finer than the relief's texels
    std::shared_ptr<const Image> relief;      // grey: height; null: smooth
    float reliefStep = 4.0e-6F;               // m a grey level
    std::shared_ptr<const Image> regions;     // R oily, G dry, B hair, A lip; null: none of these
};

// An eyeball: what is seen through the cornea lies where the light is bent to. In the mesh's own frame.
struct EyeLook {
    vec3 centre{0.0F};            // m, of the eyeball
    vec3 sight{0, 0, 1};          // unit, through the pupil
    float radius = 0.012F;        // m, of the eyeball
    float corneaRadius = 0.65F;   // of the cornea's sphere, in radii of the eyeball
    float corneaCentre = 0.446F;  // its centre before the eyeball's, in radii
};

struct Material {
    vec3 baseColour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;

    float opacity = 1.0F;                            // where blended: of what is matte; gloss stays
    bool blended = false;                            // drawn over what is opaque, farthest first
    float cutoff = 0.0F;                             // alpha below which there is nothing
    bool doubleSided = true;                         // or seen from outside only
    std::shared_ptr<const Image> colour;             // sRGB, times baseColour; alpha, times opacity
    std::shared_ptr<const Image> metallicRoughness;  // blue, times metallic; green, times roughness
    std::shared_ptr<const Image> normals;            // of the tangent plane: x along u, y along v
    std::shared_ptr<const SkinLook> skin;            // null: no skin
    std::shared_ptr<const EyeLook> eye;              // null: no eye

    void visit(ParamVisitor& v) {
        v.colour({"baseColour", "", "reflectance, linear", 0, 1}, baseColour);
        v.value({"roughness", "", "0 mirror, 1 chalk", 0, 1}, roughness);
        v.value({"metallic", "", "0 dielectric, 1 metal", 0, 1}, metallic);
    }
};

}  // namespace rivulet
