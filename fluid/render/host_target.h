// HostTarget: the picture that a host draws into, and into which water is to be drawn. Plain data.
#pragma once

namespace rivulet {

struct HostTarget {
    // GL name; 0: the window. Its first draw buffer and its depth hold the scene as drawn so far: of any format that can be drawn into, of
    // any number of samples. Without a depth nothing hides water.
    unsigned framebuffer = 0;
    int x = 0, y = 0, width = 0, height = 0;  // pixels: the viewport in it
    enum Colours {
        automatic,  // linear where they are floats, else srgb
        linear,     // radiance, which the host tonemaps later
        srgb,       // as a screen shows them, 1 is white
    } colours = automatic;
};

}  // namespace rivulet
