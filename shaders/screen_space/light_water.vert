// A particle seen from the light: an orthographic disc, of the same size wherever it is.
#include "shaders/render/frame.glsl"
#define ALL_DRAWN
#include "shaders/screen_space/particle.glsl"
uniform float clipRadius;  // of a particle in the light's clip space
flat out float depth;
out vec2 inDisc;
void main() {
    vec4 clip = frame.waterProjection * vec4(particle.xyz, 1.0);
    depth = clip.z * 0.5 + 0.5;
    inDisc = vec2(0.0);
    gl_PointSize = 1.0;
    if (asPoint()) {
        gl_PointSize = clipRadius * pointTarget.x;
    } else {
        inDisc = corner() * 2.0 - 1.0;
        clip.xy += inDisc * clipRadius;
    }
    gl_Position = lost(particle) ? kNowhere : clip;
}
