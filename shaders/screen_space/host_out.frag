// Writes the result into a host's image, where it has changed.
#include "shaders/screen_space/host.glsl"
uniform sampler2D picture;
uniform sampler2D scene;       // the image before the water was drawn
uniform sampler2D hostColour;  // the same, in the host's encoding
uniform sampler2D hostDepth;
uniform sampler2D depths;      // m, of water; OPAQUE: window depth by our projection
#if defined(OPAQUE)
uniform vec2 planes;           // [2][2], [3][2] of it
#endif
uniform ivec2 origin;          // pixels, of the target's viewport
layout(location = 0) out vec4 colour;

void main() {
    ivec2 theirs = ivec2(gl_FragCoord.xy) - origin, p = mirrored(theirs);
    vec4 c = texelFetch(picture, p, 0);
    if (all(equal(c.rgb, texelFetch(scene, p, 0).rgb))) discard;
    colour = vec4(isLinear ? c.rgb : toSrgb(clamp(c.rgb, 0.0, 1.0)), texelFetch(hostColour, theirs, 0).a);
    float depth = texelFetch(depths, p, 0).r;
#if defined(OPAQUE)
    float clip = 2.0 * depth - 1.0;
    depth = depth >= 1.0 ? 1.0e6 : hostParallel ? (planes.y - clip) / planes.x : planes.y / (clip + planes.x);
#endif
    // Spray and drops in front of other objects do not change the depth.
    gl_FragDepth = depth < 0.9e6 ? hostOfDepth(depth, p) : texelFetch(hostDepth, theirs, 0).r;
}
