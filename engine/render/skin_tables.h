// Lookup tables of skin: diffuse light with subsurface scattering on a curved surface, and relief finer than a texel.
#pragma once

#include "engine/gpu/texture.h"
#include "engine/material/image.h"

namespace rivulet {

// Diffuse light of a sphere of skin in parallel light, by the cosine to the light (x, -1..1) and the scattering distance over the radius
// (y, 0..1): r16f. Pre-integrated as in Penner 2011, but on a sphere instead of a ring, with the profile of Burley 2015 for each channel.
Result<gpu::Texture> makeDiffusionTable();

// Converts heights to slopes, which can be averaged in mips: x, y the change of height per unit of u, v (m), z the mean of their squares,
// which gives the variance lost by averaging (Olano and Baker 2010), w the height (mm). rgba16f with all mips.
Result<gpu::Texture> makeSlopes(const Image& heights, float step, bool repeats);  // `step`: m per grey level of red

// A repeating height map of pores and fine lines, kPoreTile wide, kPoreStep per grey level.
inline constexpr float kPoreTile = 0.014F, kPoreStep = 4.0e-7F;  // m
Image makePores();

}  // namespace rivulet
