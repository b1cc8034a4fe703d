// A particle seen from the light: an orthographic disc.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
uniform float clipRadius;  // of a particle in the light's clip space
out vec2 inDisc;
flat out float depth;
void main() {
    inDisc = corner() * 2.0 - 1.0;
    vec4 clip = frame.waterProjection * vec4(particle.xyz, 1.0);
    depth = clip.z * 0.5 + 0.5;
    gl_Position = lost(particle) ? kNowhere : clip + vec4(inDisc * clipRadius, 0.0, 0.0);
}
