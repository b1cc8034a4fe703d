// FrameView: camera, size, light and time of a frame, as plain data that a host fills in.
#pragma once

#include "engine/core/math.h"

namespace rivulet {

inline constexpr float kNoDepth = 1.0e6F;  // m, shaders/render/frame.glsl's depth of nothing

struct FrameView {
    mat4 view{1.0F};                        // world -> view, right-handed, looking down -z
    mat4 projection{1.0F};                  // view -> clip, perspective or orthographic, OpenGL depth range [-1, 1]
    vec3 cameraPosWorld{0.0F};              // m
    float nearPlane = 0.01F;                // m along the view axis; orthographic: 0 or more
    float farPlane = 100.0F;                // m
    float unitsPerMetre = 1.0F;             // of a host's view and planes: 100 for centimetres, see WaterRenderer::draw; else 1
    int width = 0, height = 0;              // pixels
    vec3 lightDirWorld{0.4F, 0.8F, 0.45F};  // unit, towards the light
    vec3 lightColour{3.0F};                 // linear RGB radiance
    double time = 0;                        // s

    bool parallel() const { return projection[3][3] == 1.0F; }  // orthographic
    // m at `depth` (m), of what is 1 m at a depth of 1 m in the picture.
    float spreadAt(float depth) const { return parallel() ? 1.0F : depth; }

    // The same view with half the width and height, rounded up.
    FrameView half() const {
        FrameView coarse = *this;
        coarse.width = (width + 1) / 2;
        coarse.height = (height + 1) / 2;
        return coarse;
    }
};

}  // namespace rivulet
