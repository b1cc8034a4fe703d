// Tables that skin is drawn with: how light spreads on a bent surface, and relief finer than a texture's texels.
#pragma once

#include "engine/gpu/texture.h"
#include "engine/material/image.h"

namespace rivulet {

// What a ball of skin returns of parallel light, by the cosine to the light (x, -1..1) and how far light spreads over the ball's radius
// (y, 0..1): r16f. Pre-integrated as in Penner 2011, on the ball instead of a ring, with the profile of Burley 2015 for every channel.
Result<gpu::Texture> makeDiffusionTable();

// Heights as slopes, which may be averaged (mips) without going wrong: x, y the change of height over a unit of u, v (m), z the mean of
// their squares (what an average hides: Olano and Baker 2010), w the height (mm). rgba16f with all mips.
Result<gpu::Texture> makeSlopes(const Image& heights, float step, bool repeats);  // `step`: m a grey level of red

// A tile of pores and fine lines, kPoreTile wide, in steps of kPoreStep.
inline constexpr float kPoreTile = 0.014F, kPoreStep = 4.0e-7F;  // m
Image makePores();

}  // namespace rivulet
