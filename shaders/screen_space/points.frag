// Spheres, lit like any surface.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/material/surface.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
flat in vec3 baseColour;
layout(location = 0) out vec4 colour;
void main() {
    float depth, through;
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
    gl_FragDepth = windowOfDepth(depth);
    vec3 p = viewRay(gl_FragCoord.xy) * depth;
    vec3 n = directionToWorld((p - centreView.xyz) / centreView.w);
    vec3 light = frame.lightColour.rgb * meshShadow(toWorld(p), n);
    colour = vec4(shadeSurface(Surface(baseColour, 0.45, 0.0, n, 1.0), directionToWorld(-normalize(p)), light), 1.0);
}
