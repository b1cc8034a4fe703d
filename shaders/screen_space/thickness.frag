// Thickness of water along the line of sight, in front of the scene; blended by addition. At 1 / `scale` of the resolution.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
uniform float spacing;      // m
uniform float standsFor;    // number of particles that a drawn one represents
uniform int scale;
uniform sampler2D sceneDepth;
flat in vec4 centreView;
flat in float represented;  // particles by this one
#if defined(ELLIPSOIDS)
flat in mat3 shapeView;
#endif
#if defined(INK)
layout(location = 0) out vec2 thickness;  // y: of liquids other than the world's own
flat in vec4 ink;                  // 1/m; w: scattering
flat in float other;               // 1: it is one of another liquid
layout(location = 1) out vec4 depths;  // optical depth of red, green and blue: e^-depth is transmitted; w: by scattering
#else
layout(location = 0) out float thickness;
#endif
void main() {
    vec2 pixel = gl_FragCoord.xy * float(scale);
    float front, through;
#if defined(ELLIPSOIDS)
    if (!hitEllipsoid(pixel, centreView.xyz, shapeView, front, through)) discard;
#else
    if (!hitSphere(pixel, centreView.xyz, centreView.w, front, through)) discard;
#endif
    float scene = depthOfWindow(texelFetch(sceneDepth, min(ivec2(pixel), ivec2(frame.viewport.xy) - 1), 0).r);
    float r = centreView.w / spacing;
    // The particle's volume over its sphere's, for spheres that overlap.
    float share = min(0.2387324 * standsFor * represented / (r * r * r), 1.0);
    float water = share * clamp(scene - front, 0.0, through);
#if defined(INK)
    thickness = vec2(water, water * other);
    depths = min(ink * water, vec4(600.0));  // a half float holds the sum of a hundred such
#else
    thickness = water;
#endif
}
