// Spheres, drawn into a small buffer of surfaces that is lit afterwards, once per pixel.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/sphere.glsl"
flat in vec4 centreView;
flat in vec3 baseColour;
layout(location = 0) out vec4 surface;  // colour, 1
layout(location = 1) out vec2 normal;   // x and y, view; z follows from the unit length
// The quad lies in the plane through its sphere's nearest point: hidden quads need no shading.
layout(depth_greater) out float gl_FragDepth;
void main() {
    float depth, through;
    if (!hitSphere(gl_FragCoord.xy, centreView.xyz, centreView.w, depth, through)) discard;
    gl_FragDepth = windowOfDepth(depth);
    normal = (placeAt(gl_FragCoord.xy, depth).xy - centreView.xy) / centreView.w;
    surface = vec4(sqrt(baseColour), 1.0);  // even steps of brightness in 8 bits
}
