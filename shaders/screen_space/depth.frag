// Depth of the sphere or ellipsoid, in the layer of the bulk or of the spray; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
flat in float sprayed;
#if defined(ELLIPSOIDS)
flat in mat3 shapeView;
#endif
layout(location = 0) out vec2 bulkSpray;
void main() {
    float depth, through;
#if defined(ELLIPSOIDS)
    if (!hitEllipsoid(gl_FragCoord.xy, centreView.xyz, shapeView, depth, through)) discard;
#else
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
#endif
    bulkSpray = sprayed > 0.5 ? vec2(kFar, depth) : vec2(depth, kFar);
}
