// Marks the tiles of the image that a sphere covers: one texel per tile.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
uniform vec2 tiles;  // how many
void main() {
    gl_PointSize = 1.0;
    gl_Position = lost(particle) ? kNowhere : splatQuad(splatOf(particle));
    // Enlarged by half a texel, so that partly covered texels are drawn too.
    gl_Position.xy += (corner() - 0.5) * 2.0 / tiles * gl_Position.w;
}
