// Depth of the sphere; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
uniform float radius;
flat in vec3 centreView;
layout(location = 0) out float depth;
void main() {
    float through;
    if (!hitSphere(gl_FragCoord.xy, centreView, radius, depth, through)) discard;
}
