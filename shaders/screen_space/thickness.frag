// Water along the line of sight, in front of the scene; blended by addition. Drawn at 1 / SCALE of the resolution.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
uniform float radius;
uniform float volumeScale;  // a particle's volume / its sphere's
uniform int scale;
uniform sampler2D sceneDepth;
flat in vec3 centreView;
layout(location = 0) out float thickness;
void main() {
    vec2 pixel = gl_FragCoord.xy * float(scale);
    float front, through;
    if (!hitSphere(pixel, centreView, radius, front, through)) discard;
    float scene = depthOfWindow(texelFetch(sceneDepth, min(ivec2(pixel), ivec2(frame.viewport.xy) - 1), 0).r);
    thickness = volumeScale * clamp(scene - front, 0.0, through);
}
