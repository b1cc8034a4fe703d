// Depth of the sphere, in the bulk's layer or the spray's; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
flat in float sprayed;
layout(location = 0) out float bulk;
layout(location = 1) out float spray;
void main() {
    float depth, through;
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
    bulk = sprayed > 0.5 ? kFar : depth;
    spray = sprayed > 0.5 ? depth : kFar;
}
