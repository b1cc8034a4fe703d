// A particle seen from the light: an orthographic disc, of the same size wherever it is.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
uniform float clipRadius;  // of a particle in the light's clip space; with POINTS in texels
flat out float depth;
#if !defined(POINTS)
out vec2 inDisc;
#endif
void main() {
    vec4 clip = frame.waterProjection * vec4(particle.xyz, 1.0);
    depth = clip.z * 0.5 + 0.5;
#if defined(POINTS)
    gl_PointSize = 2.0 * clipRadius;
#else
    inDisc = corner() * 2.0 - 1.0;
    clip.xy += inDisc * clipRadius;
#endif
    gl_Position = lost(particle) ? kNowhere : clip;
}
