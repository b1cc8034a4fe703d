// Depth of the sphere; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
layout(location = 0) out float depth;
void main() {
    float through;
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
}
