// Depth of the sphere, in the bulk's layer or the spray's; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
flat in float sprayed;
layout(location = 0) out vec2 bulkSpray;
void main() {
    float depth, through;
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
    bulkSpray = sprayed > 0.5 ? vec2(kFar, depth) : vec2(depth, kFar);
}
