// A sky that is made, not photographed: haze at the horizon, the sun's glow, soft clouds. What water outdoors has to mirror.
#pragma once

#include "engine/material/image.h"

namespace rivulet {

struct SkyLook {
    vec3 sun{0.4F, 0.8F, 0.45F};                                                   // unit, towards it
    vec3 sunlight{3.0F};                                                           // linear radiance, as FrameView::lightColour
    vec3 horizon{0.40F, 0.44F, 0.48F}, zenith{0.12F, 0.17F, 0.24F}, ground{0.5F};  // as Studio's; ground: reflectance
    float clouds = 0.5F;                                                           // share of the sky that they cover, about
};

// 1024 x 512. The sun's disc is not in it: the key light is that.
HdrImage makeSky(const SkyLook& look);

}  // namespace rivulet
