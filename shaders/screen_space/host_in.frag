// Converts a host's image to linear radiance, and its depth to Rivulet's projection.
#include "shaders/screen_space/host.glsl"
uniform sampler2D hostColour;
uniform sampler2D hostDepth;
uniform bool depthThere;  // false: nothing is in front of the water
uniform vec2 planes;      // [2][2], [3][2] of Rivulet's projection
layout(location = 0) out vec4 colour;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec4 c = texelFetch(hostColour, p, 0);
    colour = vec4(isLinear ? c.rgb : fromSrgb(clamp(c.rgb, 0.0, 1.0)), c.a);
    float near = depthThere ? (clipOfHost(texelFetch(hostDepth, p, 0).r) + hostPlanes.x) / hostPlanes.y : 0.0;  // 1 over m
    gl_FragDepth = near > 0.0 ? clamp(0.5 - 0.5 * planes.x + 0.5 * planes.y * near, 0.0, 1.0) : 1.0;
}
