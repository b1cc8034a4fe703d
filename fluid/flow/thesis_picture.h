// The picture of a flow in the thesis, (22) and (23), as printed: discs in UV, their sum a height field, normals by its differences. A
// reference for FlowMaps: discs are stretched on a stretched chart and cut off at a seam.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

struct ThesisParticle {
    vec2 uv{0.0F};
    float mass = 0;  // kg
};

struct ThesisPicture {
    int size = 0;
    std::vector<float> height;  // rows from v = 0 up; 1 in the middle of one particle of the largest mass
    std::vector<vec3> normal;   // tangent space, unit length
};

// `radius`: UV, of a disc of mass `largest` (kg); the others are in proportion to their mass. `relief`: the height of 1, in texels.
ThesisPicture thesisPicture(std::span<const ThesisParticle> particles, int size, float radius, float largest, float relief = 4.0F);

// The height field as grey, rgba a texel, the top row (v = 1) first; 1 and above is white.
std::vector<uint8_t> greyOf(const ThesisPicture& picture);

}  // namespace rivulet
