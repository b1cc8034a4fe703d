// Depth of the sphere or ellipsoid; blended by minimum.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
#if defined(ELLIPSOIDS)
flat in mat3 shapeView;
#endif
layout(location = 0) out float front;
void main() {
    float through;
#if defined(ELLIPSOIDS)
    if (!hitEllipsoid(gl_FragCoord.xy, centreView.xyz, shapeView, front, through)) discard;
#else
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, front, through)) discard;
#endif
}
