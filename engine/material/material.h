// Material: the parameters of the surface functions in shaders/material/*.glsl.
#pragma once

#include <memory>

#include "engine/core/params.h"
#include "engine/material/image.h"

namespace rivulet {

// Skin: subsurface scattering, widest for red, and two specular lobes, which are stronger in oily regions.
struct SkinLook {
    vec3 scatter{3.7e-3F, 1.4e-3F, 0.7e-3F};  // m, mean scattering distance of red, green and blue
    float translucency = 1.0F;                // factor of the light through thin parts
    float pores = 1.0F;                       // strength of the detail below the resolution of `relief`
    std::shared_ptr<const Image> relief;      // red: height; null: smooth
    float reliefStep = 4.0e-6F;               // m per grey level
    std::shared_ptr<const Image> regions;     // masks: R oily, G dry, B hair, A lips; null: none
    std::shared_ptr<const Image> flushes;     // red: how much Material::flush reddens; green: hollows without light from around
};

// An eyeball, in the frame of the mesh; the iris is drawn as refracted by the cornea. The images are Lambert equal-area maps: the centre is
// the direction of sight, and the inscribed circle is the back of the eye. All lengths except `radius` are in units of `radius`.
struct EyeLook {
    vec3 centre{0.0F};           // m
    vec3 sight{0, 0, 1};         // unit
    float radius = 0.012F;       // m
    float corneaCentre = 0.45F;  // centre of the cornea's sphere, along `sight`
    float corneaRadius = 0.65F;
    float irisPlane = 0.85F;  // along `sight`
    float irisRadius = 0.5F;
};

struct Material {
    vec3 baseColour{0.72F, 0.71F, 0.69F};  // linear
    float roughness = 0.6F;
    float metallic = 0.0F;

    vec3 emission{0.0F};     // linear radiance of a light source
    float opacity = 1.0F;    // of the diffuse part of blended materials; reflections are not reduced
    float porosity = -1.0F;  // share of the surface that is darker when it is wet; negative: rough dielectrics are
    float grain = 0.0F;      // stone or sand: strength of relief and spots, 0..1
    float grainSize = 0.1F;  // m, size of the largest spots
    bool blended = false;    // drawn after opaque parts, from back to front
    bool clear = false;      // clear glass: each face reflects; baseColour and opacity give the transmission of a wall
    float cutoff = 0.0F;     // texels of smaller alpha are not drawn
    // Hair on blended ribbons, u from a whole number to the next across a ribbon, v from 0 at the roots to 1 at the tips: the width of a
    // hair as a share of its part of u; 0: no ribbons.
    float strand = 0.0F;
    int strands = 1;                                 // hairs side by side on a ribbon
    float flush = 0.0F;                              // 0..1: redness of skin, where it flushes, and of the white of an eye
    bool doubleSided = true;                         // false: back faces are culled
    std::shared_ptr<const Image> colour;             // sRGB, times baseColour; alpha, times opacity
    std::shared_ptr<const Image> metallicRoughness;  // blue, times metallic; green, times roughness
    std::shared_ptr<const Image> normals;            // in tangent space: x along u, y along v
    std::shared_ptr<const Image> occlusion;          // red: visible share of the surroundings
    std::shared_ptr<const Image> glow;               // sRGB, times emission
    std::shared_ptr<const SkinLook> skin;            // null: no skin
    std::shared_ptr<const EyeLook> eye;              // null: no eye

    void visit(ParamVisitor& v) {
        v.colour({"baseColour", "", "reflectance for red, green and blue, linear", 0, 1}, baseColour);
        v.value({"roughness", "", "0: mirror, 1: fully diffuse highlights", 0, 1}, roughness);
        v.value({"metallic", "", "0: dielectric, 1: metal", 0, 1}, metallic);
        v.value({"opacity", "", "1: opaque; below 1: transparent, as glass", 0, 1}, opacity);
    }
};

}  // namespace rivulet
