// A procedural sky: haze at the horizon, the glow around the sun, soft clouds. Outdoor water reflects it.
#pragma once

#include "engine/material/image.h"

namespace rivulet {

struct SkyLook {
    vec3 sun{0.4F, 0.8F, 0.45F};                                                   // unit vector towards the sun
    vec3 sunlight{3.0F};                                                           // linear radiance, as FrameView::lightColour
    vec3 horizon{0.40F, 0.44F, 0.48F}, zenith{0.12F, 0.17F, 0.24F}, ground{0.5F};  // linear radiance, as Studio's; ground: reflectance
    float clouds = 0.5F;                                                           // approximate share of the sky that clouds cover, 0..1
};

// 1024 x 512 texels. It does not contain the sun's disc, which is the key light.
HdrImage makeSky(const SkyLook& look);

}  // namespace rivulet
