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

// An eyeball, in the mesh's own frame: its iris is seen where the cornea bends the ray to. Its pictures have the pole of Lambert's
// equal-area map where the eye looks, in the middle, and the back of the eye along the edge of the inscribed circle. Lengths but `radius`
// in its radii.
struct EyeLook {
    vec3 centre{0.0F};           // m
    vec3 sight{0, 0, 1};         // unit
    float radius = 0.012F;       // m
    float corneaCentre = 0.45F;  // of its sphere, along `sight`
    float corneaRadius = 0.65F;
    float irisPlane = 0.85F;  // along `sight`
    float irisRadius = 0.5F;
};

struct Material {
    vec3 baseColour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;

    vec3 emission{0.0F};                             // linear radiance, of a lamp
    float opacity = 1.0F;                            // where blended: of what is matte; gloss stays
    float grain = 0.0F;                              // of stone or sand: how rough and how mottled, 0..1
    float grainSize = 0.1F;                          // m, of its largest spots
    bool blended = false;                            // drawn over what is opaque, farthest first
    bool clear = false;                              // and each face mirrors: a glass, baseColour and opacity say what a wall lets through
    float cutoff = 0.0F;                             // alpha below which there is nothing
    float strand = 0.0F;                             // of blended ribbons: share of u, about its middle, that is a hair; 0: no ribbons
    bool doubleSided = true;                         // or seen from outside only
    std::shared_ptr<const Image> colour;             // sRGB, times baseColour; alpha, times opacity
    std::shared_ptr<const Image> metallicRoughness;  // blue, times metallic; green, times roughness
    std::shared_ptr<const Image> normals;            // of the tangent plane: x along u, y along v
    std::shared_ptr<const Image> occlusion;          // red: share of the surroundings that its hollows see
    std::shared_ptr<const Image> glow;               // sRGB, times emission
    std::shared_ptr<const SkinLook> skin;            // null: no skin
    std::shared_ptr<const EyeLook> eye;              // null: no eye

    void visit(ParamVisitor& v) {
        v.colour({"baseColour", "", "reflectance, linear", 0, 1}, baseColour);
        v.value({"roughness", "", "0 mirror, 1 chalk", 0, 1}, roughness);
        v.value({"metallic", "", "0 dielectric, 1 metal", 0, 1}, metallic);
        v.value({"opacity", "", "1 = what is behind it is hidden; less, as of glass: it shows through", 0, 1}, opacity);
    }
};

}  // namespace rivulet
