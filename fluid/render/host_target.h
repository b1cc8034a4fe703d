// HostTarget: the framebuffer of a host, into which the water is drawn. Plain data.
#pragma once

#include "engine/core/abi.h"

namespace rivulet {

struct HostTarget {
    // GL name; 0: the window. Its first draw buffer and its depth hold the scene as drawn so far, in any renderable format and number of
    // samples. Without a depth buffer nothing hides the water.
    unsigned framebuffer = 0;
    int x = 0, y = 0, width = 0, height = 0;  // pixels: the viewport in it
    enum Colours {
        automatic,  // linear for float formats, else srgb
        linear,     // radiance, which the host tonemaps later
        srgb,       // display values, 1 is white
    } colours = automatic;
};

}  // namespace rivulet
