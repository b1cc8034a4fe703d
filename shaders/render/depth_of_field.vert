// One triangle over the whole viewport, and what the lens focuses on.
#include "shaders/render/frame.glsl"
uniform sampler2D sceneDepth;  // window depth
uniform sampler2D fluidDepth;  // m
uniform bool water;
uniform bool automatic;  // focuses on what is in the middle of the picture
uniform vec4 lens;       // m, the focal length; pixels m, see below; m, the focus if nothing is in the middle; pixels, the largest radius
flat out vec3 blur;      // pixels: the radius of a disc is |x - y / depth|, at most z

// m: the harmonic mean of the depths in a spot, without the background.
float middle() {
    const int kSide = 5;
    const float kSpot = 0.03;  // of the picture's height, half the spot's width
    vec2 size = vec2(textureSize(sceneDepth, 0));
    float sum = 0.0, count = 0.0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            ivec2 at = ivec2(0.5 * size + kSpot * size.y * (2.0 * vec2(x, y) / float(kSide - 1) - 1.0));
            float window = texelFetch(sceneDepth, at, 0).r, fluid = water ? texelFetch(fluidDepth, at, 0).r : 1.0e30;
            float depth = min(window < 1.0 ? depthOfWindow(window) : 1.0e30, fluid);
            if (depth > 1.0e5) continue;
            sum += 1.0 / depth;
            count += 1.0;
        }
    return count > 0.0 ? count / sum : lens.z;
}

void main() {
    float focus = automatic ? max(middle(), 2.0 * lens.x) : lens.z;
    float most = lens.y / (focus - lens.x);
    blur = vec3(most, most * focus, lens.w);
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 1.0, 1.0);
}
