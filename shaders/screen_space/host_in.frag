// Converts a host's image to linear radiance, and its depth to Rivulet's projection.
#include "shaders/screen_space/host.glsl"
uniform sampler2D hostColour;
uniform sampler2D hostDepth;
uniform bool depthThere;  // false: nothing is in front of the water
uniform vec2 planes;      // [2][2], [3][2] of Rivulet's projection
layout(location = 0) out vec4 colour;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy), theirs = mirrored(p);
    vec4 c = texelFetch(hostColour, theirs, 0);
    colour = vec4(isLinear ? c.rgb : fromSrgb(clamp(c.rgb, 0.0, 1.0)), c.a);
    gl_FragDepth = 1.0;
    if (!depthThere) return;
    float variable = variableOfHost(texelFetch(hostDepth, theirs, 0).r, p);
    float clip = hostParallel ? planes.y + planes.x * -variable : planes.y * variable - planes.x;
    if (hostParallel || variable > 0.0) gl_FragDepth = clamp(0.5 + 0.5 * clip, 0.0, 1.0);
}
